// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/pipeline/matched_scene.hpp>
#include <cairn/regions/object_hints.hpp>

/// The methods, one source file each; segment() selects. Private to the library.
namespace cairn {

/// fusion.method=overlap, paper.cpp: image and disparities are segmented separately, and united where they
/// overlap.
Frame segment_by_overlap(Given given, const std::optional<StereoRig>& rig, const Config& config,
                         const Exec& exec);

/// The input of the merge tree.
struct SuperpixelScene {
  MatchedScene scene;
  Image<float> seen_px;  // floor_under_reflections()
  Background background;
  Superpixels superpixels;
  Image<ObjectHint> hints;
  [[nodiscard]] Cues cues(const Given& given) const {
    return {given.left,         given.left_rgb, seen_px,           scene.evidence_px,
            scene.found.ground, background,     scene.noise_sigma, hints};
  }
};
/// The first half of segment_by_hierarchy(), and the input of fitting, which supplies its own hints: without
/// a `network` there are none.
SuperpixelScene cut_scene(Given& given, const std::optional<StereoRig>& rig, const Config& config,
                          const HintNetwork* network, const Exec& exec, Observed& stage);

/// Every candidate region, and the data from which they were grown.
struct GrownScene {
  SuperpixelScene cut;
  MergeTree tree;
  Image<float> confidence;  // estimate_confidence()
};
/// segment_by_hierarchy() up to the tree …
GrownScene grow_scene(Given& given, const std::optional<StereoRig>& rig, const Config& config,
                      const Exec& exec, Observed& stage);
/// … and from the choice of regions on, which may use several frames.
Frame frame_of(GrownScene grown, const ChosenObjects& chosen, const Given& given,
               const std::optional<StereoRig>& rig, const Config& config, const Exec& exec, Observed& stage);

/// fusion.method=hierarchy, hierarchy.cpp: superpixels are merged by all cues into a tree of regions, of
/// which those most likely to be whole objects are chosen.
Frame segment_by_hierarchy(Given given, const std::optional<StereoRig>& rig, const Config& config,
                           const Exec& exec);

}  // namespace cairn
