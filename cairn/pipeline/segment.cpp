// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/core/error.hpp>
#include <cairn/disparity/confidence.hpp>
#include <cairn/image/noise.hpp>
#include <cairn/pipeline/methods.hpp>
#include <utility>

namespace cairn {
namespace {

Given given_as(const StereoPair& pair) {
  return {pair.left(), pair.left_rgb(), pair.right(), {}};
}

bool by_hierarchy(const Config& config) {
  return config.fusion.method == FusionMethod::hierarchy;
}

Frame by_the_method(Given given, const std::optional<StereoRig>& rig, const Config& config,
                    const Exec& exec) {
  return by_hierarchy(config) ? segment_by_hierarchy(std::move(given), rig, config, exec)
                              : segment_by_overlap(std::move(given), rig, config, exec);
}

}  // namespace

SceneDisparity estimate_disparity(const StereoPair& pair, const std::optional<StereoRig>& rig,
                                  const Config& config, const Exec& exec) {
  validate(config, pair.size(), rig.has_value());
  Observed stage(exec);
  SceneDisparity scene;
  Given given = given_as(pair);
  Matched matched = match_and_check(given, config, exec, stage);
  scene.epipolar = matched.epipolar;

  Image<float> evidence_px;
  View<const float> trusted_px = matched.disparity.disparity_px;
  if (by_hierarchy(config)) {
    const float noise = stage("noise_sigma", noise_sigma(pair.left(), exec));
    evidence_px =
        stage("find_evidence", find_evidence(pair.left(), matched.disparity, noise, config.evidence, exec));
    trusted_px = evidence_px;
  }
  scene.ground = stage("fit_ground", fit_ground(trusted_px, rig, config.ground, exec));
  scene.disparity = stage("reject_below_ground", reject_below_ground(std::move(matched.disparity),
                                                                     scene.ground, rig, config.ground, exec));
  scene.disparity =
      stage("reject_speckles", reject_speckles(std::move(scene.disparity), config.speckle, exec));
  scene.floor = stage("label_floor", label_floor(scene.disparity, scene.ground, rig, config.ground, exec));
  scene.confidence = stage(
      "estimate_confidence",
      estimate_confidence(matched.matches, scene.disparity, confidence_model(config.match.method), exec));
  return scene;
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
