// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/core/parallel.hpp>
#include <cairn/matching/subpixel.hpp>
#include <limits>

namespace cairn {
namespace {

/// How steeply the curve through (−1, before), (0, least), (1, after) rises.
template <SubpixelMethod kMethod>
float steepness(float before, float least, float after) {
  if constexpr (kMethod == SubpixelMethod::parabola) {
    return (before - least) + (after - least);
  } else {
    return std::max(before, after) - least;
  }
}

/// Where that curve is lowest: within ±1/2, as `least` is the least of the three. A missing neighbour (∞) and
/// three equal costs give 0.
template <SubpixelMethod kMethod>
float lowest(float before, float least, float after) {
  const float rise = steepness<kMethod>(before, least, after);
  const bool defined = rise > 0 && rise < kNoCost;
  // The divisor is chosen, not the branch: rows stay free of jumps that depend on the picture.
  const float offset = 0.5F * (before - after) / (defined ? rise : 1.0F);
  return defined ? offset : 0.0F;
}

template <SubpixelMethod kMethod>
void refine_row(const Matches& matches, int y, float* refined) {
  const float* before = matches.cost_before.row(y);
  const float* least = matches.cost.row(y);
  const float* after = matches.cost_after.row(y);
  for (int x = 0; x < matches.best.width(); ++x) refined[x] += lowest<kMethod>(before[x], least[x], after[x]);
}

}  // namespace

Image<float> refine_subpixel(const Matches& matches, const SubpixelConfig& config, const Exec& exec) {
  Image<float> refined(matches.best.size(), exec.pool);
  const bool refines = config.enabled && !matches.cost_before.empty();
  parallel_for(exec, refined.height(), 16, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      const std::int16_t* best = matches.best.row(y);
      float* out = refined.row(y);
      for (int x = 0; x < refined.width(); ++x) {
        out[x] = best[x] == kNoMatch ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(best[x]);
      }
      if (!refines) continue;
      config.method == SubpixelMethod::parabola ? refine_row<SubpixelMethod::parabola>(matches, y, out)
                                                : refine_row<SubpixelMethod::equiangular>(matches, y, out);
    }
  });
  return refined;
}

}  // namespace cairn
