// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <array>
#include <cairn/core/error.hpp>
#include <cairn/core/number_text.hpp>
#include <cairn/core/parallel.hpp>
#include <cairn/scene/floor_kernels.hpp>
#include <cairn/scene/floor_search.hpp>
#include <cairn/scene/ground_plane.hpp>
#include <cairn/scene/plane_through_pairs.hpp>
#include <cairn/stereo/speckle.hpp>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

namespace cairn {
namespace {

/// The floor seen by a camera at `height` over it. With n = (sin r·cos p, cos r·cos p, sin p), the direction
/// of gravity in the camera's frame for pitch p and roll r, a floor point X has n·X = height. Put into d +
/// doffs = focal·baseline / Z and X = Z·((x − cx)/focal, (y − cy)/focal, 1) that is linear in x and y.
GroundPlane ground_from_pose(const StereoRig& rig, const KnownGround& known) {
  const double pitch = double{known.camera_pitch_deg} * std::numbers::pi / 180;
  const double roll = double{known.camera_roll_deg} * std::numbers::pi / 180;
  const std::array down{std::sin(roll) * std::cos(pitch), std::cos(roll) * std::cos(pitch), std::sin(pitch)};
  const double scale = double{rig.baseline_m} / double{*known.camera_height_m};
  const double c =
      scale * (double{rig.focal_px} * down[2] - double{rig.cx_px} * down[0] - double{rig.cy_px} * down[1]) -
      double{rig.doffs_px};
  return {static_cast<float>(scale * down[0]), static_cast<float>(scale * down[1]), static_cast<float>(c)};
}

kernels::FloorRow floor_row(const Ground& ground, const std::optional<StereoRig>& rig,
                            const GroundConfig& config) {
  return {*ground.plane, rig ? rig->doffs_px : 0.0F, config.margin};
}

// A surface below the floor's plane is visible beyond the floor's edge. It is smooth and wide, unlike a mirror
// image, which is mixed with the floor's own pattern.
constexpr float kWidestStep = 0.2F;       // px; larger steps between neighbours separate two surfaces
constexpr float kWidestLevelStep = 0.5F;  // px; of the distance from the floor's disparity
constexpr double kMinSurface = 0.02;      // share of the image
constexpr int kMinPixels = 64;

/// Rejects all disparities except those of such surfaces.
SpeckleConfig all_but_surfaces(Size image, float widest_step_px) {
  const auto least = static_cast<int>(kMinSurface * static_cast<double>(image.area()));
  return {std::max(least, kMinPixels) - 1, widest_step_px};
}

void require_sound(const std::vector<PointPair>& points) {
  constexpr const char* kKey = "ground_points: ";
  if (points.size() < 4) {
    throw Error(kKey + std::string("found ") + std::to_string(points.size()) + " pairs, expected at least 4");
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto& p = points[i];
    for (const float value : {p.x_left, p.y_left, p.x_right, p.y_right}) {
      if (std::isfinite(value)) continue;
      throw Error(kKey + std::string("found a coordinate that is not finite in pair ") +
                  std::to_string(i + 1) + ", expected px");
    }
  }
}

}  // namespace

Ground ground_from_points(const std::vector<PointPair>& points) {
  require_sound(points);
  const auto found = plane_through(points);
  if (!found) {
    throw Error("ground_points: found " + std::to_string(points.size()) +
                " pairs that determine no plane, expected points that are not collinear");
  }
  double sum = 0;
  for (const auto& p : found->pairs) {
    const double off = double{p.x_left} - p.x_right - found->plane.disparity_px(p.x_left, p.y_left);
    sum += off * off;
  }
  const double residual = std::sqrt(sum / static_cast<double>(found->pairs.size()));
  return {found->plane, 1.0F, static_cast<float>(residual), Refusal::none};
}

void validate(const KnownGround& known) {
  const auto check = [](double value, const char* key, double lowest, double highest) {
    if (value >= lowest && value <= highest) return;
    throw Error(std::string(key) + " is " + shortest_text(value) + ", expected " + shortest_text(lowest) +
                " ... " + shortest_text(highest));
  };
  constexpr double kMinHeight = 0.01;
  constexpr double kMaxHeight = 100;
  constexpr double kMaxTilt = 89;
  if (known.camera_height_m) check(double{*known.camera_height_m}, "camera_height", kMinHeight, kMaxHeight);
  check(double{known.camera_pitch_deg}, "camera_pitch", -kMaxTilt, kMaxTilt);
  check(double{known.camera_roll_deg}, "camera_roll", -kMaxTilt, kMaxTilt);
  if (!known.points.empty()) (void)ground_from_points(known.points);
}

void validate(const GroundConfig& config, bool has_rig) {
  if (config.source == GroundSource::points || config.source == GroundSource::pose) validate(config.known);
  if (config.source == GroundSource::points && config.known.points.empty())
    throw Error("option ground.source: a ground from points needs ground_points in the calibration");
  if (config.source == GroundSource::pose && !(has_rig && config.known.camera_height_m)) {
    throw Error(
        "option ground.source: a ground from the camera pose needs a calibration with "
        "camera_height (--calib)");
  }
}

Ground fit_ground(const DisparityMap& disparity, const std::optional<StereoRig>& rig,
                  const GroundConfig& config, const Exec& exec) {
  return fit_ground(disparity.disparity_px, rig, config, exec);
}

Ground fit_ground(View<const float> disparity_px, const std::optional<StereoRig>& rig,
                  const GroundConfig& config, const Exec& exec, View<const Gray> left) {
  switch (config.source) {
    case GroundSource::automatic:
      return find_floor(disparity_px, {.left = left}, rig, exec);
    case GroundSource::points:
      return ground_from_points(config.known.points);
    case GroundSource::pose:
      if (!rig || !config.known.camera_height_m) return {std::nullopt, 0.0F, 0.0F, Refusal::no_rig};
      return {ground_from_pose(*rig, config.known), 1.0F, 0.0F, Refusal::none};
    case GroundSource::off:
      break;
  }
  return {std::nullopt, 0.0F, 0.0F, Refusal::off};
}

Ground likely_ground(const Ground& ground, const DisparityMap& disparity, const std::optional<StereoRig>& rig,
                     const GroundConfig& config, const Exec& exec, View<const float> textured_px,
                     View<const Gray> left) {
  if (ground.plane || config.source != GroundSource::automatic) return ground;
  return find_floor(disparity.disparity_px, {textured_px, left}, rig, exec);
}

DisparityMap reject_below_ground(DisparityMap disparity, const Ground& ground,
                                 const std::optional<StereoRig>& rig, const GroundConfig& config,
                                 const Exec& exec) {
  if (!ground.plane) return disparity;
  const Size size = disparity.disparity_px.size();
  const kernels::FloorKernels& run = kernels::floor_kernels(exec);
  const kernels::FloorRow floor = floor_row(ground, rig, config);
  const auto empty = [&] {
    return DisparityMap{Image<float>(size, exec.pool), Image<Reject>(size, Reject::none, exec.pool)};
  };
  DisparityMap below = empty(), little_below = empty();
  parallel_for(exec, size.height, 64, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      run.find_below(floor, y, size.width, disparity.disparity_px.row(y), below.disparity_px.row(y),
                     little_below.disparity_px.row(y));
    }
  });
  // What neither rule keeps is a mirror image or a wrong match; the rest is a surface beyond the floor's edge.
  const DisparityMap smooth = reject_speckles(std::move(below), all_but_surfaces(size, kWidestStep), exec);
  const DisparityMap level =
      reject_speckles(std::move(little_below), all_but_surfaces(size, kWidestLevelStep), exec);
  parallel_for(exec, size.height, 64, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      run.reject_marked(smooth.reject.row(y), level.disparity_px.row(y), size.width,
                        disparity.disparity_px.row(y), disparity.reject.row(y));
    }
  });
  return disparity;
}

