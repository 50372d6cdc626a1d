// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <algorithm>
#include <cairn/core/exec.hpp>
#include <cairn/stereo/match.hpp>
#include <random>
#include <vector>

#include "grids.hpp"

/// Input for the tests that compare checks with their slow twins.
namespace cairn::random_input {

inline Exec threads(int count) {
  Exec exec = Exec::with_threads(count);
  exec.pool = Pool::make();
  return exec;
}

/// All widths around one, two and three vectors, and heights that threads share unevenly.
inline std::vector<Size> sizes() {
  std::vector<Size> all{{1, 1}, {2, 1}, {1, 2}, {1, 70}, {70, 1}, {37, 131}, {130, 97}};
  for (int width = 3; width <= 67; width += 4) all.push_back({width, 2 + width % 7});
  return all;
}

inline Image<float> random_floats(Size size, int values, float step, std::uint32_t seed) {
  const Image<int> whole = grids::random_image<int>(size, 0, values, seed);
  Image<float> image(size);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) image(x, y) = static_cast<float>(whole(x, y)) * step;
  }
  return image;
}

/// Matches with few values, so that there are ties; with holes, and offsets to other rows.
inline Matches random_matches(Size size, int band, std::uint32_t seed) {
  std::mt19937 random(seed);
  Matches m{Image<std::int16_t>(size),
            grids::random_image<std::int16_t>(size, -2, 9, seed + 1),
            {},
            random_floats(size, 4, 0.25F, seed + 2),
            random_floats(size, 5, 0.25F, seed + 3),
            random_floats(size, 6, 0.2F, seed + 4),
            {},
            {}};
  if (band > 0) m.row_offset = Image<std::int8_t>(size, 0, {});
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const int least = std::max(-2, x - (size.width - 1));
      const int most = std::min(9, x);
      const int d = least + static_cast<int>(random() % static_cast<unsigned>(most - least + 1));
      const bool none = random() % 8 == 0;
      m.best(x, y) = none ? kNoMatch : static_cast<std::int16_t>(d);
      if (none) m.cost(x, y) = m.runner_up(x, y) = m.mean_cost(x, y) = kNoCost;
      if (random() % 8 == 0) m.runner_up(x, y) = kNoCost;
      if (band > 0) {
        const int row = y + static_cast<int>(random() % static_cast<unsigned>(2 * band + 1)) - band;
        m.row_offset(x, y) = static_cast<std::int8_t>(std::clamp(row, 0, size.height - 1) - y);
      }
    }
  }
  return m;
}

}  // namespace cairn::random_input
