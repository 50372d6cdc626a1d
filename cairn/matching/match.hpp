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

/// window: a square window for every pixel, on its own. semi_global: single pixels, neighbours agree
/// (semi_global.hpp).
enum class MatchMethod : std::uint8_t { window, semi_global };
/// The correlation operators, each as a cost ≥ 0 where less is better. (paper, "Disparity map estimation")
enum class Cost : std::uint8_t { sad, ssd, zsad, zssd, nssd, zncc };
enum class Prefilter : std::uint8_t { none, xsobel };
/// Which maps of Matches are wanted and paid for. winner: best and cost; minimum: also what lies around them;
/// full: also the mean and the right image's winners.
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
  MatchMethod method = MatchMethod::window;  // semi_global where surfaces are plain, window for exact costs
  Cost cost = Cost::zncc;                    // zncc, zsad, zssd bear unlike exposures; sad and ssd do not
  int window_size = 9;    // px, odd, 3 … 31; larger bears noise, smaller keeps rims; clipped at the border
  int min_disparity = 0;  // px, −1024 … 1023; below 0 where the cameras converge
  int num_disparities = 64;  // px, 1 … 1024; candidates are min_disparity … min_disparity + this − 1: nearer
  int row_band = 0;  // rows, 0 … 8; also tries rows y−k … y+k: for rows that are off within a frame
  Prefilter prefilter = Prefilter::none;  // xsobel: for sad and ssd on unlike exposures
  int prefilter_cap = 31;  // grey levels, 1 … 63; lower: weak edges count as much as strong ones
  /// No option: what the caller wants of match() itself. The whole method needs all of them.
  MatchMaps maps = MatchMaps::full;
};
template <class V>
void fields(MatchConfig& c, V&& v) {
  v("method", c.method, "", "window: correlation alone; semi_global: neighbours agree along paths",
    kMatchMethods);
  constexpr Condition kWindows = when("match.method", "window");
  v("cost", c.cost, "", "correlation operator", kCosts, kWindows);
  v("window_size", c.window_size, "px", "side of the square correlation window, odd", odd_range(3, 31),
    kWindows);
  v("min_disparity", c.min_disparity, "px", "first disparity tried; may be negative", range(-1024, 1023));
  v("num_disparities", c.num_disparities, "px",
    "how many disparities are tried; a calibration's ndisp replaces the default", range(1, 1024));
  v("row_band", c.row_band, "rows", "also search k rows above and below (vibration)", range(0, 8), kWindows);
  v("prefilter", c.prefilter, "", "filter both images before matching", kPrefilters, kWindows);
  v("prefilter_cap", c.prefilter_cap, "grey levels", "clip the x-Sobel response to ±cap", range(1, 63),
    when("match.prefilter", "xsobel"));
}

/// In Matches::best: no candidate lay inside the right image.
inline constexpr std::int16_t kNoMatch = std::numeric_limits<std::int16_t>::min();
/// In the cost maps of Matches: there is no such candidate (neighbour outside the range or the image, no
/// runner-up).
inline constexpr float kNoCost = std::numeric_limits<float>::infinity();

/// The outcome of correlation, per left pixel (best_right: per right pixel).
/// With MatchMaps::winner only best, row_offset and cost are there, with MatchMaps::minimum all but
/// best_right and mean_cost; the other images are empty.
struct Matches {
  Image<std::int16_t> best;  // disparity of least cost in px, kNoMatch = none; ties: the smallest disparity
  Image<std::int16_t> best_right;  // the same seen from the right image, out of the same costs
  Image<std::int8_t> row_offset;   // row of the match minus y; empty where row_band = 0
  Image<float> cost;               // of best; kNoCost where there is no match
  Image<float> runner_up;          // least cost with |d − best| > 1
  Image<float> mean_cost;          // over all candidates of the pixel
  Image<float> cost_before;        // at best − 1
  Image<float> cost_after;         // at best + 1
};

/// Correlates every left pixel with its candidates on the epipolar line; winner takes all.
///
/// cost(x, y, d) compares the window around (x, y) of the left image with that around (x − d, y) of the right
/// one, clipped to where both lie inside their images. With L, R the window's pixels and N their count:
///   sad  Σ|L−R|      ssd  Σ(L−R)²
///   zsad Σ|L'−R'| / 16, each image first minus the mean over the window centred on the pixel itself, in 1/16
///   levels zssd (N·Σ(L−R)² − (ΣL−ΣR)²) / N nssd Σ(L−R)² / sqrt(ΣL²·ΣR²), 65536 where either has no energy
///   zncc 1 − (N·ΣLR − ΣL·ΣR) / sqrt((N·ΣL²−(ΣL)²)·(N·ΣR²−(ΣR)²)), 1 where either has no variance
/// Sums are exact integers; the last formula is float and the same on every target (pixel_math.hpp).
/// With row_band k, cost(x, y, d) is the least over the rows y+r of the right image, |r| ≤ k (ties: r = 0,
/// −1, 1, −2 …).
///
/// The time per pixel and disparity depends neither on the window's size nor on what the picture shows.
/// (docs/stages/matching.md; paper, "Disparity map estimation")
/// Whatever config.method says: match() in semi_global.hpp goes by that.
Matches match_windows(const StereoPair& pair, const MatchConfig& config, const Exec& exec);

}  // namespace cairn
