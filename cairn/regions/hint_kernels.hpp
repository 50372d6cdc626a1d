// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cairn/core/exec.hpp>
#include <cairn/core/image.hpp>
#include <cairn/regions/object_hints.hpp>
#include <cstdint>

/// The kernels of hint_input(), per row of pixels or cells; one set per instruction set. Private to the
/// library.
namespace cairn::kernels {

/// The channels of a cell.
enum HintChannel : int {
  kMeanBrightness,
  kMeanBlue,
  kMeanRed,
  kMeanDisparity,
  kShareMatched,
  kAboveGround,
  kBeforeBackground,
  kGroundThere,
  kMeanEdge,
  kShareTextured,
  kHeightInImage,
  kHasColour,
  kRelativeBrightness,
  kRelativeBlue,
  kRelativeRed,
  kRelativeDisparity
};
static_assert(kRelativeDisparity + 1 == kHintChannels);

/// One row of the image.
struct HintPixels {
  const Gray* gray = nullptr;
  const Rgb* rgb = nullptr;  // nullptr: the image has no colour
  const std::uint16_t* edges = nullptr;
  const float* disparity_px = nullptr;  // NaN = hole
  const float* textured_px = nullptr;
  const float* ground_px = nullptr;  // 0 above the horizon
  const float* background_px = nullptr;
};

/// Integer sums over pixels …
enum WholeSum : std::size_t {
  kBrightness,
  kBlue,
  kRed,
  kSquares,
  kEdges,
  kTextured,
  kMatched,
  kAbove,
  kWholeSums
};
/// … and of distances: those above the ground if there is one, those in front of the background if there is a
/// disparity.
enum RealSum : std::size_t { kDisparity, kGround, kHeight, kBefore, kRealSums };

/// Structure of arrays.
struct ColumnSums {
  std::array<std::int32_t*, kWholeSums> whole{};
  std::array<double*, kRealSums> real{};
};
struct CellSums {
  std::array<double*, kWholeSums> whole{};
  std::array<double*, kRealSums> real{};
};

/// A cell is compared with those of a window around it.
inline constexpr int kAround = 8;
inline constexpr int kWindow = 2 * kAround + 1;
/// Sums over cells: of brightness and the two colours, of their squares, of the disparities of the matched cells,
/// and the number of these.
inline constexpr std::size_t kLooks = 3;
enum ChannelSum : std::size_t {
  kLookSums,
  kSquareSums = kLooks,
  kDisparitySum = 2 * kLooks,
  kMatchedCells,
  kChannelSums
};
using ChannelSums = std::array<std::int32_t*, kChannelSums>;

/// The scale of a channel: (value − zero) / unit, limited to least … most. Precondition: least ≥ −16.
struct ChannelScale {
  double zero;
  double unit;
  double least;
  double most;
};

/// Plain loops that compilers vectorise. Floating-point operations are rounded in the written order, so every
/// target gets the same bits.
struct HintKernels {
  /// Adds a row to the column sums. Precondition: they contain fewer than 2¹⁵ rows.
  void (*add_row)(const HintPixels& row, int width, const ColumnSums& sums);
  /// The sums over columns first[cell] … last[cell] − 1: at least one and at most `most` columns.
  void (*sum_cells)(const ColumnSums& columns, const std::int32_t* first, const std::int32_t* last, int most,
                    int cells, const CellSums& sums);
  /// sums / counts; `none` where the count is 0.
  void (*mean)(const double* sums, const double* counts, int cells, double none, double* out);
  /// By `scale`, in 1/64, rounded, halves up, to every `stride`th of `out`.
  void (*put)(const double* values, int cells, const ChannelScale& scale, int stride, std::int16_t* out);
  /// Adds a row of cells, `sign` (1 or −1) times, to sums per column.
  void (*add_cells)(const std::int16_t* row, int cells, int sign, const ChannelSums& columns);
  /// The sums of `columns` over the window of each cell. `columns` has kAround zeros more on both sides; `blocks`:
  /// memory for 2 · (cells + kWindow) numbers.
  void (*sum_around)(const std::int32_t* columns, int cells, std::int32_t* blocks, std::int32_t* sums);
  /// Writes the channels that compare a cell with its window, for a row of cells; `sums`, `counts`: of these windows.
  void (*compare)(const ChannelSums& sums, const double* counts, int cells, std::int16_t* row);
};

/// The functions of this build for `target`, nullptr if it has none. Never nullptr for Target::scalar.
const HintKernels* hint_kernels(Target target);
/// The functions for the active target of `exec`.
const HintKernels& hint_kernels(const Exec& exec);

}  // namespace cairn::kernels
