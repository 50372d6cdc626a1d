// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cstddef>
#include <cstdint>

namespace cairn {

/// Knuth's MMIX generator: the same numbers on every machine.
class Random {
 public:
  /// A number in 0 … n − 1.
  std::size_t below(std::size_t n) {
    state_ = state_ * 6364136223846793005ULL + 1442695040888963407ULL;
    return static_cast<std::size_t>((state_ >> 33U) % n);  // the high bits are the random ones
  }

 private:
  std::uint64_t state_ = 0x9E3779B97F4A7C15ULL;
};

}  // namespace cairn
