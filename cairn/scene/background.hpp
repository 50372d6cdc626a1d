// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/scene/ground_plane.hpp>
#include <optional>
#include <vector>

namespace cairn {

struct BackgroundConfig {
  int max_walls = 3;  // 0 … 8; 0 outdoors, where only the floor bounds the scene
  // No options, constants:
  float tolerance = 2.3F;         // ‰ of the width; how far a disparity may lie from the wall it supports
  float min_share = 1.5F;         // % of the evidence; least support of a wall
  float min_share_square = 0.4F;  // % of the evidence; the same of a wall square on the first one
  float max_behind = 33.0F;       // % of the support; most evidence that may lie behind a wall
};
template <class V>
void fields(BackgroundConfig& c, V&& v) {
  v("max_walls", c.max_walls, "", "how many walls are looked for besides the floor", range(0, 8),
    when("fusion.method", "hierarchy"));
}

/// How far a disparity may lie from a wall that it supports, px.
inline float wall_tolerance_px(const BackgroundConfig& config, Size image) {
  return config.tolerance * 0.001F * static_cast<float>(image.width);
}

/// The planes that bound the scene from behind: the floor, if there is one, and walls. A room seen from
/// inside is convex, so a pixel's background is the nearest of them, and nothing but reflections lies behind
/// it.
struct Background {
  std::vector<GroundPlane> planes;
  bool has_floor = false;  // it is the first of them
  /// At least 0: infinitely far away is behind everything.
  [[nodiscard]] float disparity_px(float x, float y) const;
};

/// Finds walls: planes upright on the floor, through much of the evidence that stands before the background
/// found so far, with hardly any evidence behind them; that tells a wall from a box's side. Deterministic.
/// Without a ground the planes may lean as they like. `evidence_px` as find_evidence() gives it. (beyond the
/// paper)
Background fit_background(View<const float> evidence_px, const Ground& ground,
                          const std::optional<StereoRig>& rig, const BackgroundConfig& config,
                          const Exec& exec);

}  // namespace cairn
