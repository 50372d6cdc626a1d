// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// The method by evidence, one call a stage, in the order in which data flows.
#include <cairn/core/later.hpp>
#include <cairn/disparity/confidence.hpp>
#include <cairn/image/noise.hpp>
#include <cairn/pipeline/methods.hpp>
#include <utility>

namespace cairn {

Frame segment_by_evidence(Given given, const std::optional<StereoRig>& rig, const Config& config,
                          const Exec& exec) {
  Observed stage(exec);
  Frame frame;

  // What the left image tells without a disparity. Its superpixels are needed soon after the matching, which
  // they are made beside.
  const float noise = stage("noise_sigma", noise_sigma(given.left, exec));
  Later<Facets> superpixels(exec, [&](const Exec& beside) {
    return segment_facets(given.left, given.left_rgb, noise, config.facets, beside);
  });

  // Disparities, and what speaks against them pixel by pixel; those that texture vouches for.
  Matched matched = match_and_check(given, config, exec, stage);
  frame.epipolar = matched.epipolar;
  const Image<float> evidence_px =
      stage("find_evidence", find_evidence(given.left, matched.disparity, noise, config.evidence, exec));

  // The scene: its ground, what is reflected in it, its walls.
  frame.ground = stage("fit_ground", fit_ground(evidence_px, rig, config.ground, exec));
  frame.disparity = stage("reject_below_ground", reject_below_ground(std::move(matched.disparity),
                                                                     frame.ground, rig, config.ground, exec));
  const Background background =
      stage("fit_background", fit_background(evidence_px, frame.ground, rig, config.background, exec));

  // Which superpixels stand before the background, and which of those belong together. Small islands of
  // disparity still count here: thin legs and leaves are islands, too.
  const Facets facets = stage("segment_facets", superpixels.get());
  frame.superpixels = stage("as_segmentation", as_segmentation(facets, given.left, exec));
  const auto figure =
      stage("separate_figure", separate_figure(facets, given.left, given.left_rgb, evidence_px, background,
                                               noise, config.figure, exec));
  frame.groups = stage("group_facets", group_facets(facets, figure, frame.disparity, evidence_px, background,
                                                    rig, config.figure, config.group, exec));

  frame.disparity =
      stage("reject_speckles", reject_speckles(std::move(frame.disparity), config.speckle, exec));
  frame.floor = stage("label_floor", label_floor(frame.disparity, frame.ground, rig, config.ground, exec));
  Later<Image<float>> confidence(exec, [&](const Exec& beside) {
    return estimate_confidence(matched.matches, frame.disparity, confidence_model(config.match.method),
                               beside);
  });

  // Which of the groups are objects, and where.
  frame.objects = stage("measure", measure(frame.groups.labels, background_of(frame.groups), frame.disparity,
                                           given.left, given.left_rgb, noise, rig, config.objects, exec));
  frame.confidence = stage("estimate_confidence", confidence.get());
  return frame;
}

}  // namespace cairn
