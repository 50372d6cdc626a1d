// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "messages.hpp"

/// Recordings in the format MCAP (mcap.dev), as ROS 2, Foxglove and Lichtblick write and read them. Built
/// without it (CAIRN_ZSTD=OFF) all that opens a file throws an Error that says so. (docs/recordings.md)
namespace cairn::ros {

using Words = std::map<std::string, std::string>;

/// Whether recordings are built in.
bool has_mcap();
/// Whether the file begins as a recording does; false also of one that cannot be read.
bool is_mcap(const std::filesystem::path& path);

struct McapOptions {
  std::size_t chunk_bytes = std::size_t{4} << 20;  // before compression
  std::chrono::milliseconds chunk_time{1000};
  bool compress = true;  // zstd, level 1
  bool sync = true;      // a chunk that is written survives a loss of power
};

/// Writes a recording, chunk by chunk. A file that was never closed can be read up to its last chunk.
class McapWriter {
 public:
  /// Replaces a file that is there. Throws Error (names `path` and the system's reason), as all of it does
  /// where the file cannot be written. Nothing more is taken then, and what was written before is a whole
  /// recording after close() where the summary has room, else a file that was cut off.
  explicit McapWriter(const std::filesystem::path& path, const McapOptions& options = {});
  /// Closes it, and keeps quiet where that fails.
  ~McapWriter();
  McapWriter(const McapWriter&) = delete;
  McapWriter& operator=(const McapWriter&) = delete;

  /// A topic of messages in CDR. `type`: "sensor_msgs/msg/Image"; `schema`: its definition.
  std::uint16_t channel(std::string_view topic, std::string_view type, std::string_view schema);
  /// `id`: as channel() gave it. `stamp`: never below 0 in the file.
  void message(std::uint16_t id, Stamp stamp, std::span<const std::uint8_t> bytes);
  void attachment(std::string_view name, std::string_view media_type, std::string_view bytes);
  void metadata(std::string_view name, const Words& words);
  /// Writes the chunk at hand, where it is old enough or `now`.
  void flush(bool now = false);
  /// Writes what is left, and the summary.
  void close();

  [[nodiscard]] std::uint64_t messages() const;
  /// In the file.
  [[nodiscard]] std::uint64_t bytes() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

struct McapChannel {
  std::uint16_t id = 0;
  std::string topic;
  std::string type;      // "sensor_msgs/msg/Image"
  std::string encoding;  // of messages: "cdr"
  std::string schema_encoding;
  std::string schema;
};

struct McapMessage {
  std::uint16_t channel = 0;
  Stamp logged;
  std::span<const std::uint8_t> bytes;  // until the next call
};

struct McapAttachment {
  std::string name;
  std::string media_type;
  std::string bytes;
};

/// Reads a recording: by its index, or where it has none (it was cut off) by a walk through what is there.
/// Sizes are checked before anything is allocated. What is damaged is left out and counted.
class McapReader {
 public:
  /// Throws Error (names `path`) where it is no recording.
  explicit McapReader(const std::filesystem::path& path);
  ~McapReader();
  McapReader(McapReader&&) noexcept;
  McapReader& operator=(McapReader&&) noexcept;

  [[nodiscard]] const std::map<std::uint16_t, McapChannel>& channels() const;
  /// How many messages each channel has, as far as the file says it.
  [[nodiscard]] const std::map<std::uint16_t, std::uint64_t>& counts() const;
  [[nodiscard]] const std::vector<McapAttachment>& attachments() const;
  [[nodiscard]] const std::map<std::string, Words>& metadata() const;
  /// Whether it ends as a recording does.
  [[nodiscard]] bool is_whole() const;
  /// Chunks that are damaged, up to now, and the first one's trouble.
  [[nodiscard]] std::size_t damaged_chunks() const;
  [[nodiscard]] const std::string& first_damage() const;

  /// Only these channels' messages are wanted; chunks without any are not read. None: all.
  void only(const std::vector<std::uint16_t>& channels);
  /// The next message in the file's order. Throws Error where it is compressed by something other than zstd.
  std::optional<McapMessage> next();
  /// From the first one on again.
  void rewind();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The bytes of the attachment of this name; none where there is none.
std::optional<std::string> attachment_of(const McapReader& reader, std::string_view name);

}  // namespace cairn::ros
