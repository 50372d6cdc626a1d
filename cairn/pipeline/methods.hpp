// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/grouping/region_cues.hpp>
#include <cairn/pipeline/matched_scene.hpp>

/// The methods, a page each; segment() chooses. Private to the library.
namespace cairn {

/// fusion.method=overlap, paper.cpp: the picture and its disparities are segmented apart, and united where
/// they overlap.
Frame segment_by_overlap(Given given, const std::optional<StereoRig>& rig, const Config& config,
                         const Exec& exec);

/// What the tree of regions is grown from.
struct SuperpixelScene {
  MatchedScene scene;
  Image<float> seen_px;  // floor_under_reflections()
  Background background;
  Superpixels superpixels;
  [[nodiscard]] Cues cues(const Given& given) const {
    return {given.left,         given.left_rgb, seen_px,          scene.evidence_px,
            scene.found.ground, background,     scene.noise_sigma};
  }
};
/// The first half of segment_by_hierarchy(). What is fitted is fitted to this.
SuperpixelScene cut_scene(Given& given, const std::optional<StereoRig>& rig, const Config& config,
                          const Exec& exec, Observed& stage);

/// Every region that may be an object, and what they were grown from.
struct GrownScene {
  SuperpixelScene cut;
  MergeTree tree;
  Image<float> confidence;  // estimate_confidence()
};
/// segment_by_hierarchy() as far as to the tree …
GrownScene grow_scene(Given& given, const std::optional<StereoRig>& rig, const Config& config,
                      const Exec& exec, Observed& stage);
/// … and from the choice among its regions on, which may know more than one frame shows.
Frame frame_of(GrownScene grown, const ChosenObjects& chosen, const Given& given,
               const std::optional<StereoRig>& rig, const Config& config, const Exec& exec, Observed& stage);

/// fusion.method=hierarchy, hierarchy.cpp: superpixels fuse by every cue to a tree of regions, of which those
/// that are likeliest whole objects are chosen.
Frame segment_by_hierarchy(Given given, const std::optional<StereoRig>& rig, const Config& config,
                           const Exec& exec);

}  // namespace cairn
