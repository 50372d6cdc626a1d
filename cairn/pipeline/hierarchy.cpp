// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// The method with fusion.method=hierarchy: one call per stage, in the order of the data.
#include <cairn/core/later.hpp>
#include <cairn/objects/locate.hpp>
#include <cairn/objects/refine_objects.hpp>
#include <cairn/pipeline/methods.hpp>
#include <cairn/stereo/confidence.hpp>
#include <cmath>
#include <utility>

namespace cairn {

ChoiceLimits limits_of(const ObjectsConfig& config, Size image) {
  // Rounded up, so that an area of exactly min_area per cent suffices.
  const double least = std::ceil(static_cast<double>(image.area()) * double{config.min_area} / 100);
  return {config.min_confidence, static_cast<std::int64_t>(least)};
}

SuperpixelScene cut_scene(Given& given, const std::optional<StereoRig>& rig, const Config& config,
                          const HintNetwork* network, const Exec& exec, Observed& stage) {
  SuperpixelScene cut;

  // Disparities with their reasons for rejection, and the textured ones among them.
  cut.scene = match_scene(given, rig, config, exec, stage);
  const MatchedScene& scene = cut.scene;
  const SceneDisparity& found = scene.found;

  // The background: walls, and the floor, also where it is reflective.
  cut.background =
      stage("fit_background", fit_background(scene.evidence_px, found.ground, rig, config.background, exec));
  cut.seen_px =
      stage("floor_under_reflections", floor_under_reflections(found.disparity, found.ground, exec));

  // Superpixels, and concurrently the hints of the network; both need the edges of the image.
  const Image<std::uint16_t> edges =
      stage("superpixel_edges", superpixel_edges(given.left, given.left_rgb, exec));
  Later<Superpixels> superpixels(exec, [&](const Exec& concurrent) {
    return cut_superpixels(edges.clone(concurrent.pool), cut.seen_px, scene.noise_sigma, config.superpixels,
                           concurrent);
  });
  if (network)
    cut.hints = stage("hint_objects", hint_objects(hint_input(edges, cut.cues(given), exec), *network, exec));
  cut.superpixels = stage("cut_superpixels", superpixels.get());
  return cut;
}

GrownScene grow_scene(Given& given, const std::optional<StereoRig>& rig, const Config& config,
                      const Exec& exec, Observed& stage) {
  GrownScene grown{cut_scene(given, rig, config, &hint_network(), exec, stage), {}, {}};
  const SuperpixelScene& cut = grown.cut;
  Later<Image<float>> confidence(exec, [&](const Exec& concurrent) {
    return estimate_confidence(cut.scene.matches, cut.scene.found.disparity,
                               confidence_model(config.match.method), concurrent);
  });

  // The tree of merged regions.
  grown.tree =
      stage("grow_merge_tree", grow_merge_tree(cut.superpixels, cut.cues(given), same_thing_trees(), exec));
  grown.confidence = stage("estimate_confidence", confidence.get());
  return grown;
}

Frame frame_of(GrownScene grown, const ChosenObjects& chosen, const Given& given,
               const std::optional<StereoRig>& rig, const Config& config, const Exec& exec, Observed& stage) {
  SuperpixelScene& cut = grown.cut;
  SceneDisparity& found = cut.scene.found;
  const Superpixels& superpixels = cut.superpixels;

  // The chosen regions as objects, with positions.
  Frame frame;
  frame.confidence = std::move(grown.confidence);
  frame.superpixels = stage("superpixels", segmentation_of(superpixels, given.left, exec));
  frame.groups = stage("groups", groups_of(superpixels, chosen, found.disparity, exec));
  frame.objects = stage("measure", measure(frame.groups.labels, chosen.scores, found.disparity, given.left,
                                           given.left_rgb, cut.scene.noise_sigma, exec));
  frame.objects =
      stage("refine_objects", refine_objects(std::move(frame.objects), found.disparity, given.left,
                                             cut.scene.right_of(given), disparity_bias_trees(), exec));
  frame.objects = stage("locate", locate(std::move(frame.objects), found.disparity, found.ground, rig, exec));

  // Other obstacles, and free floor.
  const SpaceCues seen{found.disparity, cut.seen_px,        frame.confidence,    found.ground,
                       cut.background,  superpixels.labels, frame.objects.labels};
  const std::int64_t min_area = limits_of(config.objects, given.left.size()).min_area;
  frame.space = stage("label_space", label_space(seen, rig, config.ground, exec));
  frame.left_out = stage(
      "left_out_of", left_out_of(frame.space, seen, chosen.likeliest, rig,
                                 {min_area, wall_tolerance_px(config.background, given.left.size())}, exec));
  if (!found.floor.empty()) found.floor = floor_of(frame.space, exec);
  frame.disparity = std::move(found.disparity);
  frame.ground = found.ground;
  frame.floor = std::move(found.floor);
  frame.epipolar = found.epipolar;
  return frame;
}

Frame segment_by_hierarchy(Given given, const std::optional<StereoRig>& rig, const Config& config,
                           const Exec& exec) {
  Observed stage(exec);
  GrownScene grown = grow_scene(given, rig, config, exec, stage);
  const ChosenObjects chosen = stage(
      "choose_objects",
      choose_objects(grown.tree, whole_object_trees(), limits_of(config.objects, given.left.size()), exec));
  return frame_of(std::move(grown), chosen, given, rig, config, exec, stage);
}

}  // namespace cairn
