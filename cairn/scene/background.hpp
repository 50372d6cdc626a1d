// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/scene/ground_plane.hpp>
#include <optional>
#include <vector>

namespace cairn {

struct BackgroundConfig {
  int max_walls = 3;  // 0 … 8
  // Constants, not options:
  float tolerance = 2.3F;  // ‰ of the width; largest distance of a disparity from a wall that it supports
  float min_share = 1.5F;  // % of the textured disparities; smallest support of a wall
  float min_share_square = 0.4F;  // % of the textured disparities; for a wall perpendicular to the first
  float max_behind = 33.0F;       // % of the support; most textured disparities behind a wall
};
template <class V>
void fields(BackgroundConfig& c, V&& v) {
  v("max_walls", c.max_walls, "", "largest number of walls to fit", range(0, 8),
    when("pipeline.method", "region_tree"));
}

/// The largest distance of a disparity from a wall that it supports, px.
inline float wall_tolerance_px(const BackgroundConfig& config, Size image) {
  return config.tolerance * 0.001F * static_cast<float>(image.width);
}

/// The planes that bound the scene from behind: the floor, if there is one, and walls. A room seen from
/// inside is convex, so the background of a pixel is the nearest of these planes, and only reflections are
/// behind it.
struct Background {
  std::vector<GroundPlane> planes;
  bool has_floor = false;  // the floor is the first plane
  /// At least 0, the disparity at infinity.
  [[nodiscard]] float disparity_px(float x, float y) const;
};

/// Fits walls: planes perpendicular to the floor, supported by many textured disparities in front of the
/// background found so far, with hardly any behind them; the latter distinguishes a wall from the side of a
/// box. Deterministic. Without a ground, planes of any orientation. `textured_px` as returned by
/// select_textured(). (beyond the paper)
Background fit_background(View<const float> textured_px, const Ground& ground,
                          const std::optional<StereoRig>& rig, const BackgroundConfig& config,
                          const Exec& exec);

}  // namespace cairn
