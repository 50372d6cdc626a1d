// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cairn/core/ids.hpp>
#include <cairn/disparity/reject.hpp>
#include <cairn/scene/ground_plane.hpp>
#include <cstdint>

/// The seam to the instruction sets: how separate_figure() compares facets with each other and with the
/// colours of the picture, and what it and group_facets() do for each pixel of a row. Private to the library.
namespace cairn::kernels {

/// How many more elements than facets the arrays have, and lists of them: whole blocks are tested.
constexpr int kLookSlack = 64;

/// How many more elements than cells their arrays have, of no pixels: pixels_roughly_like() sums so many at
/// once.
constexpr int kCellSlack = 32;

/// Facets, one array per quantity: their boxes, ends excluded, and mean colours.
struct LookArrays {
  const std::int32_t* left;
  const std::int32_t* right;
  const std::int32_t* top;
  const std::int32_t* bottom;
  const float* red;
  const float* green;
  const float* blue;
};

/// What a facet must reach into, and how much its colour may differ.
struct LookWindow {
  std::int32_t left;  // ends included
  std::int32_t right;
  std::int32_t top;
  std::int32_t bottom;
  float red;
  float green;
  float blue;
  float most_squares;  // summed over the channels
};

/// Colours of the picture: their means, and how many pixels of ground and of figure have them.
struct ColourCells {
  const double* red;
  const double* green;
  const double* blue;
  const double* ground;
  const double* figure;
  int count;
};

struct NearPixels {
  double ground = 0;
  double figure = 0;
};

/// What a row shows.
struct ShownRow {
  const Reject* reject;
  const float* disparity_px;
  const float* evidence_px;  // NaN = none
  const float* behind_px;    // the background's disparity
  const std::uint8_t* at_border;
};

/// What group_facets() takes of a pixel.
enum class Taken : std::uint8_t { nothing, border, border_evidence, inner, inner_evidence };

/// Of its value: how far off pixels_roughly_like() is at most.
constexpr double kRoughness = 1e-8;

/// Plain loops that compilers make vector code of; compiled once for each instruction set. None of them
/// rounds in another order than it is written in, so that each gives the same bits.
struct LookKernels {
  /// Those of the facets first … last − 1 that are within the window, ascending. Returns how many.
  int (*within)(const LookArrays& looks, const LookWindow& window, int first, int last, std::int32_t* found);
  /// values[i] = exp(values[i]), to the last bit or two, for −700 ≤ values[i] ≤ 0. The same bits everywhere,
  /// which std::exp does not give.
  void (*exponentials)(double* values, int count);
  /// Pixels of like colours: each cell's weighed with exp(−mean square difference of the channels / spread).
  /// `work`: cells.count numbers, working memory.
  NearPixels (*pixels_like)(const ColourCells& cells, const double* colour, double spread, double* work);
  /// The same, off by less than kRoughness of it, and several times as fast. Not the same bits everywhere.
  NearPixels (*pixels_roughly_like)(const ColourCells& cells, const double* colour, double spread);
  /// Background::disparity_px() of `count` planes in row y.
  void (*find_behind)(const GroundPlane* planes, int count, int y, int width, float* out);
  /// 1 where beside_border(), else 0. `above` and `below` of the first and the last row: the row itself.
  void (*mark_borders)(const RegionId* above, const RegionId* row, const RegionId* below, int width,
                       std::uint8_t* out);
  /// What is taken of each pixel: those with a disparity more than `least` before the background. before[x] =
  /// 1 where evidence is more than `margin` before it, else 0.
  void (*judge)(const ShownRow& row, int width, float least, float margin, Taken* taken,
                std::uint8_t* before);
};

/// The functions of this build for `target`, nullptr where it has none. Never nullptr for Target::scalar.
const LookKernels* look_kernels(Target target);
/// Those for the target that `exec` gets.
const LookKernels& look_kernels(const Exec& exec);

}  // namespace cairn::kernels
