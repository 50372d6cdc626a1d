// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/core/error.hpp>
#include <cairn/objects/ground_curvature.hpp>
#include <cairn/pipeline/methods.hpp>
#include <cairn/regions/percent.hpp>
#include <cairn/stereo/confidence.hpp>
#include <cmath>
#include <utility>

namespace cairn {

namespace {

/// With other disparities in place of the frame's own.
Image<float> obstacles_at(const DisparityMap& disparity, const Frame& frame) {
  const Background none;
  return obstacle_disparities(frame.space,
                              {disparity,
                               {},
                               frame.confidence,
                               frame.ground,
                               none,
                               {},
                               frame.objects.labels,
                               frame.refined.disparity_px,
                               frame.refined.confidence},
                              {});
}

}  // namespace

Image<float> obstacle_disparities(const Frame& frame) {
  return obstacles_at(frame.disparity, frame);
}

ObstacleScan scan_obstacles(const Frame& frame, const FloorFrame& floor, const StereoRig& rig,
                            const ObstaclesConfig& config) {
  const Image<float> disparity_px = obstacle_disparities(frame);
  return scan_obstacles(frame.space, disparity_px, floor, rig, config);
}

std::vector<GroundStep> find_steps(const Frame& frame, const FloorFrame& floor, const StereoRig& rig,
                                   const ObstaclesConfig& config) {
  return find_steps(frame.objects.labels, frame.disparity.disparity_px, frame.confidence, floor, rig, config);
}

ObstacleGrid map_obstacles(const Frame& frame, const FloorFrame& floor, const StereoRig& rig,
                           const ObstaclesConfig& config) {
  return map_obstacles(frame, find_steps(frame, floor, rig, config), floor, rig, config);
}

ObstacleGrid map_obstacles(const Frame& frame, const std::vector<GroundStep>& steps, const FloorFrame& floor,
                           const StereoRig& rig, const ObstaclesConfig& config) {
  // Where the ground curves away from its plane, it is free, too.
  const DisparityMap flat{
      without_curvature(frame.disparity.disparity_px.clone(), frame.space, frame.ground, rig), {}};
  const Image<float> disparity_px = obstacles_at(flat, frame);
  ObstacleGrid grid = map_obstacles(frame.space, disparity_px, floor, rig, config);
  add_steps(grid, steps);
  return grid;
}

ChoiceLimits limits_of(const ObjectsConfig& config, Size image) {
  return {config.min_confidence, pixels_in(config.min_area, image)};
}

namespace {

void check(const FrameInput& in, const Run& run) {
  const Size size = in.left.gray.size();
  if (run.rig) run.rig->validate();
  if (!in.right.empty()) {
    validate(run.config, size, run.rig.has_value());
  } else if (in.disparity.disparity_px.size() == size) {
    validate(run.config);
  } else {
    throw Error("external disparity: the map is " + text(in.disparity.disparity_px.size()) +
                ", the left image " + text(size));
  }
}

}  // namespace

StereoResult estimate_disparity(const StereoPair& pair, const std::optional<StereoRig>& rig,
                                const Config& config, const Exec& exec) {
  return estimate_disparity(FrameInput::from(pair), {rig, config, exec});
}

StereoResult estimate_disparity(FrameInput in, const Run& run) {
  check(in, run);
  const auto& [rig, config, exec] = run;
  StageClock stage(exec);
  const bool by_paper = config.pipeline.method == Method::paper;
  auto [stereo, matches, right, textured_px] =
      by_paper ? stereo_by_paper(in, run, stage) : stereo_by_region_tree(in, run, stage);
  stereo.floor = stage("label_floor", label_floor(stereo.disparity, stereo.ground, rig, config.ground, exec));
  stereo.confidence =
      stage("estimate_confidence",
            estimate_confidence(matches, stereo.disparity, confidence_model(config.match.method), exec));
  return std::move(stereo);
}

Frame segment(const StereoPair& pair, const std::optional<StereoRig>& rig, const Config& config,
              const Exec& exec) {
  return segment(FrameInput::from(pair), {rig, config, exec});
}

Frame segment(FrameInput in, const Run& run) {
  check(in, run);
  return run.config.pipeline.method == Method::paper ? segment_by_paper(std::move(in), run)
                                                     : segment_by_region_tree(std::move(in), run);
}

}  // namespace cairn
