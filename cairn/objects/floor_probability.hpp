// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cairn/objects/obstacles.hpp>
#include <cairn/regions/fitted_trees.hpp>
#include <cstdint>
#include <string_view>
#include <vector>

/// How likely the floor is what pixels show. (docs/stages/obstacles.md, beyond the paper)
namespace cairn {

struct ObjectHint;  // cairn/regions/object_hints.hpp

/// What the disparity of a pixel says, by ObstacleCues: its refined one if that is likely, else the matched one.
/// not_judged: pixels of objects and of the sky, and those above the horizon or where a wall hides the floor.
enum class FloorKind : std::uint8_t { hole, on_floor, in_front, behind, not_judged };
inline constexpr std::size_t kFloorKinds = 5;

inline constexpr std::size_t kFloorFeatures = 18;
using FloorFeatures = std::array<float, kFloorFeatures>;
std::array<std::string_view, kFloorFeatures> floor_feature_names();

/// The pixels of one kind in one superpixel are a group, number kFloorKinds · superpixel + kind.
struct FloorGroups {
  Image<FloorKind> kinds;
  /// Of each group, its pixels; only every second one is looked at, as on a chequerboard.
  std::vector<std::int64_t> pixels;
  std::vector<FloorFeatures> features;  // of each group that has pixels and is judged
  [[nodiscard]] static std::size_t group(RegionId superpixel, FloorKind kind) {
    return kFloorKinds * index(superpixel) + static_cast<std::size_t>(kind);
  }
};

/// Divides the pixels into groups and describes each: its disparities, matched and refined, and their distances from
/// the floor; hints, place, and the same of its superpixel. Without a ground no pixel is judged. `hints`:
/// hint_objects(). Preconditions: `cues` has superpixels and refined disparities; all views but `hints` have one size.
FloorGroups group_by_floor(const ObstacleCues& cues, View<const ObjectHint> hints,
                           const std::optional<StereoRig>& rig, const GroundConfig& config, const Exec& exec);

/// 0 … 1 for each pixel: the probability that it shows the floor; NaN where that is not judged, and in groups so small that
/// none of their pixels was looked at. `shows_floor`: floor_classifier(), or fitted.
Image<float> floor_probability(const FloorGroups& groups, View<const RegionId> superpixels,
                               const FittedTrees& shows_floor, const Exec& exec);

/// The log-odds that a group shows the floor, from FloorFeatures. Fitted by ./dev fit.
const FittedTrees& floor_classifier();

}  // namespace cairn
