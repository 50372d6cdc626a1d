// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/core/error.hpp>
#include <cairn/core/observed.hpp>
#include <cairn/pipeline/segment.hpp>
#include <utility>

namespace cairn {
namespace {

/// Ground, reflections, speckles: what can be said of the disparities only once they are seen together.
SceneDisparity check_against_scene(DisparityMap disparity, View<const float> ground_evidence_px,
                                   const std::optional<StereoRig>& rig, const Config& config,
                                   const Exec& exec, Observed& stage) {
  Ground ground = stage("fit_ground", fit_ground(ground_evidence_px, rig, config.ground, exec));
  disparity = stage("reject_below_ground",
                    reject_below_ground(std::move(disparity), ground, rig, config.ground, exec));
  disparity = stage("reject_speckles", reject_speckles(std::move(disparity), config.speckle, exec));
  auto floor = stage("label_floor", label_floor(disparity, ground, rig, config.ground, exec));
  return {std::move(disparity), ground, std::move(floor)};
}

DisparityMap match_and_check(const StereoPair& pair, const Config& config, const Exec& exec,
                             Observed& stage) {
  const Matches matches = stage("match", match(pair, config.match, config.semi_global, exec));
  auto refined = stage("refine_subpixel", refine_subpixel(matches, config.subpixel, exec));

  const auto inconsistent =
      stage("reject_inconsistent", reject_inconsistent(matches, config.left_right, exec));
  const auto ambiguous = stage("reject_ambiguous", reject_ambiguous(matches, config.uniqueness, exec));
  const auto flat = stage("reject_flat", reject_flat(matches, config.flatness, exec));
  const auto textureless = stage("reject_textureless", reject_textureless(pair.left(), config.texture, exec));
  return stage("combine", combine(std::move(refined), {inconsistent, ambiguous, flat, textureless}, exec));
}

/// The disparities that ground and background are found from: with fusion.method=evidence those that texture
/// vouches for.
Image<float> trusted(View<const Gray> left, const DisparityMap& disparity, const Config& config,
                     const Exec& exec, Observed& stage) {
  if (config.fusion.method == FusionMethod::overlap) return disparity.disparity_px.clone(exec.pool);
  return stage("find_evidence", find_evidence(left, disparity, config.evidence, exec));
}

/// The paper's way: two segmentations, united where they overlap.
void unite_by_overlap(View<const Gray> left, Frame& frame, const Config& config, const Exec& exec,
                      Observed& stage) {
  frame.by_intensity = stage("segment_intensity", segment_intensity(left, config.intensity, exec));
  frame.by_disparity =
      stage("segment_disparity", segment_disparity(frame.disparity, frame.floor, config.disparity, exec));
}

/// What texture proves decides which facets stand before the background, and which of those belong together.
void unite_by_evidence(View<const Gray> left, View<const Rgb> left_rgb, View<const float> evidence_px,
                       const std::optional<StereoRig>& rig, Frame& frame, const Config& config,
                       const Exec& exec, Observed& stage) {
  const Background background = fit_background(evidence_px, frame.ground, rig, config.background, exec);
  const Facets facets = segment_facets(left, left_rgb, config.facets, exec);
  frame.by_intensity = stage("segment_facets", as_segmentation(facets, left, exec));
  const auto figure = separate_figure(facets, left, left_rgb, evidence_px, background, config.figure, exec);
  frame.by_disparity = stage("group_facets", group_facets(facets, figure, frame.disparity, evidence_px,
                                                          background, config.figure, config.group, exec));
}

/// From disparities that the per-pixel checks have passed to objects.
Frame find_objects(View<const Gray> left, View<const Rgb> left_rgb, DisparityMap disparity,
                   const std::optional<StereoRig>& rig, const Config& config, const Exec& exec,
                   Observed& stage) {
  const bool by_evidence = config.fusion.method == FusionMethod::evidence;
  const Image<float> evidence_px = trusted(left, disparity, config, exec, stage);
  auto scene = check_against_scene(std::move(disparity), evidence_px, rig, config, exec, stage);
  Frame frame{std::move(scene.disparity), scene.ground, std::move(scene.floor), {}, {}, {}, {}};
  if (by_evidence) {
    unite_by_evidence(left, left_rgb, evidence_px, rig, frame, config, exec, stage);
  } else {
    unite_by_overlap(left, frame, config, exec, stage);
  }
  frame.fusion = stage("fuse", fuse(frame.by_intensity, frame.by_disparity, exec));
  frame.objects = stage("measure", measure(frame.fusion, frame.by_disparity, frame.disparity, left, left_rgb,
                                           rig, config.objects, exec));
  return frame;
}

}  // namespace

SceneDisparity estimate_disparity(const StereoPair& pair, const std::optional<StereoRig>& rig,
                                  const Config& config, const Exec& exec) {
  validate(config, pair.size(), rig.has_value());
  Observed stage(exec);
  DisparityMap disparity = match_and_check(pair, config, exec, stage);
  const Image<float> trusted_px = trusted(pair.left(), disparity, config, exec, stage);
  return check_against_scene(std::move(disparity), trusted_px, rig, config, exec, stage);
}

Frame segment(const StereoPair& pair, const std::optional<StereoRig>& rig, const Config& config,
              const Exec& exec) {
  validate(config, pair.size(), rig.has_value());
  Observed stage(exec);
  return find_objects(pair.left(), pair.left_rgb(), match_and_check(pair, config, exec, stage), rig, config,
                      exec, stage);
}

Frame segment(View<const Gray> left, View<const Rgb> left_rgb, DisparityMap disparity,
              const std::optional<StereoRig>& rig, const Config& config, const Exec& exec) {
  if (left.size() != disparity.disparity_px.size()) {
    throw Error("external disparity: the map is " + text(disparity.disparity_px.size()) +
                ", the left image " + text(left.size()));
  }
  validate(config);
  Observed stage(exec);
  return find_objects(left, left_rgb, std::move(disparity), rig, config, exec, stage);
}

}  // namespace cairn
