// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <bit>
#include <cairn/core/error.hpp>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

/// ROS 2 messages, as bytes and as structs. (docs/recordings.md, "Messages")
namespace cairn::ros {

using Bytes = std::vector<std::uint8_t>;

/// A struct that lists its members by name: `static void each(auto& message, auto&& visit)`, and has its ROS
/// name, "sensor_msgs/msg/Image", in kType.
template <class T>
concept Message = requires {
  T::kType;
};
/// A number, or ROS' byte.
template <class T>
concept CdrValue = std::is_arithmetic_v<T> || std::is_same_v<T, std::byte>;

/// A message whose first members are the key of its DDS topic: numbers and arrays of them. (ROS has no keys before
/// Kilted.)
template <class T>
concept KeyedMessage = Message<T> && requires {
  T::kKeyMembers;
};

/// Plain CDR (XCDR1), little endian, as ROS 2 sends and records messages: a header of four bytes, then the
/// members, each number aligned to its own size counted from the end of the header.
class CdrWriter {
 public:
  CdrWriter() : bytes_{0, 1, 0, 0} {}

  void operator()(std::string_view /*name*/, const auto& value) { put(value); }
  [[nodiscard]] Bytes take() { return std::move(bytes_); }

 private:
  template <CdrValue T>
  void put(const T& value) {
    const std::size_t at = aligned(bytes_.size(), sizeof(T));
    bytes_.resize(at + sizeof(T));
    store(value, bytes_.data() + at);
  }
  void put(const std::string& text) {
    put(static_cast<std::uint32_t>(text.size() + 1));
    bytes_.insert(bytes_.end(), text.begin(), text.end());
    bytes_.push_back(0);
  }
  template <class T>
  void put(const std::vector<T>& list) {
    put(static_cast<std::uint32_t>(list.size()));
    put_each(list);
  }
  template <class T, std::size_t N>
  void put(const std::array<T, N>& list) {
    put_each(list);
  }
  void put(const Message auto& message) { message.each(message, *this); }

  void put_each(const auto& list) {
    using T = std::remove_cvref_t<decltype(list[0])>;
    if constexpr (sizeof(T) == 1 && std::is_integral_v<T>) {
      const auto* const first = reinterpret_cast<const std::uint8_t*>(list.data());
      bytes_.insert(bytes_.end(), first, first + list.size());
    } else {
      for (const T& value : list) put(value);
    }
  }

  [[nodiscard]] static std::size_t aligned(std::size_t at, std::size_t step) {
    return (at - kHeader + step - 1) / step * step + kHeader;
  }
  template <class T>
  static void store(T value, std::uint8_t* to) {
    std::array<std::uint8_t, sizeof(T)> bytes{};
    std::memcpy(bytes.data(), &value, sizeof(T));
    for (std::size_t i = 0; i < sizeof(T); ++i)
      to[i] = bytes[std::endian::native == std::endian::little ? i : sizeof(T) - 1 - i];
  }

  static constexpr std::size_t kHeader = 4;
  Bytes bytes_;
};

/// Decodes a message. Throws Error if the bytes end early or are not such a message. Never reads beyond them,
/// and allocates no more than they can fill.
class CdrReader {
 public:
  /// Borrows `bytes`.
  CdrReader(std::span<const std::uint8_t> bytes, std::string_view type) : bytes_(bytes), type_(type) {
    if (bytes_.size() < kHeader) refuse("found " + std::to_string(bytes_.size()) + " bytes");
    if (bytes_[0] != 0 || bytes_[1] != 1)
      refuse("found encoding " + std::to_string(bytes_[0]) + "." + std::to_string(bytes_[1]));
    at_ = kHeader;
  }

  void operator()(std::string_view name, auto& value) {
    name_ = name;
    get(value);
  }
  /// Throws Error unless all bytes but padding have been read.
  void end() const {
    if (bytes_.size() - at_ >= 8)
      refuse("found " + std::to_string(bytes_.size() - at_) + " bytes after its end");
  }

 private:
  template <CdrValue T>
  void get(T& value) {
    at_ = (at_ - kHeader + sizeof(T) - 1) / sizeof(T) * sizeof(T) + kHeader;
    need(sizeof(T));
    std::array<std::uint8_t, sizeof(T)> bytes{};
    for (std::size_t i = 0; i < sizeof(T); ++i)
      bytes[std::endian::native == std::endian::little ? i : sizeof(T) - 1 - i] = bytes_[at_ + i];
    at_ += sizeof(T);
    if constexpr (std::is_same_v<T, bool>) {
      value = bytes[0] != 0;
    } else {
      std::memcpy(&value, bytes.data(), sizeof(T));
    }
  }
  void get(std::string& text) {
    const std::size_t length = count();
    need(length);
    text.clear();
    if (length == 0) return;
    if (bytes_[at_ + length - 1] != 0) refuse("found text without an end in " + std::string(name_));
    text.assign(reinterpret_cast<const char*>(bytes_.data()) + at_, length - 1);
    at_ += length;
  }
  template <class T>
  void get(std::vector<T>& list) {
    const std::size_t length = count();
    list.clear();
    if constexpr (sizeof(T) == 1 && std::is_integral_v<T>) {
      need(length);
      const auto* const first = reinterpret_cast<const T*>(bytes_.data() + at_);
      list.assign(first, first + length);
      at_ += length;
    } else {
      // One at a time: never allocates more than the bytes can fill.
      for (std::size_t i = 0; i < length; ++i) get(list.emplace_back());
    }
  }
  template <class T, std::size_t N>
  void get(std::array<T, N>& list) {
    for (T& value : list) get(value);
  }
  void get(Message auto& message) { message.each(message, *this); }

  std::size_t count() {
    std::uint32_t value = 0;
    get(value);
    return value;
  }
  void need(std::size_t bytes) const {
    if (at_ > bytes_.size() || bytes > bytes_.size() - at_)
      refuse("ends in " + std::string(name_) + ", after " + std::to_string(bytes_.size()) + " bytes");
  }
  [[noreturn]] void refuse(const std::string& found) const {
    throw Error(std::string(type_) + ": " + found + ", expected a whole message in little-endian CDR");
  }

  static constexpr std::size_t kHeader = 4;
  std::span<const std::uint8_t> bytes_;
  std::string_view type_;
  std::string_view name_ = "its header";  // of the current member
  std::size_t at_ = 0;
};

/// The sizes of the numbers of a message's key, in order: they follow the header without gaps. Empty: no key.
template <Message M>
std::vector<std::uint8_t> key_sizes() {
  std::vector<std::uint8_t> sizes;
  if constexpr (KeyedMessage<M>) {
    int left = M::kKeyMembers;
    const auto add = [&]<class T>(std::string_view /*name*/, const T& /*member*/) {
      if (left-- <= 0) return;
      if constexpr (CdrValue<T>) {
        sizes.push_back(sizeof(T));
      } else if constexpr (requires { std::tuple_size<T>::value; }) {
        sizes.insert(sizes.end(), std::tuple_size_v<T>, sizeof(typename T::value_type));
      }
    };
    const M message;
    M::each(message, add);
  }
  return sizes;
}

/// The bytes of the message, including the header of four.
template <Message M>
Bytes encode(const M& message) {
  CdrWriter writer;
  M::each(message, writer);
  return writer.take();
}

/// Throws Error, naming the type, if `bytes` are not such a message.
template <Message M>
M decode(std::span<const std::uint8_t> bytes) {
  CdrReader reader(bytes, M::kType);
  M message;
  M::each(message, reader);
  reader.end();
  return message;
}

}  // namespace cairn::ros
