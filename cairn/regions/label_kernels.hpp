// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <algorithm>
#include <cairn/core/exec.hpp>
#include <cairn/core/ids.hpp>
#include <cairn/core/image.hpp>
#include <cstddef>
#include <cstdint>

/// The kernels of watershed(), build_graph(), measure() and find_floor(), per pixel of a row or value of a
/// list; one set per instruction set. Private to the library.
namespace cairn::kernels {

/// One bit for each of 64 pixels, the leftmost in the lowest bit.
using Word = std::uint64_t;
constexpr int kWordBits = 64;

/// How the pixels of a row lie to their neighbours.
struct Slopes {
  // The lowest neighbour, where that is lower than the pixel; of several the first in this order.
  Word* up;
  Word* left;
  Word* right;
  Word* down;
  // As high as the pixel.
  Word* equal_right;
  Word* equal_below;
};

/// The pairs of different labels that rows of pixels show, the smaller one in `a`.
struct LabelPairs {
  std::int32_t* a;
  std::int32_t* b;
};

/// How much longer than their contents the lists must be that kernels write: whole vectors are stored.
constexpr std::size_t kListSlack = 64;

struct FloatRange {
  float least;
  float most;
};

/// Parts a range of values into buckets of equal width. A larger value is never in a lower bucket, however it
/// rounds.
struct Buckets {
  float least;  // no value is below
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
  /// out[x] = first + how many bits up to x are set, x itself counted, − 1. Writes whole eights of pixels.
  void (*count_up)(const Word* bits, int width, std::int32_t first, RegionId* out);
  /// Where the runs of equal labels in two rows end, of which one changes, the other, or both: ends[i] is one
  /// past the last pixel of run i. The rows may be the same. Returns how many runs there are.
  int (*find_runs)(const RegionId* label, const RegionId* other, int width, std::int32_t* ends);
  /// The pixels of two rows whose labels differ, and these labels. Returns how many.
  int (*differing)(const RegionId* row, const RegionId* other, int width, std::int32_t* pixels,
                   LabelPairs pairs);
  /// The pairs of different labels side by side in a row, and one above the other in two. What has its like
  /// one row higher, or side by side close by, is left out: every pair of labels that touch somewhere in an
  /// image shows up somewhere, and most of them seldom. `above` of the first row: labels that there are not.
  /// Return how many.
  int (*touches_beside)(const RegionId* above, const RegionId* row, int width, LabelPairs pairs);
  int (*touches_below)(const RegionId* above, const RegionId* row, int width, LabelPairs pairs);
  /// What the first x pixels of a row sum up to, in up_to[x], for x = 0 … width: sum · 2⁴⁰ + sum of squares.
  /// Beyond 65535 pixels sums overflow, which does no harm: the difference of two not farther apart is right.
  void (*sum_grey)(const Gray* values, int width, std::uint64_t* up_to);
  /// The same of disparities, kHole16 where there is none: sum · 2³² + valid pixels · 2¹⁶ + floor pixels, and
  /// the sum of squares. `floor`: not 0 where there is floor; nullptr for nowhere.
  void (*sum_disparities)(const std::int16_t* values, const std::uint8_t* floor, int width,
                          std::uint64_t* up_to, std::uint64_t* squares_up_to);
  /// The same of colours: red + green · 2²¹ + blue · 2⁴². Right for 8192 pixels.
  void (*sum_colours)(const Rgb* colours, int width, std::uint64_t* up_to);
  /// Those of row[first] … row[last − 1] where `by` is not NaN, in their order. Returns how many.
  int (*keep_known)(const float* row, const float* by, int first, int last, float* kept);
  /// The least and the greatest of `count` values, at least one. No value is NaN.
  FloatRange (*find_range)(const float* values, std::size_t count);
  /// Those values whose bucket(value) is `wanted`, in their order. Returns how many.
  std::size_t (*keep_bucket)(const float* values, std::size_t count, const Buckets& buckets,
                             std::int32_t wanted, float* kept);
  /// bucket(values[i]) for each of them.
  void (*number_buckets)(const float* values, std::size_t count, const Buckets& buckets,
                         std::int32_t* numbers);
  /// The i for which marks[i] is not 0, ascending. Returns how many.
  std::size_t (*find_marked)(const std::uint8_t* marks, std::size_t count, std::uint32_t* found);
};

/// The functions of this build for `target`, nullptr if it has none. Never nullptr for Target::scalar.
const LabelKernels* label_kernels(Target target);
/// The functions for the active target of `exec`.
const LabelKernels& label_kernels(const Exec& exec);

}  // namespace cairn::kernels
