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
  GroundSource source = GroundSource::automatic;
  std::vector<PointPair> points;  // ≥ 4, not all on a line
  float height = 1.0F;            // m, of the left camera above the floor
  float pitch = 0.0F;             // degrees, positive looks down
  float roll = 0.0F;              // degrees, positive tilts the camera's right side down
  float margin = 1.0F;            // px of disparity
  bool label_floor = true;
};
template <class V>
void fields(GroundConfig& c, V&& v) {
  v("source", c.source, "",
    "where the floor comes from: fitted to each frame, hand-given points, the camera's pose, nowhere",
    kGroundSources);
  v("points", c.points, "px", "floor points as x_left,y_left,x_right,y_right; at least four, separated by ;",
    Any{});
  v("height", c.height, "m", "height of the left camera above the floor (source pose)", range(0.01F, 100.0F));
  v("pitch", c.pitch, "degrees", "camera pitch, positive looks down (source pose)", range(-89.0F, 89.0F));
  v("roll", c.roll, "degrees", "camera roll, positive lowers the camera's right side (source pose)",
    range(-89.0F, 89.0F));
  v("margin", c.margin, "px", "how far a disparity may lie from the floor's and still be floor",
    range(0.0F, 64.0F));
  v("label_floor", c.label_floor, "", "label matches on the floor; the floor is no object", Any{});
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
/// four). pose: from height, pitch and roll; needs a rig. (docs/stages/ground.md; paper, "ground plane")
Ground fit_ground(const DisparityMap& disparity, const std::optional<StereoRig>& rig,
                  const GroundConfig& config, const Exec& exec);

/// The same from bare disparities, NaN for holes: from those alone that deserve trust, for instance.
Ground fit_ground(View<const float> disparity_px, const std::optional<StereoRig>& rig,
                  const GroundConfig& config, const Exec& exec);

/// The plane through hand-given pairs. Throws Error for fewer than four, or where all lie on one line.
/// Called by validate(Config), so that fit_ground cannot fail.
Ground ground_from_points(const std::vector<PointPair>& points);

/// Rejects matches under the floor, which are reflections: d < d_ground − margin → Reject::below_ground.
/// Nothing is above the horizon (d_ground + doffs ≤ 0 where a rig tells doffs, else d_ground ≤ 0). No ground:
/// nothing happens. (docs/stages/ground.md; paper)
DisparityMap reject_below_ground(DisparityMap disparity, const Ground& ground,
                                 const std::optional<StereoRig>& rig, const GroundConfig& config,
                                 const Exec& exec);

/// 255 where |d − d_ground| ≤ margin under the horizon, else 0. Empty where there is no ground or label_floor
/// is off.
Image<std::uint8_t> label_floor(const DisparityMap& disparity, const Ground& ground,
                                const std::optional<StereoRig>& rig, const GroundConfig& config,
                                const Exec& exec);

}  // namespace cairn
