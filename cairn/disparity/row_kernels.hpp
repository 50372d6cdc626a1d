// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <bit>
#include <cairn/core/exec.hpp>
#include <cairn/disparity/confidence.hpp>
#include <cairn/disparity/reject.hpp>
#include <cairn/scene/ground_plane.hpp>
#include <cstdint>

/// The seam to the instruction sets: what the checks of single pixels, find_evidence(), gradient(),
/// edge_strength(), estimate_confidence(), fit_background() and measure() do for each pixel of a row, and for
/// each point of a sample. Private to the library.
namespace cairn::kernels {

/// A left pixel's claim to the right pixel that it is matched with, as one number: of two the smaller wins,
/// by its cost, then by its disparity, which is the smaller one where x is. Costs are not negative, so that
/// their bits are in their order; the sign that a zero may have is left out.
using Claim = std::uint64_t;
inline constexpr Claim kNoClaim = ~Claim{0};
constexpr Claim claim_of(float cost, std::int32_t x) {
  constexpr std::uint32_t kNoSign = 0x7FFFFFFF;
  return Claim{std::bit_cast<std::uint32_t>(cost) & kNoSign} << 32 | static_cast<std::uint32_t>(x);
}
constexpr std::int32_t claimant(Claim claim) {
  return static_cast<std::int32_t>(claim & 0xFFFFFFFF);
}

/// One side of a symmetric smoothing kernel in 1/256: weights[i] stands at +i and −i.
struct RowWeights {
  const int* weights;
  int radius;
};

/// Points, one array per coordinate.
struct PointArrays {
  const float* x;
  const float* y;
  const float* d;
  const float* behind;  // the background's disparity there
  int count;
};

/// Sums over the points on a plane.
struct PlaneSums {
  std::uint64_t count = 0;
  std::uint64_t x = 0;
  std::uint64_t y = 0;
  std::uint64_t xx = 0;
  std::uint64_t xy = 0;
  std::uint64_t yy = 0;
};

/// How many points lie where to a plane, of those that are seen below its horizon.
struct PlaneCounts {
  int all = 0;
  int on = 0;     // within the tolerance
  int near = 0;   // within twice of it
  int below = 0;  // farther away than that
};

/// Holes (low byte) and jumps of the disparity (high byte), counted over some pixels.
using HolesAndJumps = std::uint16_t;

/// What confidence is judged by in a row.
struct ConfidenceRow {
  const float* cost;
  const float* runner_up;
  const float* mean_cost;
  const float* disparity_px;
  const HolesAndJumps* around;  // each pixel
  const float* inverse_area;    // 1 / the pixels that these were counted over
};

/// What a row is judged by to be floor, or below it.
struct FloorRow {
  GroundPlane plane;
  float infinity;  // a point at infinity has disparity −infinity
  float margin;
};

/// Sums of squared differences, for reject_textureless(). The narrower the sums, the more at once.
template <class Sum>
struct SquareKernels {
  /// sums[x] += min((here[x] − there[x])², most) for `count` pixels; and the same taken away again.
  void (*add)(const std::uint8_t* here, const std::uint8_t* there, int count, std::uint16_t most, Sum* sums);
  void (*remove)(const std::uint8_t* here, const std::uint8_t* there, int count, std::uint16_t most,
                 Sum* sums);
  /// verdict[x] |= `why` where columns[x] + … + columns[x + window − 1] is below limits[x]. `blocks`:
  /// 2 · (width + window) samples, `sums`: width, working memory. The window is odd.
  void (*flag_low)(const Sum* columns, int width, int window, const Sum* limits, Reject why, Sum* blocks,
                   Sum* sums, Reject* verdict);
};

/// Plain loops that compilers make vector code of; compiled once for each instruction set. None of them
/// rounds in another order than it is written in, so that each gives the same bits.
struct RowKernels {
  /// reject_inconsistent() where matches lie in the pixels' own row, by vote and by the right winners.
  /// Working memory: `partners` and `back` width numbers, `claims` one more.
  void (*compare_with_votes)(const std::int16_t* best, const float* cost, int width, int max_diff,
                             std::int32_t* partners, Claim* claims, Reject* verdict);
  void (*compare_with_right)(const std::int16_t* best, const std::int16_t* best_right, int width,
                             int max_diff, std::int32_t* partners, std::int32_t* back, Reject* verdict);
  /// Reject::not_unique where runner_up · share < cost · 100.
  void (*compare_with_runner_up)(const float* cost, const float* runner_up, int width, float share,
                                 Reject* verdict);
  /// Reject::flat where (mean − cost) / mean is below `threshold`, or the mean not above 0.
  void (*compare_with_mean)(const float* cost, const float* mean, int width, float threshold,
                            Reject* verdict);
  /// Reject::border where there is no disparity (NaN).
  void (*mark_holes)(const float* disparity_px, int width, Reject* reject);
  void (*add_reasons)(const Reject* more, int width, Reject* reject);
  /// NaN where there is a reason.
  void (*punch_holes)(const Reject* reject, int width, float* disparity_px);
  /// The rows −radius … +radius around a row, smoothed down and then across: `rows[i]` stands for row i −
  /// radius, `width` samples of `channels` interleaved bytes each. Writes 1/16 levels. `padded`: width + 2 ·
  /// radius samples, `sum`: width, working memory.
  void (*smooth)(const std::uint8_t* const* rows, int width, int channels, RowWeights kernel,
                 std::uint16_t* padded, std::uint32_t* sum, std::int16_t* out);
  /// Magnitude in 1/4 level, of the channel where it is largest, of the gradient of a row that smooth() made
  /// and those above and below. `squares`: width samples, working memory.
  void (*edges)(const std::int16_t* up, const std::int16_t* here, const std::int16_t* down, int width,
                int channels, std::uint32_t* squares, std::uint16_t* out);
  /// Magnitude in whole levels, capped at 255, of the gradient from one side of a pixel to the other of a row
  /// that smooth() made from single samples.
  void (*steepness)(const std::int16_t* up, const std::int16_t* here, const std::int16_t* down, int width,
                    std::uint16_t* out);
  /// The same of quantised disparities: see gradient() in image/gradient.hpp.
  void (*disparity_steepness)(const std::int16_t* up, const std::int16_t* here, const std::int16_t* down,
                              int width, std::uint16_t* out);
  /// Disparities in 1/16 px: see quantised() in image/gradient.hpp.
  void (*quantise)(const float* disparity_px, int width, std::int16_t* out);
  /// |(1 −2 1; −2 4 −2; 1 −2 1)| of the samples 1 … width − 2.
  void (*noise)(const std::uint8_t* up, const std::uint8_t* here, const std::uint8_t* down, int width,
                std::uint16_t* out);
  /// (1 6 1)/8 both ways, in 1/64 level. `column`: width + 2 samples, working memory.
  void (*smooth_lightly)(const std::uint8_t* up, const std::uint8_t* here, const std::uint8_t* down,
                         int width, std::int16_t* column, std::int16_t* out);
  /// The disparities of valid pixels whose difference across is above `least` and above half of that down;
  /// NaN elsewhere.
  void (*textured)(const std::int16_t* up, const std::int16_t* here, const std::int16_t* down,
                   const Reject* reject, const float* disparity_px, int width, int least, float* out);
  /// Keeps those of rows[2] to which at least three others of the 5×5 neighbours are as near as `agreement`;
  /// NaN elsewhere. All rows go on for two NaN at either end.
  void (*agreed)(const float* const* rows, int width, float agreement, float* out);
  /// How many points lie nearer to the plane than `tolerance`.
  int (*count_on)(const PointArrays& points, const GroundPlane& plane, float tolerance);
  /// How many points lie farther than `tolerance` behind the plane and the background.
  int (*count_beyond)(const PointArrays& points, const GroundPlane& plane, float tolerance);
  /// How many points lie nearer to the plane than `tolerance` where it stands before the background.
  int (*count_on_before)(const PointArrays& points, const GroundPlane& plane, float tolerance);
  /// Sums over the points that lie nearer to the plane than `tolerance`; x and y are whole numbers. d_on[i] =
  /// the disparity of these points, 0 of all others.
  PlaneSums (*sum_on)(const PointArrays& points, const GroundPlane& plane, float tolerance, float* d_on);
  /// behind[i] = the plane's disparity at point i, where that is more.
  void (*put_behind)(const PointArrays& points, const GroundPlane& plane, float* behind);
  /// marks[i] = 1 where least ≤ the point's distance above the plane ≤ most, in px of disparity; else 0.
  void (*mark_between)(const PointArrays& points, const GroundPlane& plane, float least, float most,
                       std::uint8_t* marks);
  /// A point at infinity has the disparity −infinity. `points.behind` is not looked at.
  PlaneCounts (*count_about)(const PointArrays& points, const GroundPlane& plane, float infinity,
                             float tolerance);
  /// The same of the pixels of row `y`: `all` of those with a disparity, and `on`.
  PlaneCounts (*count_support)(const float* disparity_px, int y, int width, const GroundPlane& plane,
                               float infinity, float tolerance);
  /// reject_below_ground() and label_floor() for the pixels of row `y`.
  void (*reject_below)(const FloorRow& floor, int y, int width, float* disparity_px, Reject* reject);
  void (*label_floor)(const FloorRow& floor, int y, int width, const float* disparity_px,
                      std::uint8_t* label);
  SquareKernels<std::uint16_t> narrow_squares;
  SquareKernels<std::uint32_t> wide_squares;
  /// Marks each hole, and each disparity that differs by more than `jump` from the one to the right or below.
  /// The last pixel has no right neighbour.
  void (*mark_jumps)(const float* here, const float* below, int width, float jump, HolesAndJumps* marks);
  /// counts[x] += more[x], or −= .
  void (*add_counts)(const HolesAndJumps* more, int width, HolesAndJumps* counts);
  void (*remove_counts)(const HolesAndJumps* less, int width, HolesAndJumps* counts);
  /// sums[x] = columns[x] + … + columns[x + window − 1]. `blocks`: 2 · (width + window)
  /// samples, working memory. The window is odd.
  void (*sum_counts)(const HolesAndJumps* columns, int width, int window, HolesAndJumps* blocks,
                     HolesAndJumps* sums);
  /// See estimate_confidence().
  void (*judge_confidence)(const ConfidenceRow& row, int width, const ConfidenceModel& model, float* out);
  /// rig.point_in_camera_m() of the pixels first … last − 1 of row y, one array per axis, of which the same
  /// pixels are written; NaN where there is no disparity, and at infinity and beyond.
  void (*points_in_camera)(const StereoRig& rig, int y, int first, int last, const float* disparity_px,
                           float* x_m, float* y_m, float* z_m);
};

/// The functions of this build for `target`, nullptr where it has none. Never nullptr for Target::scalar.
const RowKernels* row_kernels(Target target);
/// Those for the target that `exec` gets.
const RowKernels& row_kernels(const Exec& exec);

}  // namespace cairn::kernels