Image<float> floor_under_reflections(const DisparityMap& disparity, const Ground& ground, const Exec& exec) {
  Image<float> surface_disparity_px = disparity.disparity_px.clone(exec.pool);
  if (!ground.plane) return surface_disparity_px;
  parallel_for(exec, surface_disparity_px.height(), 64, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      const Reject* const reject = disparity.reject.row(y);
      float* const seen = surface_disparity_px.row(y);
      for (int x = 0; x < surface_disparity_px.width(); ++x) {
        if (!has(reject[x], Reject::below_ground)) continue;
        const float floor_px = ground.plane->disparity_px(static_cast<float>(x), static_cast<float>(y));
        seen[x] = std::clamp(floor_px, -kMaxDisparity, kMaxDisparity);
      }
    }
  });
  return surface_disparity_px;
}

Image<std::uint8_t> label_floor(const DisparityMap& disparity, const Ground& ground,
                                const std::optional<StereoRig>& rig, const GroundConfig& config,
                                const Exec& exec) {
  if (!ground.plane || !config.label_floor) return {};
  const Size size = disparity.disparity_px.size();
  const kernels::FloorKernels& run = kernels::floor_kernels(exec);
  const kernels::FloorRow floor = floor_row(ground, rig, config);
  Image<std::uint8_t> label(size, exec.pool);
  parallel_for(exec, size.height, 64, [&](int first, int last) {
    for (int y = first; y < last; ++y)
      run.label_floor(floor, y, size.width, disparity.disparity_px.row(y), label.row(y));
  });
  return label;
}

}  // namespace cairn
