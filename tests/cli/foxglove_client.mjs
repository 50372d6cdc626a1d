// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// foxglove_client.mjs CAIRN SOURCE_DIR BUILD_DIR: Foxglove's own client reads every channel of cairn live --view with
// both subprotocols, and changes an option. Exit code 77 (skipped) if its npm packages are neither in BUILD_DIR/npm
// nor installable there.
import assert from 'node:assert/strict';
import {execFileSync, spawn} from 'node:child_process';
import {existsSync, mkdirSync} from 'node:fs';
import {createRequire} from 'node:module';
import path from 'node:path';

const [cairn, sources, build] = process.argv.slice(2);
const packages = ['@foxglove/ws-protocol', '@foxglove/rosmsg2-serialization', '@foxglove/rosmsg', 'ws'];

function skip(why) {
  console.log(`skipped: ${why}`);
  process.exit(77);
}

function load() {
  const folder = path.join(build, 'npm');
  mkdirSync(folder, {recursive: true});
  if (packages.some((name) => !existsSync(path.join(folder, 'node_modules', name)))) {
    try {
      execFileSync('npm', ['install', '--no-audit', '--no-fund', '--prefix', folder, ...packages],
                   {stdio: 'ignore', timeout: 120_000});
    } catch {
      skip(`npm install ${packages.join(' ')} did not work`);
    }
  }
  return packages.map(createRequire(path.join(folder, 'here.js')));
}

const [{FoxgloveClient}, {MessageReader}, {parse}, WebSocket] = load();

/// Waits until the program started by `run` is ready, 30 s at most.
function within(what, run) {
  return new Promise((resolve, reject) => {
    const timer = setTimeout(() => reject(new Error(`${what}: nothing came for 30 s`)), 30_000);
    run((value) => {
      clearTimeout(timer);
      resolve(value);
    }, reject);
  });
}

async function start() {
  const run = spawn(cairn, ['live', path.join(sources, 'data/sequences/rolling_ball'), '--view', '127.0.0.1:0', '--tunable',
                            '--pace', '0.05'], {stdio: ['ignore', 'ignore', 'pipe']});
  let text = '';
  const address = await within('cairn live', (resolve, reject) => {
    run.stderr.on('data', (bytes) => {
      text += bytes;
      const found = text.match(/view: http:\/\/(\S+)/);
      if (found) resolve(`ws://${found[1]}`);
    });
    run.on('exit', (code) => reject(new Error(`cairn live ended with ${code}: ${text}`)));
  });
  return {run, address, text: () => text};
}

/// A reader for each channel, based on the server's schema only.
function readerOf({encoding, schema, schemaEncoding}) {
  if (encoding === 'json') {
    assert.equal(schemaEncoding, 'jsonschema');
    assert.equal(JSON.parse(schema).type, 'object');
    return (bytes) => JSON.parse(new TextDecoder().decode(bytes));
  }
  assert.equal(encoding, 'cdr');
  assert.equal(schemaEncoding, 'ros2msg');
  const reader = new MessageReader(parse(schema, {ros2: true}));
  return (bytes) => reader.readMessage(bytes);
}

