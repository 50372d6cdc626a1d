// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/core/parallel.hpp>
#include <cairn/matching/subpixel.hpp>
#include <limits>

namespace cairn {
namespace {

/// Where the parabola through (−1, before), (0, least), (1, after) has its vertex: within ±1/2, as `least` is
/// the least of the three. A missing neighbour (∞) and three equal costs give 0.
float vertex(float before, float least, float after) {
  const float curvature = (before - least) + (after - least);
  const bool defined = curvature > 0 && curvature < kNoCost;
  // The divisor is chosen, not the branch: rows stay free of jumps that depend on the picture.
  const float offset = 0.5F * (before - after) / (defined ? curvature : 1.0F);
  return defined ? offset : 0.0F;
}

}  // namespace

Image<float> refine_subpixel(const Matches& matches, const SubpixelConfig& config, const Exec& exec) {
  Image<float> refined(matches.best.size(), exec.pool);
  const bool parabola = config.enabled && !matches.cost_before.empty();
  parallel_for(exec, refined.height(), 16, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      const std::int16_t* best = matches.best.row(y);
      float* out = refined.row(y);
      for (int x = 0; x < refined.width(); ++x) {
        out[x] = best[x] == kNoMatch ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(best[x]);
      }
      if (!parabola) continue;
      const float* before = matches.cost_before.row(y);
      const float* least = matches.cost.row(y);
      const float* after = matches.cost_after.row(y);
      for (int x = 0; x < refined.width(); ++x) out[x] += vertex(before[x], least[x], after[x]);
    }
  });
  return refined;
}

}  // namespace cairn
