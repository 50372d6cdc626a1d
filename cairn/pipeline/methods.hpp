// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/pipeline/match_and_check.hpp>
#include <cairn/pipeline/segment.hpp>

/// The methods, a page each; segment() chooses. Private to the library.
namespace cairn {

/// fusion.method=overlap, paper.cpp: the picture and its disparities are segmented apart, and united where
/// they overlap.
Frame segment_by_overlap(Given given, const std::optional<StereoRig>& rig, const Config& config,
                         const Exec& exec);

/// fusion.method=hierarchy, hierarchy.cpp: superpixels fuse by every cue to a tree of regions, of which those
/// that are likeliest whole objects are chosen.
Frame segment_by_hierarchy(Given given, const std::optional<StereoRig>& rig, const Config& config,
                           const Exec& exec);

}  // namespace cairn
