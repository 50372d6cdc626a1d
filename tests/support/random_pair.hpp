// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/stereo_pair.hpp>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

namespace cairn {

/// Two windows of larger images, so that rows are unaligned and the stride is odd. Black patches,
/// so that windows have no energy, and few grey levels in places, so that costs tie and every penalty occurs.
struct RandomPair {
  Size size;
  std::ptrdiff_t stride;
  std::vector<Gray> left;
  std::vector<Gray> right;

  RandomPair(Size picture_size, unsigned seed)
      : size(picture_size), stride(size.width + 7), left(count()), right(count()) {
    std::mt19937 random(seed);
    for (std::size_t i = 0; i < left.size(); ++i) {
      left[i] = dot(static_cast<std::uint32_t>(random()), i);
      right[i] = i >= 3 && random() % 4 != 0 ? left[i - 3] : dot(static_cast<std::uint32_t>(random()), i);
    }
  }
  [[nodiscard]] StereoPair pair() const {
    return StereoPair::from(View<const Gray>(left.data() + 3, size, stride),
                            View<const Gray>(right.data() + 3, size, stride));
  }

 private:
  [[nodiscard]] std::size_t count() const {
    return static_cast<std::size_t>(stride) * static_cast<std::size_t>(size.height + 1);
  }
  static Gray dot(std::uint32_t bits, std::size_t i) {
    switch (i / 53 % 4) {
      case 0:
        return 0;
      case 1:
        return static_cast<Gray>(100 + bits % 4);
      case 2:
        return static_cast<Gray>(250 + bits % 6);
      default:
        return static_cast<Gray>(bits >> 24);
    }
  }
};

}  // namespace cairn
