// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// The paper's method, one call a stage, in the order in which data flows.
#include <cairn/core/later.hpp>
#include <cairn/disparity/confidence.hpp>
#include <cairn/image/noise.hpp>
#include <cairn/pipeline/methods.hpp>
#include <utility>

namespace cairn {

Frame segment_by_overlap(Given given, const std::optional<StereoRig>& rig, const Config& config,
                         const Exec& exec) {
  Observed stage(exec);
  Frame frame;

  // Disparities, and what speaks against them: pixel by pixel …
  Matched matched = match_and_check(given, config, exec, stage);
  frame.epipolar = matched.epipolar;

  // (Matching keeps all threads busy, growing by disparity only one: the left image is segmented beside
  // that.)
  Later<Segmentation> by_intensity(
      exec, [&](const Exec& beside) { return segment_intensity(given.left, config.intensity, beside); });

  // … and once they are seen together: the ground, what is reflected in it, islands.
  frame.ground = stage("fit_ground", fit_ground(matched.disparity, rig, config.ground, exec));
  frame.disparity = stage("reject_below_ground", reject_below_ground(std::move(matched.disparity),
                                                                     frame.ground, rig, config.ground, exec));
  frame.disparity =
      stage("reject_speckles", reject_speckles(std::move(frame.disparity), config.speckle, exec));
  frame.floor = stage("label_floor", label_floor(frame.disparity, frame.ground, rig, config.ground, exec));

  // (The first pool beside may still be that of the left image's regions.)
  Later<Image<float>> confidence(exec.beside(), [&](const Exec& beside) {
    return estimate_confidence(matched.matches, frame.disparity, confidence_model(config.match.method),
                               beside);
  });

  // Two segmentations, united.
  frame.by_disparity =
      stage("segment_disparity", segment_disparity(frame.disparity, frame.floor, config.disparity, exec));
  frame.by_intensity = stage("segment_intensity", by_intensity.get());
  frame.fusion = stage("fuse", fuse(frame.by_intensity, frame.by_disparity, exec));

  // Which of the fused regions are objects, and where.
  const float noise = stage("noise_sigma", noise_sigma(given.left, exec));
  frame.objects = stage("measure", measure(frame.fusion.labels, frame.fusion.is_floor, frame.disparity,
                                           given.left, given.left_rgb, noise, rig, config.objects, exec));
  frame.confidence = stage("estimate_confidence", confidence.get());
  return frame;
}

}  // namespace cairn
