// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "obstacles.hpp"

#include <cmath>
#include <limits>

namespace cairn::reference {
namespace {

struct Behind {
  std::optional<float> floor;       // not above the horizon
  std::optional<float> wall;        // the nearest
  std::optional<float> free_floor;  // not behind a wall
  float barrier = 0;                // what an obstacle is in front of
};

Behind behind(const ObstacleCues& cues, const std::optional<StereoRig>& rig, int x, int y) {
  const auto at = [&](const GroundPlane& plane) {
    return plane.disparity_px(static_cast<float>(x), static_cast<float>(y));
  };
  const float infinity = rig ? rig->doffs_px : 0;
  Behind found;
  if (cues.ground.plane && at(*cues.ground.plane) + infinity > 0) found.floor = at(*cues.ground.plane);
  const auto& planes = cues.background.planes;
  for (std::size_t i = cues.background.has_floor ? 1 : 0; i < planes.size(); ++i)
    found.wall = found.wall ? std::max(*found.wall, at(planes[i])) : at(planes[i]);
  if (found.floor && (!found.wall || *found.floor >= *found.wall)) found.free_floor = found.floor;
  if (cues.ground.plane) {
    found.barrier = found.floor ? *found.floor : -infinity;
  } else {
    found.barrier = std::max(found.wall.value_or(-infinity), -infinity);
  }
  return found;
}

}  // namespace

Image<ObstacleLabel> label_obstacles(const ObstacleCues& cues, const std::optional<StereoRig>& rig,
                                     const GroundConfig& config) {
  const Size size = cues.disparity.disparity_px.size();
  const auto is_refined = [&](int x, int y) {
    return !cues.refined_px.empty() && cues.refined_confidence(x, y) >= kLikelyRefined;
  };
  const auto disparity_px = [&](int x, int y) {
    return is_refined(x, y) ? cues.refined_px(x, y) : cues.disparity.disparity_px(x, y);
  };
  const auto surface_disparity_px = [&](int x, int y) {
    return cues.surface_disparity_px.empty() || is_refined(x, y) ? disparity_px(x, y)
                                                                 : cues.surface_disparity_px(x, y);
  };
  const auto confidence = [&](int x, int y) {
    if (is_refined(x, y)) return cues.refined_confidence(x, y);
    return cues.confidence.empty() ? 1.0F : cues.confidence(x, y);
  };
  const auto is_on_floor = [&](int x, int y) {
    const auto floor = behind(cues, rig, x, y).free_floor;
    return floor && std::abs(surface_disparity_px(x, y) - *floor) <= config.margin;
  };
  const auto likely_floor = [&](int x, int y) {
    if (!cues.floor_probability.empty() && !std::isnan(cues.floor_probability(x, y)))
      return cues.floor_probability(x, y);
    return is_on_floor(x, y) ? 1.0F : std::numeric_limits<float>::quiet_NaN();
  };
  const auto is_obstacle = [&](int x, int y) {
    return disparity_px(x, y) - behind(cues, rig, x, y).barrier > config.margin && confidence(x, y) >= 0.5F;
  };
  Image<ObstacleLabel> space(size);
  for (int y = 0; y < space.height(); ++y) {
    for (int x = 0; x < space.width(); ++x) {
      ObstacleLabel& is = space(x, y);
      const float likely = likely_floor(x, y);
      is = ObstacleLabel::unknown;
      if (std::isnan(likely) ? is_obstacle(x, y) : likely < kUnlikelyFloor) is = ObstacleLabel::obstacle;
      if (likely >= kLikelyFloor) is = ObstacleLabel::floor;
      if (has(cues.disparity.reject(x, y), Reject::sky)) is = ObstacleLabel::sky;
      if (cues.objects(x, y) != ObjectId::none) is = ObstacleLabel::obstacle;
    }
  }
  return space;
}

Image<float> obstacle_disparities(View<const ObstacleLabel> space, const ObstacleCues& cues) {
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  Image<float> all = cues.disparity.disparity_px.clone();
  for (int y = 0; y < all.height() && !cues.refined_px.empty(); ++y) {
    for (int x = 0; x < all.width(); ++x) {
      float& d = all(x, y);
      const bool is_obstacle = space(x, y) == ObstacleLabel::obstacle;
      if (is_obstacle && cues.refined_confidence(x, y) >= kLikelyRefined) d = cues.refined_px(x, y);
      if (!cues.ground.plane) continue;
      const float off = d - cues.ground.plane->disparity_px(static_cast<float>(x), static_cast<float>(y));
      if (space(x, y) == ObstacleLabel::floor && std::abs(off) > 1) d = kNone;
      if (is_obstacle && cues.objects(x, y) == ObjectId::none && off <= 1) d = kNone;
    }
  }
  return all;
}

}  // namespace cairn::reference
