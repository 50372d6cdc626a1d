// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/stage_clock.hpp>
#include <cairn/pipeline/segment.hpp>
#include <cairn/regions/object_hints.hpp>
#include <functional>

/// The methods, one source file each; segment() selects. Private to the library.
namespace cairn {

/// The stereo result, and what later stages need of its making.
struct StereoMatch {
  StereoResult stereo;         // up to the checks: without floor and confidence
  Matches matches{};           // empty for external disparities
  Image<Gray> right{};         // as correct_epipolar() moved it; empty where nothing was corrected
  Image<float> textured_px{};  // select_textured(), with pipeline.method=region_tree
};
/// The beginning of both methods, match_and_check.cpp: disparities after the checks of single pixels. Sets the
/// noise of `in`, and its right image to the corrected one; moves its external disparities.
StereoMatch match_and_check(FrameInput& in, const Run& run, StageClock& stage);

/// pipeline.method=paper, paper.cpp: image and disparities are segmented separately, and united where they
/// overlap.
Frame segment_by_paper(FrameInput in, const Run& run);
/// Its first half.
StereoMatch stereo_by_paper(FrameInput& in, const Run& run, StageClock& stage);

/// All regions that may be objects, and the data from which they were grown.
struct RegionCandidates {
  StereoMatch match;
  Image<float> surface_disparity_px{};  // floor_under_reflections()
  Background background{};
  Superpixels superpixels{};
  Image<ObjectHint> hints{};
  MergeTree tree{};
  [[nodiscard]] Cues cues(const LeftImage& left) const {
    return {left, surface_disparity_px, match.textured_px, match.stereo.ground, background, hints};
  }
};
/// Chooses the objects. May move match.matches away, which no later stage needs.
using ObjectChoice = std::function<ChosenObjects(RegionCandidates& candidates, const ChoiceLimits& limits)>;

/// pipeline.method=region_tree, region_tree.cpp: superpixels are merged by all cues into a tree of regions, of
/// which `choose` chooses the objects: by default, those most likely to be whole ones.
Frame segment_by_region_tree(FrameInput in, const Run& run, const ObjectChoice& choose = {});
/// Its two parts: no earlier frame influences the first one.
RegionCandidates grow_candidates(FrameInput& in, const Run& run);
Frame frame_of_candidates(const FrameInput& in, RegionCandidates found, const Run& run,
                          const ObjectChoice& choose);
/// The beginning of the first part …
StereoMatch stereo_by_region_tree(FrameInput& in, const Run& run, StageClock& stage);
/// … and the candidates up to the superpixels; fitting brings its own `network`.
RegionCandidates superpixel_candidates(FrameInput& in, const Run& run, const HintNetwork& network,
                                       StageClock& stage);

}  // namespace cairn
