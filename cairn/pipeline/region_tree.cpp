// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// The method with pipeline.method=region_tree: one call per stage, in the order of the data.
#include <cairn/core/future.hpp>
#include <cairn/objects/floor_probability.hpp>
#include <cairn/objects/locate.hpp>
#include <cairn/objects/refine_objects.hpp>
#include <cairn/objects/sky.hpp>
#include <cairn/pipeline/methods.hpp>
#include <cairn/stereo/confidence.hpp>
#include <utility>

namespace cairn {

StereoMatch stereo_by_region_tree(FrameInput& in, const Run& run, StageClock& stage) {
  const auto& [rig, config, exec] = run;
  StereoMatch found = match_and_check(in, run, stage);
  auto& [disparity, ground, floor, epipolar, confidence] = found.stereo;

  // Textured disparities show the ground, and the ground which matches are reflections in it.
  found.textured_px = stage("select_textured", select_textured(in.left, disparity, config.textured, exec));
  ground = stage("fit_ground", fit_ground(found.textured_px, rig, config.ground, exec, in.left.gray));
  ground = stage("likely_ground",
                 likely_ground(ground, disparity, rig, config.ground, exec, found.textured_px, in.left.gray));
  disparity = stage("reject_below_ground",
                    reject_below_ground(std::move(disparity), ground, rig, config.ground, exec));
  disparity = stage("reject_speckles", reject_speckles(std::move(disparity), config.speckle, exec));
  return found;
}

RegionCandidates superpixel_candidates(FrameInput& in, const Run& run, const HintNetwork& network,
                                       StageClock& stage) {
  const auto& [rig, config, exec] = run;
  RegionCandidates found{stereo_by_region_tree(in, run, stage)};
  const StereoResult& stereo = found.match.stereo;

  // The background: walls, and the floor, also where it is reflective.
  found.background = stage(
      "fit_background", fit_background(found.match.textured_px, stereo.ground, rig, config.background, exec));
  found.surface_disparity_px =
      stage("floor_under_reflections", floor_under_reflections(stereo.disparity, stereo.ground, exec));

  // The hints of the network, and superpixels along the outlines that it expects.
  Image<std::uint16_t> edges = stage("superpixel_edges", superpixel_edges(in.left, exec));
  found.hints =
      stage("hint_objects", hint_objects(hint_input(edges, found.cues(in.left), exec), network, exec));
  found.superpixels =
      stage("cut_superpixels", cut_superpixels(std::move(edges), found.hints, found.surface_disparity_px,
                                               in.left.noise_sigma, config.superpixels, exec));
  return found;
}

Frame segment_by_region_tree(FrameInput in, const Run& run, const ObjectChoice& choose) {
  RegionCandidates found = grow_candidates(in, run);
  return frame_of_candidates(in, std::move(found), run, choose);
}

RegionCandidates grow_candidates(FrameInput& in, const Run& run) {
  const Exec& exec = run.exec;
  StageClock stage(exec);
  RegionCandidates found = superpixel_candidates(in, run, hint_network(), stage);

  // The tree of merged regions, and concurrently the confidence of the disparities.
  Future<Image<float>> confidence(exec, [&](const Exec& concurrent) {
    return estimate_confidence(found.match.matches, found.match.stereo.disparity,
                               confidence_model(run.config.match.method), concurrent);
  });
  found.tree = stage("grow_merge_tree",
                     grow_merge_tree(found.superpixels, found.cues(in.left), merge_classifier(), exec));
  found.match.stereo.confidence = stage("estimate_confidence", confidence.get());
  return found;
}

Frame frame_of_candidates(const FrameInput& in, RegionCandidates found, const Run& run,
                          const ObjectChoice& choose) {
  const auto& [rig, config, exec] = run;
  const auto& [match, surface_disparity_px, background, superpixels, hints, tree] = found;
  StageClock stage(exec);

  // The chosen regions as objects, with positions.
  const ChoiceLimits limits = limits_of(config.objects, in.left.gray.size());
  const ChosenObjects chosen =
      stage("choose_objects",
            choose ? choose(found, limits) : choose_objects(tree, object_classifier(), limits, exec));
  RefinedDisparity refined;  // fitted to errors of matching, so not for given disparities
  if (!match.stereo.confidence.empty()) {
    const Cues cues = found.cues(in.left);
    const RefinementCues all{superpixels, tree, chosen, cues, match.stereo.confidence};
    refined = stage("refine_disparity", refine_disparity(all, plane_classifier(), exec));
  }
  Frame frame{std::move(found.match.stereo)};
  frame.superpixels = stage("superpixels", superpixel_regions(superpixels, in.left.gray, exec));
  frame.groups = stage("groups", object_regions(superpixels, chosen, frame.disparity, exec));
  frame.objects =
      stage("measure", measure(frame.groups.labels, chosen.scores, frame.disparity, in.left, exec));
  frame.objects =
      stage("refine_objects", refine_objects(std::move(frame.objects), frame.disparity, in.left.gray,
                                             in.right, disparity_bias_trees(), exec));
  frame.objects = stage("locate", locate(std::move(frame.objects), frame.disparity, frame.ground, rig, exec));

  // The sky, other obstacles, and free floor.
  const SkyCues of_sky{in.left.gray, frame.confidence, frame.ground, superpixels.labels,
                       frame.objects.labels};
  frame.disparity = stage("reject_sky", reject_sky(std::move(frame.disparity), of_sky, rig, exec));
  frame.confidence = without_holes(std::move(frame.confidence), frame.disparity.reject);
  if (!refined.disparity_px.empty()) frame.refined = without_sky(std::move(refined), frame.disparity.reject);
  ObstacleCues seen{frame.disparity,
                    surface_disparity_px,
                    frame.confidence,
                    frame.ground,
                    background,
                    superpixels.labels,
                    frame.objects.labels,
                    frame.refined.disparity_px,
                    frame.refined.confidence};
  Image<float> likely_floor;
  if (!seen.refined_px.empty()) {
    const FloorGroups groups = group_by_floor(seen, hints, rig, config.ground, exec);
    likely_floor =
        stage("floor_probability", floor_probability(groups, superpixels.labels, floor_classifier(), exec));
  }
  seen.floor_probability = likely_floor;
  frame.space = stage("label_obstacles", label_obstacles(seen, rig, config.ground, exec));
  const float wall_px = wall_tolerance_px(config.background, in.left.gray.size());
  frame.left_out = stage("rejected_obstacles", rejected_obstacles(frame.space, seen, chosen.likeliest, rig,
                                                                  {limits.min_area, wall_px}, exec));
  if (frame.ground.plane) frame.floor = floor_of(frame.space, exec);
  return frame;
}

}  // namespace cairn
