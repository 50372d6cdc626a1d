// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// From a pair to disparities: one call per stage.
#include <cairn/image/noise.hpp>
#include <cairn/pipeline/matched_scene.hpp>
#include <utility>

namespace cairn {
namespace {

/// Disparities after the per-pixel checks, and the data that they used.
struct Matched {
  EpipolarOffset epipolar;
  Matches matches;
  Image<Gray> right;  // corrected; empty without correction
  DisparityMap disparity;
};

Matched match_and_check(Given& given, const Config& config, const Exec& exec, Observed& stage) {
  if (given.right.empty()) return {{}, {}, {}, std::move(given.disparity)};
  auto pair = StereoPair::from(given.left, given.right, given.left_rgb);

  EpipolarCorrection aligned;
  if (config.epipolar_correction.max_rows >= 0) {
    aligned = correct_epipolar(pair, config.match, config.epipolar_correction, exec);
    aligned.right = stage("correct_epipolar", std::move(aligned.right));
    if (!aligned.right.empty()) pair = StereoPair::from(given.left, aligned.right, given.left_rgb);
  }
  Matches matches = stage("match", match(pair, config.match, config.semi_global, exec));
  auto refined = stage("refine_subpixel", refine_subpixel(matches, config.subpixel, exec));

  // Independent checks of each match; each sets its own bit.
  const auto inconsistent =
      stage("reject_inconsistent", reject_inconsistent(matches, config.left_right, exec));
  const auto ambiguous = stage("reject_ambiguous", reject_ambiguous(matches, config.uniqueness, exec));
  const auto flat = stage("reject_flat", reject_flat(matches, config.flatness, exec));
  const auto textureless = stage("reject_textureless", reject_textureless(given.left, config.texture, exec));
  DisparityMap disparity =
      stage("combine", combine(std::move(refined), {inconsistent, ambiguous, flat, textureless}, exec));
  return {aligned.offset, std::move(matches), std::move(aligned.right), std::move(disparity)};
}

}  // namespace

MatchedScene match_scene(Given& given, const std::optional<StereoRig>& rig, const Config& config,
                         const Exec& exec, Observed& stage) {
  Matched matched = match_and_check(given, config, exec, stage);
  MatchedScene scene;
  scene.matches = std::move(matched.matches);
  scene.aligned_right = std::move(matched.right);
  scene.noise_sigma = stage("noise_sigma", noise_sigma(given.left, exec));
  if (config.fusion.method == FusionMethod::hierarchy) {
    scene.evidence_px = stage("find_evidence", find_evidence(given.left, matched.disparity, scene.noise_sigma,
                                                             config.evidence, exec));
  }

  // Checks of the map as a whole: ground, reflections in it, speckles.
  SceneDisparity& found = scene.found;
  found.epipolar = matched.epipolar;
  if (config.fusion.method == FusionMethod::hierarchy) {
    found.ground = stage("fit_ground", fit_ground(scene.evidence_px, rig, config.ground, exec, given.left));
    found.ground = stage("likely_ground", likely_ground(found.ground, matched.disparity, rig, config.ground,
                                                        exec, scene.evidence_px, given.left));
  } else {
    found.ground = stage("fit_ground", fit_ground(matched.disparity, rig, config.ground, exec));
  }
  found.disparity = stage("reject_below_ground", reject_below_ground(std::move(matched.disparity),
                                                                     found.ground, rig, config.ground, exec));
  found.disparity =
      stage("reject_speckles", reject_speckles(std::move(found.disparity), config.speckle, exec));
  found.floor = stage("label_floor", label_floor(found.disparity, found.ground, rig, config.ground, exec));
  return scene;
}

}  // namespace cairn
