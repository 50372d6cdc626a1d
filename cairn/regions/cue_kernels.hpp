// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cairn/regions/fitted_trees.hpp>
#include <cairn/scene/ground_plane.hpp>
#include <cstdint>
#include <limits>
#include <span>

/// The kernels of superpixels and cues, per pixel of a row; one set per instruction set. Private to the
/// library.
namespace cairn::kernels {

inline constexpr std::size_t kTreeLanes = 16;   // samples
inline constexpr std::size_t kDeepestTree = 6;  // splits on a path
inline constexpr std::int32_t kNoDisparity = std::numeric_limits<std::int32_t>::min();

/// Disparities, px, of a row and of its neighbours.
struct StepRows {
  const float* up;
  const float* here;
  const float* down;
};
/// The sum of an edge and a disparity step: `weight` per px, steps of at most `largest` px, 0 below `least`.
struct StepSum {
  float weight;
  float largest;
  int least;
};

/// Plain loops that compilers vectorise. Floating-point operations are rounded in the written order, so every
/// target gets the same bits.
struct CueKernels {
  /// The disparity of the nearest of `planes` in row y, limited to 0 … kMaxDisparity.
  void (*nearest_plane)(std::span<const GroundPlane> planes, int y, int width, float* out);
  /// In 1/64 px, rounded, halves up; kNoDisparity where a value is NaN or not above `above`.
  void (*in_steps)(const float* disparity_px, float above, int width, std::int32_t* out);
  /// Adds to each edge the largest disparity step to one of the four neighbours. A hole has no step.
  void (*add_steps)(const std::uint16_t* edges, const StepRows& rows, int width, const StepSum& by,
                    std::uint16_t* out);
  /// Half a row of half an image: means of 2×2, rounded. Of an odd width the last column counts twice.
  void (*halve)(const std::uint16_t* upper, const std::uint16_t* lower, int width, std::uint16_t* out);
  /// Adds to each of kTreeLanes sums the leaves that its sample reaches in `count` complete trees, stored as in
  /// FittedTrees. `features`: kTreeLanes values of each. Precondition: 1 ≤ depth ≤ kDeepestTree.
  void (*sum_trees)(const FittedTrees::Split* splits, const float* leaves, std::size_t depth,
                    std::size_t count, const float* features, float* sums);
};

/// The functions of this build for `target`, nullptr if it has none. Never nullptr for Target::scalar.
const CueKernels* cue_kernels(Target target);
/// The functions for the active target of `exec`.
const CueKernels& cue_kernels(const Exec& exec);

}  // namespace cairn::kernels
