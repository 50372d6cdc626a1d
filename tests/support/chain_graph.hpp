// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/regions/region_graph.hpp>
#include <utility>
#include <vector>

namespace cairn::chain {

struct Member {
  int mean = 0;
  int pixels = 1;
  int spread = 0;  // half of the pixels are this much above the mean, half below
  bool is_valid = true;
  bool is_floor = false;
};

/// A chain of regions, each touching the previous and the next one.
inline RegionGraph graph(const std::vector<Member>& members) {
  RegionGraph result;
  int x = 0;
  for (std::size_t i = 0; i < members.size(); ++i) {
    const Member& m = members[i];
    const int n = m.is_valid ? m.pixels : 0;
    result.nodes.push_back({.pixel_count = m.pixels,
                            .valid_count = n,
                            .sum = n * m.mean,
                            .sum_of_squares = n * (m.mean * m.mean + m.spread * m.spread),
                            .first_pixel = x,
                            .box = {x, 0, m.pixels, 1},
                            .is_floor = m.is_floor});
    x += m.pixels;
    result.first_arc.push_back(static_cast<std::int32_t>(result.arcs.size()));
    if (i > 0) result.arcs.push_back(static_cast<std::int32_t>(i) - 1);
    if (i + 1 < members.size()) result.arcs.push_back(static_cast<std::int32_t>(i) + 1);
  }
  result.first_arc.push_back(static_cast<std::int32_t>(result.arcs.size()));
  return result;
}

}  // namespace cairn::chain
