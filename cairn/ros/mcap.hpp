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

#include <cairn/ros/messages.hpp>

/// Recordings in MCAP format (mcap.dev), which ROS 2, Foxglove and Lichtblick read and write. In a build
/// without it (CAIRN_ZSTD=OFF), opening a file throws Error. (docs/recordings.md)
namespace cairn::ros {

using Words = std::map<std::string, std::string>;

/// Whether recordings are built in.
bool has_mcap();
/// Whether the file starts like a recording; false if it cannot be read.
bool is_mcap(const std::filesystem::path& path);

struct McapOptions {
  std::size_t chunk_bytes = std::size_t{4} << 20;  // before compression
  std::chrono::milliseconds chunk_time{1000};
  bool compress = true;  // zstd, level 1
  bool sync = true;      // a written chunk survives a power failure
};

/// Writes a recording, chunk by chunk. A file that was never closed is readable up to its last chunk.
class McapWriter {
 public:
  /// Replaces an existing file. Throws Error (names `path` and the system's reason), as do all members, if
  /// the file cannot be written. After that, no more messages are accepted; close() completes the recording
  /// if there is room for the summary, otherwise the file is truncated.
  explicit McapWriter(const std::filesystem::path& path, const McapOptions& options = {});
  /// Closes the file; ignores errors.
  ~McapWriter();
  McapWriter(const McapWriter&) = delete;
  McapWriter& operator=(const McapWriter&) = delete;

  /// A topic of messages in CDR. `type`: "sensor_msgs/msg/Image"; `schema`: its definition.
  std::uint16_t channel(std::string_view topic, std::string_view type, std::string_view schema);
  /// `id`: from channel(). `stamp`: negative ones are stored as 0.
  void message(std::uint16_t id, Stamp stamp, std::span<const std::uint8_t> bytes);
  void attachment(std::string_view name, std::string_view media_type, std::string_view bytes);
  void metadata(std::string_view name, const Words& words);
  /// Writes the current chunk if it is old enough, or if `now`.
  void flush(bool now = false);
  /// Writes the remaining messages and the summary.
  void close();

  [[nodiscard]] std::uint64_t messages() const;
  /// Bytes in the file.
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
  std::span<const std::uint8_t> bytes;  // valid until the next call
};

struct McapAttachment {
  std::string name;
  std::string media_type;
  std::string bytes;
};

/// Reads a recording by its index or, if it has none (a truncated file), by a scan. Sizes are checked before
/// memory is allocated. Damaged parts are skipped and counted.
class McapReader {
 public:
  /// Throws Error (names `path`) if it is not a recording.
  explicit McapReader(const std::filesystem::path& path);
  ~McapReader();
  McapReader(McapReader&&) noexcept;
  McapReader& operator=(McapReader&&) noexcept;

  [[nodiscard]] const std::map<std::uint16_t, McapChannel>& channels() const;
  /// The number of messages of each channel, as far as the file states it.
  [[nodiscard]] const std::map<std::uint16_t, std::uint64_t>& counts() const;
  [[nodiscard]] const std::vector<McapAttachment>& attachments() const;
  [[nodiscard]] const std::map<std::string, Words>& metadata() const;
  /// Whether the end of the file is intact.
  [[nodiscard]] bool is_whole() const;
  /// The number of damaged chunks so far, and the error of the first one.
  [[nodiscard]] std::size_t damaged_chunks() const;
  [[nodiscard]] const std::string& first_damage() const;

  /// Selects the channels to read; chunks without them are skipped. Empty: all.
  void only(const std::vector<std::uint16_t>& channels);
  /// The next message in the file's order. Throws Error for compression other than zstd.
  std::optional<McapMessage> next();
  /// Restarts at the first message.
  void rewind();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The bytes of the attachment with this name; nullopt if there is none.
std::optional<std::string> attachment_of(const McapReader& reader, std::string_view name);

}  // namespace cairn::ros
