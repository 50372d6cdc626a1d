// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// The paper's method: one call per stage, in the order of the data.
#include <cairn/core/later.hpp>
#include <cairn/objects/locate.hpp>
#include <cairn/pipeline/methods.hpp>
#include <cairn/stereo/confidence.hpp>
#include <utility>

namespace cairn {

Frame segment_by_overlap(Given given, const std::optional<StereoRig>& rig, const Config& config,
                         const Exec& exec) {
  Observed stage(exec);
  Frame frame;

  // Disparities, and the checks of single pixels and of the whole map.
  MatchedScene scene = match_scene(given, rig, config, exec, stage);
  frame.epipolar = scene.found.epipolar;
  frame.ground = scene.found.ground;
  frame.disparity = std::move(scene.found.disparity);
  frame.floor = std::move(scene.found.floor);

  // Growing by disparity uses one thread; the left image is segmented at the same time.
  Later<Segmentation> by_intensity(exec, [&](const Exec& concurrent) {
    return segment_intensity(given.left, config.intensity, concurrent);
  });

  // (The memory pool of the left image's regions may still be in use.)
  Later<Image<float>> confidence(exec.beside(), [&](const Exec& concurrent) {
    return estimate_confidence(scene.matches, frame.disparity, confidence_model(config.match.method),
                               concurrent);
  });

  // Fusion of the two segmentations.
  frame.by_disparity =
      stage("segment_disparity", segment_disparity(frame.disparity, frame.floor, config.disparity, exec));
  frame.by_intensity = stage("segment_intensity", by_intensity.get());
  frame.fusion = stage("fuse", fuse(frame.by_intensity, frame.by_disparity, exec));

  // The fused regions that are objects, with positions.
  frame.objects =
      stage("measure", measure(frame.fusion.labels, frame.fusion.is_floor, frame.disparity, given.left,
                               given.left_rgb, scene.noise_sigma, config.objects, exec));
  frame.objects = stage("locate", locate(std::move(frame.objects), frame.disparity, frame.ground, rig, exec));
  frame.confidence = stage("estimate_confidence", confidence.get());

  // Other obstacles.
  const Background none;
  const SpaceCues seen{frame.disparity, {}, frame.confidence, frame.ground, none, {}, frame.objects.labels};
  frame.space = stage("label_space", label_space(seen, rig, config.ground, exec));
  frame.left_out =
      stage("left_out_of", left_out_of(frame.space, seen, {}, rig,
                                       {limits_of(config.objects, given.left.size()).min_area, 1}, exec));
  return frame;
}

}  // namespace cairn
