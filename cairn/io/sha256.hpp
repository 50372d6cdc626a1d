// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace cairn::io {

/// Incremental SHA-256 (FIPS 180-4). (docs/decisions/own_sha256.md)
class Sha256 {
 public:
  void add(std::string_view bytes);
  /// The digest of all bytes so far, as 64 hexadecimal digits. More may be added afterwards.
  [[nodiscard]] std::string hex() const;

 private:
  static constexpr std::size_t kBlock = 64;  // bytes

  void add_block(const unsigned char* block);

  std::array<std::uint32_t, 8> state_{0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                                      0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
  std::array<unsigned char, kBlock> waiting_{};  // bytes of an incomplete block
  std::size_t waiting_count_ = 0;
  std::uint64_t bytes_ = 0;
};

/// The digest of a text.
std::string sha256(std::string_view bytes);

}  // namespace cairn::io
