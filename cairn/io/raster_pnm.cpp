// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/core/error.hpp>
#include <cairn/io/raster.hpp>
#include <charconv>
#include <string>

namespace cairn::io {
namespace {

constexpr bool is_space(char c) {
  return c == ' ' || (c >= '\t' && c <= '\r');
}

/// Parses the decimal numbers of a PNM file.
class Numbers {
 public:
  explicit Numbers(std::string_view text) : rest_(text) {}

  /// The next number; skips white space and comments (# to the end of the line).
  int next(const char* what) {
    skip();
    int value = 0;
    const auto [end, error] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), value);
    if (rest_.empty()) throw Error(std::string("is truncated: it ends before its ") + what);
    if (error != std::errc{}) throw Error(std::string("is damaged: its ") + what + " is not a number");
    rest_.remove_prefix(static_cast<std::size_t>(end - rest_.data()));
    return value;
  }
  /// The data after the single white space that ends a binary header.
  std::string_view body() const {
    if (rest_.empty()) throw Error("is truncated: it ends with its header");
    if (!is_space(rest_.front())) throw Error("is damaged: no white space after its header");
    return rest_.substr(1);
  }
  [[nodiscard]] std::size_t bytes_left() const { return rest_.size(); }

 private:
  void skip() {
    while (!rest_.empty() && (is_space(rest_.front()) || rest_.front() == '#')) {
      const bool comment = rest_.front() == '#';
      rest_.remove_prefix(comment ? std::min(rest_.find('\n'), rest_.size()) : 1);
    }
  }
  std::string_view rest_;
};

[[noreturn]] void refuse_length(std::size_t found, std::size_t expected) {
  throw Error("is truncated: " + std::to_string(found) + " bytes of pixels, expected " +
              std::to_string(expected));
}

void store(Raster& raster, std::size_t sample, int value) {
  if (value < 0 || value > raster.max_value) {
    throw Error("is damaged: a sample of " + std::to_string(value) + ", its header says at most " +
                std::to_string(raster.max_value));
  }
  if (raster.bytes_each == 1) {
    raster.bytes[sample] = static_cast<std::uint8_t>(value);
  } else {
    reinterpret_cast<std::uint16_t*>(raster.bytes.data())[sample] = static_cast<std::uint16_t>(value);
  }
}

}  // namespace

Raster decode_pnm(std::string_view file) {
  const char kind = file[1];
  const bool text = kind == '2' || kind == '3';
  if (!text && kind != '5' && kind != '6') {
    throw Error(std::string("is a PNM of kind P") + kind + ", expected P2, P3, P5 or P6");
  }
  Numbers numbers(file.substr(2));
  Raster raster;
  raster.channels = kind == '3' || kind == '6' ? 3 : 1;
  const int width = numbers.next("width");
  const int height = numbers.next("height");
  check_sides(width, height);
  raster.size = {width, height};
  raster.max_value = numbers.next("greatest value");
  if (raster.max_value < 1 || raster.max_value > 65535) {
    throw Error("has the greatest value " + std::to_string(raster.max_value) + ", expected 1 ... 65535");
  }
  raster.bytes_each = raster.max_value > 255 ? 2 : 1;
  const auto samples =
      static_cast<std::size_t>(raster.size.area()) * static_cast<std::size_t>(raster.channels);
  const std::size_t bytes = samples * static_cast<std::size_t>(raster.bytes_each);

  if (text) {
    // Each number takes at least a digit and a blank: rejects a false header before memory is allocated.
    if (numbers.bytes_left() < 2 * samples) refuse_length(numbers.bytes_left(), 2 * samples);
    raster.bytes.resize(bytes);
    for (std::size_t i = 0; i < samples; ++i) store(raster, i, numbers.next("last pixel"));
    return raster;
  }
  const std::string_view body = numbers.body();
  if (body.size() < bytes) refuse_length(body.size(), bytes);
  raster.bytes.resize(bytes);
  const auto byte = [&](std::size_t i) { return static_cast<int>(static_cast<std::uint8_t>(body[i])); };
  for (std::size_t i = 0; i < samples; ++i) {
    store(raster, i, raster.bytes_each == 1 ? byte(i) : byte(2 * i) << 8 | byte(2 * i + 1));
  }
  return raster;
}

}  // namespace cairn::io
