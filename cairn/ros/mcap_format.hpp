// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cairn/core/error.hpp>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include <cairn/ros/mcap.hpp>

/// The records of an MCAP file by its specification (mcap.dev/spec); internal to ros.
namespace cairn::ros::mcap {

inline constexpr std::array<std::uint8_t, 8> kMagic{0x89, 'M', 'C', 'A', 'P', 0x30, '\r', '\n'};
inline constexpr std::size_t kRecordHeader = 9;  // opcode, length

enum class Op : std::uint8_t {
  header = 1,
  footer = 2,
  schema = 3,
  channel = 4,
  message = 5,
  chunk = 6,
  message_index = 7,
  chunk_index = 8,
  attachment = 9,
  attachment_index = 10,
  statistics = 11,
  metadata = 12,
  metadata_index = 13,
  summary_offset = 14,
  data_end = 15
};

/// Serialises records: numbers little-endian, texts after their length.
class Writer {
 public:
  template <class T>
  void number(T value) {
    const auto bits = static_cast<std::uint64_t>(value);
    for (std::size_t i = 0; i < sizeof(T); ++i) bytes_.push_back(static_cast<std::uint8_t>(bits >> 8 * i));
  }
  void raw(std::span<const std::uint8_t> bytes) { bytes_.insert(bytes_.end(), bytes.begin(), bytes.end()); }
  void raw(std::string_view text) { raw({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}); }
  void text(std::string_view text) {
    number(static_cast<std::uint32_t>(text.size()));
    raw(text);
  }
  void words(const Words& words) {
    Writer inside;
    for (const auto& [key, value] : words) {
      inside.text(key);
      inside.text(value);
    }
    number(static_cast<std::uint32_t>(inside.bytes_.size()));
    raw(inside.bytes_);
  }
  /// A complete record.
  void record(Op op, const Writer& content) {
    number(static_cast<std::uint8_t>(op));
    number(std::uint64_t{content.bytes_.size()});
    raw(content.bytes_);
  }
  [[nodiscard]] const Bytes& bytes() const { return bytes_; }
  [[nodiscard]] std::size_t size() const { return bytes_.size(); }
  void clear() { bytes_.clear(); }

 private:
  Bytes bytes_;
};

/// Parses records. Throws Error, without a file name, if the bytes end early.
class Reader {
 public:
  explicit Reader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}
  template <class T>
  T number() {
    const auto raw = take(sizeof(T));
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < sizeof(T); ++i) bits |= std::uint64_t{raw[i]} << 8 * i;
    return static_cast<T>(bits);
  }
  std::span<const std::uint8_t> take(std::uint64_t count) {
    if (count > bytes_.size()) throw Error("a record ends too early");
    const auto taken = bytes_.first(count);
    bytes_ = bytes_.subspan(count);
    return taken;
  }
  std::string text() {
    const auto raw = take(number<std::uint32_t>());
    return {raw.begin(), raw.end()};
  }
  /// Bytes preceded by their length in 32 bits.
  Reader part() { return Reader(take(number<std::uint32_t>())); }
  Words words() {
    Reader inside = part();
    Words words;
    while (!inside.empty()) {
      std::string key = inside.text();
      words[std::move(key)] = inside.text();
    }
    return words;
  }
  [[nodiscard]] bool empty() const { return bytes_.empty(); }
  [[nodiscard]] std::span<const std::uint8_t> rest() const { return bytes_; }

 private:
  std::span<const std::uint8_t> bytes_;
};

}  // namespace cairn::ros::mcap
