// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// The paper's method: one call per stage, in the order of the data.
#include <cairn/core/future.hpp>
#include <cairn/objects/locate.hpp>
#include <cairn/pipeline/methods.hpp>
#include <cairn/stereo/confidence.hpp>
#include <utility>

namespace cairn {

StereoMatch stereo_by_paper(FrameInput& in, const Run& run, StageClock& stage) {
  const auto& [rig, config, exec] = run;
  StereoMatch found = match_and_check(in, run, stage);
  auto& [disparity, ground, floor, epipolar, confidence] = found.stereo;

  // A check against the scene: matches below the floor are reflections.
  ground = stage("fit_ground", fit_ground(disparity, rig, config.ground, exec));
  disparity = stage("reject_below_ground",
                    reject_below_ground(std::move(disparity), ground, rig, config.ground, exec));
  disparity = stage("reject_speckles", reject_speckles(std::move(disparity), config.speckle, exec));
  return found;
}

Frame segment_by_paper(FrameInput in, const Run& run) {
  const auto& [rig, config, exec] = run;
  StageClock stage(exec);
  StereoMatch match = stereo_by_paper(in, run, stage);
  Frame frame{std::move(match.stereo)};
  frame.floor = stage("label_floor", label_floor(frame.disparity, frame.ground, rig, config.ground, exec));

  // Growing by disparity uses one thread; the left image is segmented at the same time.
  Future<Segmentation> by_intensity(exec, [&](const Exec& concurrent) {
    return segment_intensity(in.left.gray, run.config.intensity, concurrent);
  });

  // (The memory pool of the left image's regions may still be in use.)
  Future<Image<float>> confidence(exec.beside(), [&](const Exec& concurrent) {
    return estimate_confidence(match.matches, frame.disparity, confidence_model(run.config.match.method),
                               concurrent);
  });

  // Fusion of the two segmentations.
  frame.by_disparity =
      stage("segment_disparity", segment_disparity(frame.disparity, frame.floor, config.disparity, exec));
  frame.by_intensity = stage("segment_intensity", by_intensity.get());
  frame.fusion = stage("fuse", fuse(frame.by_intensity, frame.by_disparity, exec));

  // The fused regions that are objects, with positions.
  frame.objects = stage("measure", measure(frame.fusion.labels, frame.fusion.is_floor, frame.disparity,
                                           in.left, config.objects, exec));
  frame.objects = stage("locate", locate(std::move(frame.objects), frame.disparity, frame.ground, rig, exec));
  frame.confidence = stage("estimate_confidence", confidence.get());

  // Other obstacles.
  const Background none;
  const ObstacleCues seen{frame.disparity,     {}, frame.confidence, frame.ground, none, {},
                          frame.objects.labels};
  const std::int64_t min_area = limits_of(config.objects, in.left.gray.size()).min_area;
  frame.space = stage("label_obstacles", label_obstacles(seen, rig, config.ground, exec));
  frame.left_out =
      stage("rejected_obstacles", rejected_obstacles(frame.space, seen, {}, rig, {min_area, 1}, exec));
  return frame;
}

}  // namespace cairn
