// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// node mcap_client.mjs FILE.mcap: reads a recording with third-party packages (npm: @mcap/core, @foxglove/rosmsg,
// @foxglove/rosmsg2-serialization, @foxglove/rosmsg-msgs-common, zstd by fzstd), as a stream and by its index, with
// checksums, and prints its content as JSON. CAIRN_NODE_MODULES names their folder. Exit code 77: they are missing.
import { createRequire } from "node:module";
import fs from "node:fs";
import path from "node:path";

const folder = process.env.CAIRN_NODE_MODULES ?? process.cwd();
const require = createRequire(path.join(folder, "none.js"));
let mcap, rosmsg, serialization, common, zstd;
try {
  mcap = require("@mcap/core");
  rosmsg = require("@foxglove/rosmsg");
  serialization = require("@foxglove/rosmsg2-serialization");
  common = require("@foxglove/rosmsg-msgs-common");
  zstd = require("fzstd");
} catch (error) {
  console.error(`${error.message.split("\n")[0]}; npm install @mcap/core @foxglove/rosmsg ` +
    "@foxglove/rosmsg2-serialization @foxglove/rosmsg-msgs-common fzstd in the folder CAIRN_NODE_MODULES");
  process.exit(77);
}

const file = process.argv[2];
const bytes = fs.readFileSync(file);
const decompressHandlers = { zstd: (packed, size) => zstd.decompress(packed, new Uint8Array(Number(size))) };

// By the definition in the file, and by the official one if there is one. Both must give the same.
const readers = new Map();
function decode(schema, data) {
  if (!readers.has(schema.name)) {
    const text = new TextDecoder().decode(schema.data);
    const own = new serialization.MessageReader(rosmsg.parse(text, { ros2: true }));
    const short = schema.name.replace("/msg/", "/");
    const definitions = common.ros2humble ?? common.ros2jazzy;
    let official;
    if (definitions?.[short]) {
      const needed = [];
      const add = (name) => {
        if (needed.some((known) => known.name === name)) return;
        const definition = definitions[name];
        if (!definition) throw new Error(`no official ${name}`);
        needed.push({ ...definition, name });
        for (const member of definition.definitions)
          if (member.isComplex) add(member.type);
      };
      add(short);
      official = new serialization.MessageReader(needed);
    }
    readers.set(schema.name, { own, official });
  }
  const { own, official } = readers.get(schema.name);
  const view = new DataView(data.buffer, data.byteOffset, data.byteLength);
  const message = own.readMessage(view);
  if (official) {
    const text = JSON.stringify(official.readMessage(view), plain);
    if (text !== JSON.stringify(message, plain)) throw new Error(`${schema.name}: the official definition reads otherwise`);
  }
  return { message, isOfficial: official != undefined };
}

function plain(_key, value) {
  if (typeof value === "bigint") return Number(value);
  if (ArrayBuffer.isView(value) && value.byteLength > 1000)
    return { length: value.length, sum: Array.prototype.reduce.call(value, (sum, v) => (sum + Number(v)) % 1000003, 0) };
  if (ArrayBuffer.isView(value)) return Array.from(value, Number);
  return value;
}

// As a stream, in order.
const stream = new mcap.McapStreamReader({ validateCrcs: true, includeChunks: false, decompressHandlers });
stream.append(bytes);
const streamed = {};
const schemas = new Map();
const channels = new Map();
const attachments = {};
let metadata = {};
for (let record; (record = stream.nextRecord()); ) {
  if (record.type === "Schema") schemas.set(record.id, record);
  if (record.type === "Channel") channels.set(record.id, record);
  if (record.type === "Attachment") attachments[record.name] = new TextDecoder().decode(record.data);
  if (record.type === "Metadata") metadata[record.name] = Object.fromEntries(record.metadata);
  if (record.type !== "Message") continue;
  const topic = channels.get(record.channelId).topic;
  streamed[topic] = (streamed[topic] ?? 0) + 1;
}
if (!stream.done()) throw new Error("the stream has no end");

// By the index.
const readable = {
  size: async () => BigInt(bytes.length),
  read: async (offset, length) => new Uint8Array(bytes.buffer, bytes.byteOffset + Number(offset), Number(length)),
};
const reader = await mcap.McapIndexedReader.Initialize({ readable, decompressHandlers });
const topics = {};
for await (const record of reader.readMessages({ validateCrcs: true })) {
  const channel = reader.channelsById.get(record.channelId);
  const schema = reader.schemasById.get(channel.schemaId);
  const { message, isOfficial } = decode(schema, record.data);
  const topic = (topics[channel.topic] ??= { type: schema.name, official: isOfficial, count: 0, first: message });
  topic.count += 1;
}
for await (const attachment of reader.readAttachments())
  if (new TextDecoder().decode(attachment.data) !== attachments[attachment.name]) throw new Error("attachments differ");
for (const [topic, count] of Object.entries(streamed))
  if (topics[topic]?.count !== count) throw new Error(`${topic}: ${count} in the stream, ${topics[topic]?.count} by index`);

console.log(JSON.stringify({
  profile: reader.header.profile,
  messages: Number(reader.statistics.messageCount),
  chunks: reader.chunkIndexes.length,
  attachments,
  metadata,
  topics,
}, plain));
