// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
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
inline constexpr float kNearPlane = 1.5F;       // px; of the pixels of a plane
inline constexpr float kOnPlane = 1;            // px; as near as the truth is asked for
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

/// Sums over a run of pixels in one row, in disparity steps and columns; holes add nothing.
struct RunMoments {
  std::int64_t n = 0, x = 0, xx = 0, d = 0, xd = 0, dd = 0;
};
/// As Heights. 32 bits: twice as many per vector as with 64.
struct RunHeights {
  static constexpr int kMax = 512;  // pixels, so that no sum overflows
  std::int32_t n = 0, sum = 0, squares = 0, behind = 0, on = 0;
};

/// The groups that the planes of a superpixel divide its pixels into, see refine_disparity().
enum PixelGroup : std::uint8_t { on_main, on_second, nearer, farther, holes };
inline constexpr std::size_t kPixelGroups = 5;
/// Planes of disparity for the pixels of a superpixel; NaN where there is none.
struct SuperpixelPlanes {
  GroundPlane main, second;
  std::array<GroundPlane, kPixelGroups> chosen;  // of each group
};

/// Plain loops that compilers vectorise. Floating-point operations are rounded in the written order, so every
/// target gets the same bits.
struct CueKernels {
  /// The disparity of the nearest of `planes` in row y, limited to 0 … kMaxDisparity.
  void (*nearest_plane)(std::span<const GroundPlane> planes, int y, int width, float* out);
  /// In 1/64 px, rounded, halves up; kNoDisparity where a value is NaN or not above `above`.
  void (*in_steps)(const float* disparity_px, float above, int width, std::int32_t* out);
  /// Of `count` disparities, the first one in column x.
  void (*sum_moments)(const std::int32_t* steps, int x, int count, RunMoments& sums);
  /// Of the clamped heights of `count` ≤ RunHeights::kMax disparities above the surface behind them, and of those that are
  /// textured.
  void (*sum_heights)(const std::int32_t* steps, const std::int32_t* textured, const std::int32_t* behind,
                      int count, RunHeights& all, RunHeights& of_textured);
  /// The disparity and the group of each pixel in columns first … last − 1 of row y, as refine_disparity() defines them;
  /// disparities are limited to least … most.
  void (*take_planes)(const float* disparity_px, int y, int first, int last, const SuperpixelPlanes& planes,
                      float least, float most, float* refined_px, std::int32_t* group);
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
