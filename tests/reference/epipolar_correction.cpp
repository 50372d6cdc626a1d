// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "epipolar_correction.hpp"

#include <algorithm>
#include <cmath>

namespace cairn::reference {
namespace {

/// Keys's cubic (1981) with a = −3/4, `distance` rows away.
double cubic(double distance) {
  constexpr double a = -0.75;
  const double s = std::abs(distance);
  if (s <= 1) return (a + 2) * s * s * s - (a + 3) * s * s + 1;
  return s < 2 ? a * s * s * s - 5 * a * s * s + 8 * a * s - 4 * a : 0;
}

}  // namespace

Image<Gray> shift_rows(View<const Gray> right, const EpipolarOffset& offset) {
  Image<Gray> moved(right.size());
  for (int y = 0; y < right.height(); ++y) {
    for (int x = 0; x < right.width(); ++x) {
      const float from_middle = static_cast<float>(x) - 0.5F * static_cast<float>(right.width() - 1);
      const double rows = std::round(64.0F * (offset.rows + offset.rows_per_px * from_middle)) / 64.0;
      const int above = static_cast<int>(std::floor(rows));
      int sum = 32;
      int remaining = 64;
      const auto add = [&](int row, int weight) {
        remaining -= weight;
        sum += weight * right(x, std::clamp(y + row, 0, right.height() - 1));
      };
      for (const int row : {above - 1, above + 1, above + 2}) {
        add(row, static_cast<int>(std::lround(64 * cubic(rows - row))));
      }
      add(above, remaining);
      moved(x, y) = static_cast<Gray>(std::clamp(static_cast<int>(std::floor(sum / 64.0)), 0, 255));
    }
  }
  return moved;
}

}  // namespace cairn::reference
