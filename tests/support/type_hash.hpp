// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <map>
#include <ros/messages.hpp>
#include <string>
#include <type_traits>
#include <vector>

/// The hash of a message's type as REP 2016 defines it: SHA-256 of the type's description in canonical JSON.
namespace cairn::ros {

/// FIPS 180-4, in hexadecimal.
inline std::string sha256(std::string text) {
  static constexpr std::array<std::uint32_t, 64> kRounds{
      0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1, 0x923f82a4, 0xab1c5ed5,
      0xd807aa98, 0x12835b01, 0x243185be, 0x550c7dc3, 0x72be5d74, 0x80deb1fe, 0x9bdc06a7, 0xc19bf174,
      0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc, 0x2de92c6f, 0x4a7484aa, 0x5cb0a9dc, 0x76f988da,
      0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7, 0xc6e00bf3, 0xd5a79147, 0x06ca6351, 0x14292967,
      0x27b70a85, 0x2e1b2138, 0x4d2c6dfc, 0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85,
      0xa2bfe8a1, 0xa81a664b, 0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070,
      0x19a4c116, 0x1e376c08, 0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3,
      0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208, 0x90befffa, 0xa4506ceb, 0xbef9a3f7, 0xc67178f2};
  std::array<std::uint32_t, 8> state{0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                                     0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
  const std::uint64_t bits = std::uint64_t{text.size()} * 8;
  text.push_back('\x80');
  while (text.size() % 64 != 56) text.push_back('\0');
  for (int shift = 56; shift >= 0; shift -= 8) text.push_back(static_cast<char>(bits >> shift & 0xff));
  for (std::size_t block = 0; block < text.size(); block += 64) {
    std::array<std::uint32_t, 64> w{};
    for (std::size_t i = 0; i < 64; ++i) {
      w[i / 4] = i % 4 == 0 ? 0 : w[i / 4];
      w[i / 4] = w[i / 4] << 8 | static_cast<unsigned char>(text[block + i]);
    }
    for (std::size_t i = 16; i < 64; ++i) {
      const std::uint32_t low = std::rotr(w[i - 15], 7) ^ std::rotr(w[i - 15], 18) ^ w[i - 15] >> 3;
      const std::uint32_t high = std::rotr(w[i - 2], 17) ^ std::rotr(w[i - 2], 19) ^ w[i - 2] >> 10;
      w[i] = w[i - 16] + low + w[i - 7] + high;
    }
    auto [a, b, c, d, e, f, g, h] = state;
    for (std::size_t i = 0; i < 64; ++i) {
      const std::uint32_t first = h + (std::rotr(e, 6) ^ std::rotr(e, 11) ^ std::rotr(e, 25)) +
                                  ((e & f) ^ (~e & g)) + kRounds[i] + w[i];
      const std::uint32_t second =
          (std::rotr(a, 2) ^ std::rotr(a, 13) ^ std::rotr(a, 22)) + ((a & b) ^ (a & c) ^ (b & c));
      h = g, g = f, f = e, e = d + first, d = c, c = b, b = a, a = first + second;
    }
    const std::array<std::uint32_t, 8> sum{a, b, c, d, e, f, g, h};
    for (std::size_t i = 0; i < 8; ++i) state[i] += sum[i];
  }
  std::string hex;
  for (const std::uint32_t word : state)
    for (int shift = 28; shift >= 0; shift -= 4) hex.push_back("0123456789abcdef"[word >> shift & 0xf]);
  return hex;
}

/// Describes a message's members, and those of the messages that they hold.
class TypeDescription {
 public:
  template <Message M>
  static std::string hash() {
    std::map<std::string, std::string> described;
    describe<M>(described);
    const std::string own = described.extract(std::string(M::kType)).mapped();
    std::string others;
    for (const auto& [name, text] : described) others += (others.empty() ? "" : ", ") + text;
    return "RIHS01_" + sha256(R"({"type_description": )" + own + R"(, "referenced_type_descriptions": [)" +
                              others + "]}");
  }

 private:
  struct Kind {
    int id = 0;
    std::size_t capacity = 0;
    std::string nested;
  };
  template <class T>
  static Kind kind_of(std::map<std::string, std::string>& described) {
    if constexpr (Message<T>) {
      describe<T>(described);
      return {1, 0, std::string(T::kType)};
    } else if constexpr (requires { std::tuple_size<T>::value; }) {
      Kind kind = kind_of<typename T::value_type>(described);
      return {kind.id + 48, std::tuple_size_v<T>, kind.nested};
    } else if constexpr (std::is_same_v<T, std::string>) {
      return {17, 0, ""};
    } else if constexpr (requires { typename T::value_type; }) {
      Kind kind = kind_of<typename T::value_type>(described);
      return {kind.id + 144, 0, kind.nested};
    } else if constexpr (std::is_same_v<T, bool>) {
      return {15, 0, ""};
    } else if constexpr (std::is_floating_point_v<T>) {
      return {sizeof(T) == 4 ? 10 : 11, 0, ""};
    } else {  // int8 2, uint8 3, int16 4, …, uint64 9
      return {2 * std::bit_width(sizeof(T)) + (std::is_unsigned_v<T> ? 1 : 0), 0, ""};
    }
  }
  template <Message M>
  static void describe(std::map<std::string, std::string>& described) {
    std::string fields;
    M message;
    M::each(message, [&](std::string_view name, auto& value) {
      const Kind kind = kind_of<std::remove_cvref_t<decltype(value)>>(described);
      fields += (fields.empty() ? R"({"name": ")" : R"(, {"name": ")") + std::string(name) +
                R"(", "type": {"type_id": )" + std::to_string(kind.id) + R"(, "capacity": )" +
                std::to_string(kind.capacity) + R"(, "string_capacity": 0, "nested_type_name": ")" +
                kind.nested + "\"}}";
    });
    described[std::string(M::kType)] =
        R"({"type_name": ")" + std::string(M::kType) + R"(", "fields": [)" + fields + "]}";
  }
};

}  // namespace cairn::ros
