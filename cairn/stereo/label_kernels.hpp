// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <algorithm>
#include <cairn/core/exec.hpp>
#include <cairn/core/ids.hpp>
#include <cairn/core/image.hpp>
#include <cstddef>
#include <cstdint>

/// The kernels of watershed(), refine_outlines(), build_graph(), measure() and find_floor(), per pixel of a row or value of a
/// list; one set per instruction set. Private to the library.
namespace cairn::kernels {

/// One bit for each of 64 pixels, the leftmost in the lowest bit.
using Word = std::uint64_t;
constexpr int kWordBits = 64;

/// The relation of the pixels of a row to their neighbours.
struct Slopes {
  // The lowest neighbour, if lower than the pixel; of several the first in this order.
  Word* up;
  Word* left;
  Word* right;
  Word* down;
  // Neighbours equal to the pixel.
  Word* equal_right;
  Word* equal_below;
};

/// Pairs of different labels that touch, the smaller one in `a`.
struct LabelPairs {
  std::int32_t* a;
  std::int32_t* b;
};

/// Extra capacity of the lists that kernels write: whole vectors are stored.
constexpr std::size_t kListSlack = 64;

/// Three rows of an image; outside it, the border row repeats.
template <class T>
struct ThreeRows {
  const T* above;
  const T* here;
  const T* below;
};

struct FloatRange {
  float least;
  float most;
};

/// Divides a range of values into buckets of equal width. Monotonic: a larger value is never in a lower
/// bucket, whatever the rounding.
struct Buckets {
  float least;  // lower bound of the values
  float scale;  // buckets per unit
  std::int32_t last;
  [[nodiscard]] std::int32_t bucket(float value) const {
    return std::min(static_cast<std::int32_t>((value - least) * scale), last);
  }
};

struct LabelKernels {
  /// `words` words of `slopes`, from heights[−1 … 64·words] of three rows.
  void (*compare)(const std::uint16_t* above, const std::uint16_t* here, const std::uint16_t* below,
                  int words, const Slopes& slopes);
  /// out[x] = first + (number of set bits up to and including x) − 1. Writes multiples of eight pixels.
  void (*count_up)(const Word* bits, int width, std::int32_t first, RegionId* out);
  /// The ends of the runs of equal labels in two rows; a run ends where either label changes: ends[i] is one
  /// past the last pixel of run i. The rows may be the same. Returns the number of runs.
  int (*find_runs)(const RegionId* label, const RegionId* other, int width, std::int32_t* ends);
  /// The pixels of two rows with different labels, and these labels. Returns their number.
  int (*differing)(const RegionId* row, const RegionId* other, int width, std::int32_t* pixels,
                   LabelPairs pairs);
  /// The pixels of a row, at an outline, that are on the wrong side of the crest of `edges`: of two opposite neighbours
  /// only one has the pixel's label, and it is a stronger edge than both others. Returns their number.
  int (*past_crest)(const ThreeRows<RegionId>& labels, const ThreeRows<std::uint16_t>& edges, int width,
                    std::int32_t* pixels);
  /// The pairs of different labels next to each other in a row, and one above the other in two. Pairs also
  /// present one row higher, or nearby in the row, are skipped: every pair of touching labels in the image is
  /// reported somewhere, most of them rarely. `above` of the first row: labels that do not occur. Return the
  /// number of pairs.
  int (*touches_right)(const RegionId* above, const RegionId* row, int width, LabelPairs pairs);
  int (*touches_below)(const RegionId* above, const RegionId* row, int width, LabelPairs pairs);
  /// Prefix sums of a row: up_to[x] = sum · 2⁴⁰ + sum of squares of the first x pixels, x = 0 … width. Sums
  /// overflow beyond 65535 pixels; differences over shorter distances remain correct.
  void (*sum_grey)(const Gray* values, int width, std::uint64_t* up_to);
  /// The same for disparities, kHole16 = hole: sum · 2³² + valid pixels · 2¹⁶ + floor pixels, and the sum of
  /// squares. `floor`: non-zero for floor; nullptr if there is none.
  void (*sum_disparities)(const std::int16_t* values, const std::uint8_t* floor, int width,
                          std::uint64_t* up_to, std::uint64_t* squares_up_to);
  /// The same for colours: red + green · 2²¹ + blue · 2⁴². Correct for 8192 pixels.
  void (*sum_colours)(const Rgb* colours, int width, std::uint64_t* up_to);
  /// The elements of row[first] … row[last − 1] for which `by` is not NaN, in order. Returns their number.
  int (*keep_known)(const float* row, const float* by, int first, int last, float* kept);
  /// The minimum and maximum of `count` ≥ 1 values, none of them NaN.
  FloatRange (*find_range)(const float* values, std::size_t count);
  /// The values with bucket(value) = `wanted`, in order. Returns their number.
  std::size_t (*keep_bucket)(const float* values, std::size_t count, const Buckets& buckets,
                             std::int32_t wanted, float* kept);
  /// bucket(values[i]) for each value.
  void (*number_buckets)(const float* values, std::size_t count, const Buckets& buckets,
                         std::int32_t* numbers);
  /// The indices with marks[i] ≠ 0, ascending. Returns their number.
  std::size_t (*find_marked)(const std::uint8_t* marks, std::size_t count, std::uint32_t* found);
};

/// The functions of this build for `target`, nullptr if it has none. Never nullptr for Target::scalar.
const LabelKernels* label_kernels(Target target);
/// The functions for the active target of `exec`.
const LabelKernels& label_kernels(const Exec& exec);

}  // namespace cairn::kernels
