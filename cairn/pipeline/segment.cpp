// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/core/error.hpp>
#include <cairn/pipeline/methods.hpp>
#include <cairn/stereo/confidence.hpp>
#include <utility>

namespace cairn {
namespace {

Given given_as(const StereoPair& pair) {
  return {pair.left(), pair.left_rgb(), pair.right(), {}};
}

Frame by_the_method(Given given, const std::optional<StereoRig>& rig, const Config& config,
                    const Exec& exec) {
  return config.fusion.method == FusionMethod::hierarchy
             ? segment_by_hierarchy(std::move(given), rig, config, exec)
             : segment_by_overlap(std::move(given), rig, config, exec);
}

}  // namespace

SceneDisparity estimate_disparity(const StereoPair& pair, const std::optional<StereoRig>& rig,
                                  const Config& config, const Exec& exec) {
  validate(config, pair.size(), rig.has_value());
  Observed stage(exec);
  Given given = given_as(pair);
  MatchedScene scene = match_scene(given, rig, config, exec, stage);
  scene.found.confidence = stage(
      "estimate_confidence",
      estimate_confidence(scene.matches, scene.found.disparity, confidence_model(config.match.method), exec));
  return std::move(scene.found);
}

Frame segment(const StereoPair& pair, const std::optional<StereoRig>& rig, const Config& config,
              const Exec& exec) {
  validate(config, pair.size(), rig.has_value());
  return by_the_method(given_as(pair), rig, config, exec);
}

Frame segment(View<const Gray> left, View<const Rgb> left_rgb, DisparityMap disparity,
              const std::optional<StereoRig>& rig, const Config& config, const Exec& exec) {
  if (left.size() != disparity.disparity_px.size()) {
    throw Error("external disparity: the map is " + text(disparity.disparity_px.size()) +
                ", the left image " + text(left.size()));
  }
  validate(config);
  return by_the_method({left, left_rgb, {}, std::move(disparity)}, rig, config, exec);
}

}  // namespace cairn
