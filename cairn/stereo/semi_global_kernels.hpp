// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <algorithm>
#include <array>
#include <cairn/core/exec.hpp>
#include <cairn/stereo/memory.hpp>
#include <cairn/stereo/semi_global.hpp>
#include <cstdint>

/// The kernels of match_semi_global(): everything that runs per pixel; one set per instruction set. Private
/// to the library.
namespace cairn::kernels {

/// C of a box of nine pixels with all 24 bits different.
inline constexpr int kMaxCost = (9 * 24 + 2) / 4;
/// The penalties of two paths together fit into a byte.
inline constexpr int kMaxPenalty = 127;

/// Number of rows whose horizontal paths are computed concurrently.
inline constexpr int kRowsAbreast = 2;

struct SemiGlobalPenalties {
  std::uint8_t small = 0;
  std::array<std::uint8_t, 256> large{};  // by the step of intensity
};
SemiGlobalPenalties penalty_table(const SemiGlobalConfig& config);

/// The images of semi-global matches, with undefined content.
Matches make_matches(Size size, MatchMaps maps, const Pool& pool);

/// The search range, and the position of the candidates of a left pixel in a reversed right row: contiguous,
/// lane i for first_d + i.
struct SearchLayout {
  int width;
  int height;
  int first_d;  // px
  int count;    // candidates
  int lanes;    // the same, rounded up to whole vectors
  static constexpr int kMargin = 64;

  [[nodiscard]] int pad() const { return std::max(0, -first_d); }
  [[nodiscard]] int length() const {
    return round_up(pad() + width + std::max(0, first_d) + lanes + kMargin, 64);
  }
  [[nodiscard]] int reversed(int x_right) const { return pad() + width - 1 - x_right; }
  [[nodiscard]] int first_lane(int x) const { return reversed(x - first_d); }
  /// The candidates of x inside the right image: lanes begin … end − 1.
  [[nodiscard]] int begin(int x) const { return std::clamp(x - width + 1 - first_d, 0, count); }
  [[nodiscard]] int end(int x) const { return std::clamp(x - first_d + 1, begin(x), count); }
};

/// One call of match_semi_global(): its images and working memory.
struct SemiGlobalTask {
  SearchLayout layout;
  SemiGlobalPenalties penalties;
  MatchMaps maps;
  View<const Gray> left;
  View<const Gray> right;
  View<Gray> smooth;                // the left image, smoothed
  View<std::uint8_t> left_bits;     // census: three rows of bytes side by side, round_up(width, 64) each
  View<std::uint8_t> right_bits;    // the same reversed, layout.length() each
  View<const std::uint8_t> inside;  // one reversed row: 255 for existing pixels
  int band_rows;                    // the last band may have fewer
  View<std::uint8_t> band_along;    // [band]: L of the downward path in the row above it, width·lanes
  View<std::uint8_t> band_least;    // [band]: minimum of these for each pixel
  View<std::uint8_t> costs;         // of one band, C: width·lanes in a row; 255 in lanes ≥ count
  View<std::uint8_t> steps;  // of one band, L − C of the downward path, later plus that of the upward path
  View<std::uint8_t> along;  // L of the upward path, one row
  View<std::uint8_t> least;  // minimum of these for each pixel
  Matches& out;

  [[nodiscard]] int bands() const { return (layout.height + band_rows - 1) / band_rows; }
  [[nodiscard]] std::uint8_t* costs_of(int y) const { return costs.row(y % band_rows); }
  [[nodiscard]] std::uint8_t* steps_of(int y) const { return steps.row(y % band_rows); }
};

struct SemiGlobalKernels {
  /// Number of lanes for `count` candidates.
  int (*lanes)(int count);
  /// Census of both images and the smoothed left one, for the rows first … last − 1.
  void (*describe_rows)(const SemiGlobalTask& task, int first, int last);
  /// The downward path, for the columns first … last − 1 of all rows: band_along and band_least, and costs and steps of
  /// the last band.
  void (*match_down)(const SemiGlobalTask& task, int first, int last);
  /// Costs and steps of a band once more, for the columns first … last − 1.
  void (*match_band)(const SemiGlobalTask& task, int first, int last, int band);
  /// The upward path, for the columns first … last − 1 of the rows bottom − 1 … top. To be called from the
  /// lowest rows to the highest.
  void (*match_up)(const SemiGlobalTask& task, int first, int last, int top, int bottom);
  /// The horizontal paths and the winners, for the rows first … last − 1.
  void (*match_across)(const SemiGlobalTask& task, int first, int last);
};

/// match_semi_global(), with bands of so many rows: any number ≥ 1 gives the same.
Matches match_in_bands(const StereoPair& pair, const MatchConfig& config, const SemiGlobalConfig& penalties,
                       int band_rows, const Exec& exec);

/// The functions of this build for `target`, nullptr if it has none. Never nullptr for Target::scalar.
const SemiGlobalKernels* semi_global_kernels(Target target);
/// The functions for the active target of `exec`.
const SemiGlobalKernels& semi_global_kernels(const Exec& exec);

}  // namespace cairn::kernels
