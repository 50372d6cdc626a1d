// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cairn/core/fields.hpp>
#include <cairn/core/stereo_pair.hpp>
#include <cairn/stereo/disparity_map.hpp>
#include <optional>
#include <vector>

namespace cairn {

enum class GroundSource : std::uint8_t { off, automatic, points, pose };
inline constexpr std::array kGroundSources{Choice<GroundSource>{"off", GroundSource::off},
                                           Choice<GroundSource>{"automatic", GroundSource::automatic},
                                           Choice<GroundSource>{"points", GroundSource::points},
                                           Choice<GroundSource>{"pose", GroundSource::pose}};

struct GroundConfig {
  GroundSource source = GroundSource::automatic;  // points, pose: for a rig that does not move
  float margin = 1.0F;      // px of disparity, 0 … 64; higher for an uneven floor or inexact matches
  bool label_floor = true;  // off: the floor is an ordinary surface
  KnownGround known;        // not an option: from the calibration, for points and pose
};
template <class V>
void fields(GroundConfig& c, V&& v) {
  v("source", c.source, "", "floor from a fit per frame, calibration points or pose, or off", kGroundSources);
  constexpr Condition kGround = unless("ground.source", "off");
  v("margin", c.margin, "px", "largest distance of floor pixels from the floor plane", range(0.0F, 64.0F),
    kGround);
  v("label_floor", c.label_floor, "", "exclusion of floor pixels from objects", Any{},
    when("pipeline.method", "paper"));
}

/// The floor in the left image as disparity: d = a·x + b·y + c, pixels in px. (docs/stages/ground.md)
struct GroundPlane {
  float a = 0;
  float b = 0;
  float c = 0;
  [[nodiscard]] float disparity_px(float x, float y) const { return a * x + b * y + c; }
};

/// The reason for a missing ground.
enum class Refusal : std::uint8_t { none, off, no_rig, too_few_matches, no_plane, implausible, unlikely };
inline constexpr std::array kRefusals{
    Choice<Refusal>{"none", Refusal::none},
    Choice<Refusal>{"switched off", Refusal::off},
    Choice<Refusal>{"no calibration", Refusal::no_rig},
    Choice<Refusal>{"too few matches", Refusal::too_few_matches},
    Choice<Refusal>{"no plane has enough support", Refusal::no_plane},
    Choice<Refusal>{"the best plane is no floor (it does not rise towards the camera)", Refusal::implausible},
    Choice<Refusal>{
        "the best plane is hardly a floor (far below the camera, right under it or rolled, with little "
        "support)",
        Refusal::unlikely}};

struct Ground {
  std::optional<GroundPlane> plane;
  float support = 0;  // 0 … 1: share of the valid pixels below the horizon on the plane (given grounds: 1)
  float residual_px = 0;  // root mean square distance of the supporting pixels from the plane
  Refusal refusal = Refusal::none;
};

/// Finds the floor. automatic: robust plane fit to the disparity map, deterministic, refused with a reason if
/// no plane has enough support. points: least-squares plane through the pairs (RANSAC above four). pose: from
/// height, pitch and roll; needs a rig and a height. (docs/stages/ground.md; paper)
Ground fit_ground(const DisparityMap& disparity, const std::optional<StereoRig>& rig,
                  const GroundConfig& config, const Exec& exec);

/// The same from bare disparities, NaN = hole, for example from trusted ones only. `left`, if given, also
/// allows a floor that mirrors so well that it has hardly any disparities of its own, and refuses one that only
/// supposed mirror images support.
Ground fit_ground(View<const float> disparity_px, const std::optional<StereoRig>& rig,
                  const GroundConfig& config, const Exec& exec, View<const Gray> left = {});

/// The plane through manually picked pairs. Throws Error for fewer than four, or collinear ones. Called by
/// validate(Config), so fit_ground cannot fail.
Ground ground_from_points(const std::vector<PointPair>& points);

/// Throws Error unless the height is 0.01 … 100 m, the angles are −89 … 89°, and the points, if any, determine a plane.
void validate(const KnownGround& known);
/// Throws Error if `source` is points or pose and `known` lacks the data or has invalid data.
void validate(const GroundConfig& config, bool has_rig);

/// `ground`, or, if that was refused for lack of support, a ground fitted to all disparities: a floor without
/// texture has no textured disparities. `textured_px` and `left`, if given, refuse planes that textured
/// disparities show to be upright, and allow a floor that both its mirror images and its own disparities show.
Ground likely_ground(const Ground& ground, const DisparityMap& disparity, const std::optional<StereoRig>& rig,
                     const GroundConfig& config, const Exec& exec, View<const float> textured_px = {},
                     View<const Gray> left = {});

/// Rejects matches below the floor, which are reflections: d < d_ground − margin → Reject::below_ground. A
/// surface seen beyond the edge of the floor is kept: at least 2 % of the image, with steps of at most 0.2
/// px; or nearer than twice the floor there, with steps of d − d_ground of at most 0.5 px. Only pixels below the horizon are checked (d_ground + doffs > 0 with a rig, else d_ground > 0).
/// Without a ground, no effect. (docs/stages/ground.md; paper)
DisparityMap reject_below_ground(DisparityMap disparity, const Ground& ground,
                                 const std::optional<StereoRig>& rig, const GroundConfig& config,
                                 const Exec& exec);

/// The disparities of the visible surfaces, px: the ground where a match was rejected as below the ground,
/// since the ground mirrors it. Holes elsewhere. `disparity` as returned by reject_below_ground().
Image<float> floor_under_reflections(const DisparityMap& disparity, const Ground& ground, const Exec& exec);

/// 255 for pixels below the horizon with |d − d_ground| ≤ margin, else 0. Empty without a ground or if
/// label_floor is off.
Image<std::uint8_t> label_floor(const DisparityMap& disparity, const Ground& ground,
                                const std::optional<StereoRig>& rig, const GroundConfig& config,
                                const Exec& exec);

}  // namespace cairn
