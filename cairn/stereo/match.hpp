// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cairn/core/exec.hpp>
#include <cairn/core/fields.hpp>
#include <cairn/core/stereo_pair.hpp>
#include <cstdint>
#include <limits>

namespace cairn {

/// window: a square window around each pixel, independently. semi_global: single pixels with a smoothness
/// constraint between neighbours (semi_global.hpp).
enum class MatchMethod : std::uint8_t { window, semi_global };
/// The correlation operators, each as a cost ≥ 0, lower is better. (paper, "Disparity map estimation")
enum class Cost : std::uint8_t { sad, ssd, zsad, zssd, nssd, zncc };
enum class Prefilter : std::uint8_t { none, xsobel };
/// The maps of Matches to compute. winner: best and cost; minimum: also the costs next to the minimum; full:
/// also the mean cost and the winners of the right image.
enum class MatchMaps : std::uint8_t { winner, minimum, full };

inline constexpr std::array kMatchMethods{Choice<MatchMethod>{"window", MatchMethod::window},
                                          Choice<MatchMethod>{"semi_global", MatchMethod::semi_global}};
inline constexpr std::array kCosts{Choice<Cost>{"sad", Cost::sad},   Choice<Cost>{"ssd", Cost::ssd},
                                   Choice<Cost>{"zsad", Cost::zsad}, Choice<Cost>{"zssd", Cost::zssd},
                                   Choice<Cost>{"nssd", Cost::nssd}, Choice<Cost>{"zncc", Cost::zncc}};
inline constexpr std::array kPrefilters{Choice<Prefilter>{"none", Prefilter::none},
                                        Choice<Prefilter>{"xsobel", Prefilter::xsobel}};
inline constexpr std::array kMatchMaps{Choice<MatchMaps>{"winner", MatchMaps::winner},
                                       Choice<MatchMaps>{"minimum", MatchMaps::minimum},
                                       Choice<MatchMaps>{"full", MatchMaps::full}};

struct MatchConfig {
  MatchMethod method = MatchMethod::window;  // semi_global for low texture, window for exact costs
  Cost cost = Cost::zncc;                    // zncc, zsad, zssd tolerate unequal exposures; sad, ssd do not
  int window_size = 9;  // px, odd, 3 … 31; larger tolerates noise, smaller keeps edges; clipped at the border
  int min_disparity = 0;     // px, −1024 … 1023; below 0 if the cameras converge
  int num_disparities = 64;  // px, 1 … 1024; candidates min_disparity … min_disparity + this − 1
  int row_band = 0;  // rows, 0 … 8; also searches rows y−k … y+k: for a row offset that varies within a frame
  Prefilter prefilter = Prefilter::none;  // xsobel: for sad and ssd on unequal exposures
  /// A constant, not an option: grey levels, 1 … 63; clipping limit of the x-Sobel response, as in OpenCV.
  int prefilter_cap = 31;
  /// Not an option: the maps that the caller of match() reads. The whole method needs all of them.
  MatchMaps maps = MatchMaps::full;
};
template <class V>
void fields(MatchConfig& c, V&& v) {
  v("method", c.method, "", "window: independent pixels; semi_global: smoothness along paths", kMatchMethods);
  constexpr Condition kWindows = when("match.method", "window");
  v("cost", c.cost, "", "correlation operator", kCosts, kWindows);
  v("window_size", c.window_size, "px", "side of the square correlation window", odd_range(3, 31), kWindows);
  v("min_disparity", c.min_disparity, "px", "lowest disparity searched; negative for converging cameras",
    range(-1024, 1023));
  v("num_disparities", c.num_disparities, "px",
    "number of disparities searched; default: ndisp of the calibration", range(1, 1024));
  v("row_band", c.row_band, "rows", "number of rows searched above and below the epipolar line (vibration)",
    range(0, 8), kWindows);
  v("prefilter", c.prefilter, "", "filter applied to both images before matching", kPrefilters, kWindows);
}

/// Value of Matches::best if no candidate lies inside the right image.
inline constexpr std::int16_t kNoMatch = std::numeric_limits<std::int16_t>::min();
/// Value in the cost maps of Matches if there is no such candidate: neighbour outside the range or the image,
/// or no runner-up.
inline constexpr float kNoCost = std::numeric_limits<float>::infinity();

/// The result of correlation, per left pixel (best_right: per right pixel). MatchMaps::winner computes only
/// best, row_offset and cost, MatchMaps::minimum all but best_right and mean_cost; the other images are
/// empty.
struct Matches {
  Image<std::int16_t> best;  // disparity of lowest cost in px, kNoMatch = none; ties: the smallest disparity
  Image<std::int16_t> best_right;  // the same for the right image, from the same costs
  Image<std::int8_t> row_offset;   // row of the match minus y; empty if row_band = 0
  Image<float> cost;               // of best; kNoCost if there is no match
  Image<float> runner_up;          // lowest cost with |d − best| > 1
  Image<float> mean_cost;          // over all candidates of the pixel
  Image<float> cost_before;        // at best − 1
  Image<float> cost_after;         // at best + 1
};

/// Correlates every left pixel with its candidates on the epipolar line; the lowest cost wins.
///
/// cost(x, y, d) compares the window around (x, y) of the left image with that around (x − d, y) of the right
/// one, clipped to the pixels inside both images. With L, R the pixels of the windows and N their number:
///   sad   Σ|L−R|
///   ssd   Σ(L−R)²
///   zsad  Σ|L'−R'| / 16, where L' and R' are 16·(pixel − mean of the window centred on it), rounded
///   zssd  (N·Σ(L−R)² − (ΣL−ΣR)²) / N
///   nssd  Σ(L−R)² / sqrt(ΣL²·ΣR²), 65536 if either has no energy
///   zncc  1 − (N·ΣLR − ΣL·ΣR) / sqrt((N·ΣL²−(ΣL)²)·(N·ΣR²−(ΣR)²)), 1 if either has no variance
/// Sums are exact integers; the last formula is float and the same on every target: one rounding per
/// operation, none fused.
/// With row_band k, cost(x, y, d) is the lowest over the rows y+r of the right image, |r| ≤ k (ties: r = 0,
/// −1, 1, −2 …).
///
/// The time per pixel and disparity depends neither on the size of the window nor on the image content.
/// Ignores config.method; match() in semi_global.hpp obeys it.
/// (docs/stages/matching.md; paper, "Disparity map estimation")
Matches match_windows(const StereoPair& pair, const MatchConfig& config, const Exec& exec);

}  // namespace cairn
