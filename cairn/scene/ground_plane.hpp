// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cairn/core/fields.hpp>
#include <cairn/core/stereo_pair.hpp>
#include <cairn/disparity/disparity_map.hpp>
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
  float margin = 1.0F;      // px of disparity, 0 … 64; more for an uneven floor or inexact matches
  bool label_floor = true;  // off: the floor is a surface like others
  KnownGround known;        // no option: what the rig's calibration says, for the sources points and pose
};
template <class V>
void fields(GroundConfig& c, V&& v) {
  v("source", c.source, "",
    "where the floor comes from: fitted to each frame, the calibration's points or pose, nowhere",
    kGroundSources);
  constexpr Condition kGround = unless("ground.source", "off");
  v("margin", c.margin, "px", "how far a disparity may lie from the floor's and still be floor",
    range(0.0F, 64.0F), kGround);
  v("label_floor", c.label_floor, "", "label matches on the floor; the floor is no object", Any{}, kGround);
}

/// The floor as the left image's disparity: d = a·x + b·y + c, pixels in px. (docs/stages/ground.md)
struct GroundPlane {
  float a = 0;
  float b = 0;
  float c = 0;
  [[nodiscard]] float disparity_px(float x, float y) const { return a * x + b * y + c; }
};

/// Why there is no ground.
enum class Refusal : std::uint8_t { none, off, no_rig, too_few_matches, no_plane, implausible };
inline constexpr std::array kRefusals{
    Choice<Refusal>{"none", Refusal::none},
    Choice<Refusal>{"switched off", Refusal::off},
    Choice<Refusal>{"no calibration", Refusal::no_rig},
    Choice<Refusal>{"too few matches", Refusal::too_few_matches},
    Choice<Refusal>{"no plane has enough support", Refusal::no_plane},
    Choice<Refusal>{"the best plane is no floor (it does not rise towards the camera)",
                    Refusal::implausible}};

struct Ground {
  std::optional<GroundPlane> plane;
  float support =
      0;  // 0 … 1: share of the valid pixels under the horizon that lie on the plane (given grounds: 1)
  float residual_px = 0;  // root mean square distance of the supporting evidence from the plane
  Refusal refusal = Refusal::none;
};

/// Finds the floor. automatic: a robust plane fit to the disparity map, deterministic, refused with a reason
/// when no plane has enough support. points: the plane of least squares through the pairs (RANSAC beyond
/// four). pose: from height, pitch and roll; needs a rig and a height. (docs/stages/ground.md; paper)
Ground fit_ground(const DisparityMap& disparity, const std::optional<StereoRig>& rig,
                  const GroundConfig& config, const Exec& exec);

/// The same from bare disparities, NaN for holes: from those alone that deserve trust, for instance. `left`,
/// if given, also shows the floor that mirrors so well that there are hardly any disparities of its own.
Ground fit_ground(View<const float> disparity_px, const std::optional<StereoRig>& rig,
                  const GroundConfig& config, const Exec& exec, View<const Gray> left = {});

/// The plane through hand-given pairs. Throws Error for fewer than four, or where all lie on one line.
/// Called by validate(Config), so that fit_ground cannot fail.
Ground ground_from_points(const std::vector<PointPair>& points);

/// Throws Error where `source` is points or pose and `known` does not say it, or not soundly.
void validate(const GroundConfig& config, bool has_rig);

/// `ground` itself, or where it was refused for want of evidence a ground fitted to all disparities: a plain
/// floor has no texture that would vouch for it.
Ground likely_ground(const Ground& ground, const DisparityMap& disparity, const std::optional<StereoRig>& rig,
                     const GroundConfig& config, const Exec& exec);

/// Rejects matches under the floor, which are reflections: d < d_ground − margin → Reject::below_ground. A
/// surface seen past the floor's edge stays: at least 2 % of the image, of steps of at most 0.2 px.
/// Nothing is above the horizon (d_ground + doffs ≤ 0 where a rig tells doffs, else d_ground ≤ 0). No ground:
/// nothing happens. (docs/stages/ground.md; paper)
DisparityMap reject_below_ground(DisparityMap disparity, const Ground& ground,
                                 const std::optional<StereoRig>& rig, const GroundConfig& config,
                                 const Exec& exec);

/// The disparities of what is seen, px: where a match was rejected as below the ground, what is seen is the
/// ground, which mirrors it. Holes else. `disparity` as reject_below_ground() leaves it.
Image<float> floor_under_reflections(const DisparityMap& disparity, const Ground& ground, const Exec& exec);

/// 255 where |d − d_ground| ≤ margin under the horizon, else 0. Empty where there is no ground or label_floor
/// is off.
Image<std::uint8_t> label_floor(const DisparityMap& disparity, const Ground& ground,
                                const std::optional<StereoRig>& rig, const GroundConfig& config,
                                const Exec& exec);

}  // namespace cairn
