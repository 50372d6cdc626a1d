// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <gtest/gtest.h>
#include <zlib.h>

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

/// Reads the data of a page as its script does.
namespace cairn::support {

inline std::string bytes_of_base64(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    if (c == '=') break;
    bits = bits << 6 | static_cast<std::uint32_t>(digits.find(c));
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes += static_cast<char>(bits >> count & 255);
  }
  return bytes;
}

/// Unpacks a map of `count` pixels.
inline std::vector<std::uint32_t> unpacked(const nlohmann::json& map, std::size_t count) {
  const std::size_t bytes_each = map.at("bytes");
  const std::string deflated = bytes_of_base64(map.at("data"));
  std::vector<std::uint8_t> planes(count * bytes_each);
  uLongf length = planes.size();
  EXPECT_EQ(
      uncompress(planes.data(), &length, reinterpret_cast<const Bytef*>(deflated.data()), deflated.size()),
      Z_OK);
  EXPECT_EQ(length, planes.size());
  std::vector<std::uint32_t> values(count);
  const std::uint64_t modulus = std::uint64_t{1} << (8 * bytes_each);
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t k = 0; k < bytes_each; ++k) value += std::uint64_t{planes[k * count + i]} << (8 * k);
    value %= modulus;
    values[i] = static_cast<std::uint32_t>(value);
  }
  return values;
}

/// The content of a tagged block.
inline std::string block(const std::string& page, const std::string& id) {
  const std::string open = "id=\"" + id + "\">";
  const std::size_t begin = page.find(open);
  if (begin == std::string::npos) return {};
  return page.substr(begin + open.size(), page.find("</script", begin) - begin - open.size());
}

}  // namespace cairn::support
