// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// The method by hierarchy, one call a stage, in the order in which data flows.
#include <cairn/core/later.hpp>
#include <cairn/disparity/confidence.hpp>
#include <cairn/image/noise.hpp>
#include <cairn/pipeline/methods.hpp>
#include <cmath>
#include <utility>

namespace cairn {

ChoiceLimits limits_of(const ObjectsConfig& config, Size image) {
  // Rounded up: an area of min_area per cent is enough.
  const double least = std::ceil(static_cast<double>(image.area()) * double{config.min_area} / 100);
  return {config.min_confidence, static_cast<std::int64_t>(least)};
}

Frame segment_by_hierarchy(Given given, const std::optional<StereoRig>& rig, const Config& config,
                           const Exec& exec) {
  Observed stage(exec);
  Frame frame;

  // Disparities, and what speaks against them pixel by pixel; those that texture vouches for.
  const float noise = stage("noise_sigma", noise_sigma(given.left, exec));
  Matched matched = match_and_check(given, config, exec, stage);
  frame.epipolar = matched.epipolar;
  const Image<float> evidence_px =
      stage("find_evidence", find_evidence(given.left, matched.disparity, noise, config.evidence, exec));

  // The scene: its ground, what is reflected in it, its walls.
  frame.ground = stage("fit_ground", fit_ground(evidence_px, rig, config.ground, exec));
  frame.disparity = stage("reject_below_ground", reject_below_ground(std::move(matched.disparity),
                                                                     frame.ground, rig, config.ground, exec));
  frame.disparity =
      stage("reject_speckles", reject_speckles(std::move(frame.disparity), config.speckle, exec));
  frame.floor = stage("label_floor", label_floor(frame.disparity, frame.ground, rig, config.ground, exec));
  Later<Image<float>> confidence(exec, [&](const Exec& beside) {
    return estimate_confidence(matched.matches, frame.disparity, confidence_model(config.match.method),
                               beside);
  });
  const Ground ground =
      stage("likely_ground", likely_ground(frame.ground, frame.disparity, rig, config.ground, exec));
  const Background background =
      stage("fit_background", fit_background(evidence_px, ground, rig, config.background, exec));

  // The picture in pieces, and all that they may fuse to, by every cue.
  const Superpixels superpixels =
      stage("cut_superpixels", cut_superpixels(given.left, given.left_rgb, frame.disparity.disparity_px,
                                               noise, config.superpixels, exec));
  const Cues cues{given.left, given.left_rgb, frame.disparity.disparity_px, evidence_px, ground,
                  background, noise};
  const MergeTree tree = stage("grow_merge_tree", grow_merge_tree(superpixels, cues, kSameThing, exec));

  // Which of these regions are objects, and where.
  const ChosenObjects chosen = stage(
      "choose_objects", choose_objects(tree, kWholeObject, limits_of(config.objects, given.left.size())));
  frame.superpixels = segmentation_of(superpixels, given.left, exec);
  frame.groups = groups_of(superpixels, chosen, frame.disparity, exec);
  frame.objects = stage("measure", measure(frame.groups.labels, chosen.scores, frame.disparity, given.left,
                                           given.left_rgb, noise, rig, exec));
  frame.confidence = stage("estimate_confidence", confidence.get());
  return frame;
}

}  // namespace cairn