function checkMessages(messages) {
  const stats = messages['/cairn/stats'];
  const {width, height} = stats.image;
  const left = messages['/cairn/left'];
  assert.equal(left.format, 'jpeg');
  assert.deepEqual([...left.data.subarray(0, 2)], [0xff, 0xd8]);
  for (const [topic, encoding, bytes] of [['labels', 'mono16', 2], ['reject', 'mono16', 2], ['disparity', 'mono8', 1]]) {
    const image = messages[`/cairn/${topic}`];
    assert.equal(image.encoding, encoding);
    assert.deepEqual([image.width, image.height, image.step, image.data.length],
                     [width, height, width * bytes, width * height * bytes]);
  }
  const {labels, reject, disparity} = Object.fromEntries(['labels', 'reject', 'disparity'].map((name) => {
    const {data} = messages[`/cairn/${name}`];
    return [name, name === 'disparity' ? data : new Uint16Array(data.slice().buffer)];
  }));
  // Exactly the holes have a reason.
  assert.ok(disparity.every((value, at) => (value === 0) === (reject[at] !== 0)));
  const ids = new Set(labels);
  ids.delete(0);
  assert.ok(stats.objects.length > 0);
  assert.deepEqual([...ids].sort((a, b) => a - b), stats.objects.map(({id}) => id).sort((a, b) => a - b));
  const {detections} = messages['/cairn/objects'];
  assert.ok(detections.length > 0);
  for (const {id, bbox} of detections) {
    const object = stats.objects.find((one) => String(one.id) === id);
    if (!object) continue;  // an object without a track
    const {x, y, z} = bbox.center.position;
    [x, y, z].forEach((value, axis) => assert.ok(Math.abs(value - object.position_m[axis]) < 1e-3, `${id}: ${value}`));
  }
  const cloud = messages['/cairn/obstacles'];
  assert.ok(cloud.width > 0);
  assert.equal(cloud.data.length, cloud.width * cloud.point_step);
  const {entities} = messages['/cairn/scene'];
  assert.deepEqual(entities.map(({id}) => Number(id)), stats.objects.map(({id}) => id));
  assert.ok(entities.every(({cubes, texts}) => cubes.length === 1 && texts[0].text.endsWith(' m')));
  const frames = messages['/tf'].transforms.map((one) => one.child_frame_id);
  assert.ok(frames.length > 0);
}

async function check(address, subprotocol) {
  const socket = new WebSocket(address, [subprotocol]);
  const client = new FoxgloveClient({ws: socket});
  client.on('error', (error) => { throw error; });
  const [info, channels] = await within('the greeting', (resolve) => {
    let info;
    client.on('serverInfo', (message) => { info = message; });
    client.on('advertise', (list) => resolve([info, list]));
  });
  assert.equal(socket.protocol, subprotocol);
  assert.deepEqual(info.capabilities, ['parameters', 'parametersSubscribe']);

  const answers = new Map();
  client.on('parameterValues', ({id, parameters}) => answers.get(id)?.(parameters));
  const answered = (what, ask) => within(what, (resolve) => {
    answers.set(what, resolve);
    ask(what);
  });
  // While paused, all channels show the same frame.
  await answered('pause', (id) => client.setParameters([{name: 'live.pause', value: true}], id));

  const readers = new Map(), byStamp = new Map();
  const messages = await within('all channels', (resolve) => {
    client.on('message', ({subscriptionId, timestamp, data}) => {
      const {topic, read} = readers.get(subscriptionId);
      const frame = byStamp.get(timestamp) ?? {};
      byStamp.set(timestamp, Object.assign(frame, {[topic]: read(data)}));
      if (Object.keys(frame).length === channels.length) resolve(frame);
    });
    for (const channel of channels)
      readers.set(client.subscribe(channel.id), {topic: channel.topic, read: readerOf(channel)});
  });
  checkMessages(messages);

  const all = await answered('all', (id) => client.getParameters([], id));
  assert.ok(all.length > 50);
  const [wanted] = await answered('set', (id) => client.setParameters([{name: 'objects.min_area', value: 1}], id));
  assert.deepEqual(wanted, {name: 'objects.min_area', value: 1, type: 'float64'});
  const refusal = within('a refusal', (resolve) => client.on('status', resolve));
  client.setParameters([{name: 'objects.min_area', value: -5}]);
  const {level, message} = await refusal;
  assert.equal(level, 2);
  assert.match(message, /option objects\.min_area: found '-5', expected 0 … 100/);
  await answered('reset', (id) => client.setParameters([{name: 'objects.min_area'}], id));
  await answered('play', (id) => client.setParameters([{name: 'live.pause', value: false}], id));
  client.close();
  console.log(`${subprotocol}: ${channels.map(({topic}) => topic).join(' ')}`);
}

const {run, address, text} = await start();
try {
  for (const subprotocol of ['foxglove.sdk.v1', 'foxglove.websocket.v1']) await check(address, subprotocol);
} catch (error) {
  console.error(text());
  throw error;
} finally {
  run.removeAllListeners('exit');
  run.kill('SIGINT');
}
