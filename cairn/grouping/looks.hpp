// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cairn/core/geometry.hpp>
#include <cstddef>

namespace cairn {

using Colour = std::array<double, 3>;

/// Mean square difference of the channels.
inline double difference(const Colour& p, const Colour& q) {
  double sum = 0;
  for (std::size_t c = 0; c < 3; ++c) sum += (p[c] - q[c]) * (p[c] - q[c]);
  return sum / 3;
}

/// A facet as the colour models see it. Private to the library.
struct Look {
  Colour colour{};  // mean; its grey three times where there is no colour
  Rect box;
  double pixels = 0;
  bool seen = false;  // to be figure
};

}  // namespace cairn
