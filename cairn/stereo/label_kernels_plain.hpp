// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <algorithm>
#include <array>
#include <cairn/stereo/gradient.hpp>
#include <cairn/stereo/label_kernels.hpp>
#include <utility>

namespace cairn::kernels::plain_labels {

/// counts[byte][i]: number of set bits among bits 0 … i of the byte.
inline constexpr auto kBitCounts = [] {
  std::array<std::array<std::uint8_t, 8>, 256> counts{};
  for (std::size_t byte = 0; byte < counts.size(); ++byte) {
    std::uint8_t count = 0;
    for (std::size_t i = 0; i < 8; ++i) {
      count = static_cast<std::uint8_t>(count + ((byte >> i) & 1U));
      counts[byte][i] = count;
    }
  }
  return counts;
}();

inline void compare(const std::uint16_t* above, const std::uint16_t* here, const std::uint16_t* below,
                    int words, const Slopes& slopes) {
  for (int w = 0; w < words; ++w) {
    Word up = 0, left = 0, right = 0, down = 0, equal_right = 0, equal_below = 0;
    for (int i = 0; i < kWordBits; ++i) {
      const int x = w * kWordBits + i;
      const std::uint16_t lowest = std::min(std::min(above[x], here[x - 1]), std::min(here[x + 1], below[x]));
      const Word flows = lowest < here[x] ? Word{1} << i : 0;
      const Word is_up = above[x] == lowest ? flows : 0;
      const Word is_left = here[x - 1] == lowest ? flows & ~is_up : 0;
      const Word is_right = here[x + 1] == lowest ? flows & ~(is_up | is_left) : 0;
      up |= is_up;
      left |= is_left;
      right |= is_right;
      down |= flows & ~(is_up | is_left | is_right);
      equal_right |= Word{here[x] == here[x + 1]} << i;
      equal_below |= Word{here[x] == below[x]} << i;
    }
    slopes.up[w] = up;
    slopes.left[w] = left;
    slopes.right[w] = right;
    slopes.down[w] = down;
    slopes.equal_right[w] = equal_right;
    slopes.equal_below[w] = equal_below;
  }
}

inline void count_up(const Word* bits, int width, std::int32_t first, RegionId* out) {
  std::int32_t before = first - 1;
  for (int x = 0; x < width; x += 8) {
    const auto& counts = kBitCounts[(bits[x / kWordBits] >> (x % kWordBits)) & 0xFFU];
    for (std::size_t i = 0; i < 8; ++i) out[static_cast<std::size_t>(x) + i] = RegionId{before + counts[i]};
    before += counts[7];
  }
}

// The loops below have no branch on a label: label changes are unpredictable.

/// find_runs() from pixel `x` on, after `runs` runs.
inline int find_runs_from(int x, int runs, const RegionId* label, const RegionId* other, int width,
                          std::int32_t* ends) {
  for (; x + 1 < width; ++x) {
    ends[runs] = x + 1;
    runs += static_cast<int>((label[x] != label[x + 1]) | (other[x] != other[x + 1]));
  }
  ends[runs] = width;
  return runs + 1;
}

inline int find_runs(const RegionId* label, const RegionId* other, int width, std::int32_t* ends) {
  return find_runs_from(0, 0, label, other, width, ends);
}

inline void put_pair(LabelPairs pairs, int at, RegionId p, RegionId q) {
  pairs.a[at] = std::min(number(p), number(q));
  pairs.b[at] = std::max(number(p), number(q));
}

/// differing() from pixel `x` on, after `count` pixels.
inline int differing_from(int x, int count, const RegionId* row, const RegionId* other, int width,
                          std::int32_t* pixels, LabelPairs pairs) {
  for (; x < width; ++x) {
    pixels[count] = x;
    put_pair(pairs, count, row[x], other[x]);
    count += row[x] != other[x] ? 1 : 0;
  }
  return count;
}

inline int differing(const RegionId* row, const RegionId* other, int width, std::int32_t* pixels,
                     LabelPairs pairs) {
  return differing_from(0, 0, row, other, width, pixels, pairs);
}

/// past_crest() for the pixels first … last − 1, after `count` pixels.
inline int past_crest_from(int first, int last, int count, const ThreeRows<RegionId>& labels,
                           const ThreeRows<std::uint16_t>& edges, int width, std::int32_t* pixels) {
  for (int x = first; x < last; ++x) {
    const RegionId label = labels.here[x];
    const std::uint16_t edge = edges.here[x];
    const auto is_past = [&](bool first_is_same, bool second_is_same, std::uint16_t one,
                             std::uint16_t other) {
      if (!first_is_same) std::swap(one, other);
      return first_is_same != second_is_same && one > std::max(edge, other);
    };
    const int left = std::max(x - 1, 0);
    const int right = std::min(x + 1, width - 1);
    pixels[count] = x;
    count += is_past(labels.above[x] == label, labels.below[x] == label, edges.above[x], edges.below[x]) ||
                     is_past(labels.here[left] == label, labels.here[right] == label, edges.here[left],
                             edges.here[right])
                 ? 1
                 : 0;
  }
  return count;
}

inline int past_crest(const ThreeRows<RegionId>& labels, const ThreeRows<std::uint16_t>& edges, int width,
                      std::int32_t* pixels) {
  return past_crest_from(0, width, 0, labels, edges, width, pixels);
}

/// touches_right() for the pixels first … last − 1 and their left neighbours, after `count` pairs. A
/// vertical or diagonal border is reported in its first row only.
inline int touches_right_in(int first, int last, int count, const RegionId* above, const RegionId* row,
                            int width, LabelPairs pairs) {
  for (int x = first; x < last; ++x) {
    const RegionId p = row[x - 1];
    const RegionId q = row[x];
    const bool straight = (above[x - 1] == p) & (above[x] == q);
    const bool from_left = x > 1 && (above[x - 2] == p) & (above[x - 1] == q);
    const bool from_right = x + 1 < width && (above[x] == p) & (above[x + 1] == q);
    put_pair(pairs, count, p, q);
    count += static_cast<int>((p != q) & !(straight | from_left | from_right));
  }
  return count;
}

inline int touches_right(const RegionId* above, const RegionId* row, int width, LabelPairs pairs) {
  return touches_right_in(1, width, 0, above, row, width, pairs);
}

/// touches_below() for the pixels first … last − 1. If both labels are in an adjacent column, they are also
/// next to each other, or were reported there.
inline int touches_below_in(int first, int last, int count, const RegionId* above, const RegionId* row,
                            int width, LabelPairs pairs) {
  for (int x = first; x < last; ++x) {
    const RegionId p = above[x];
    const RegionId q = row[x];
    const bool left =
        x > 0 && (((above[x - 1] == p) & (row[x - 1] == q)) | (above[x - 1] == q) | (row[x - 1] == p));
    const bool right = x + 1 < width && (above[x + 1] == q) | (row[x + 1] == p);
    put_pair(pairs, count, p, q);
    count += static_cast<int>((p != q) & !(left | right));
  }
  return count;
}

inline int touches_below(const RegionId* above, const RegionId* row, int width, LabelPairs pairs) {
  return touches_below_in(0, width, 0, above, row, width, pairs);
}

/// sum_grey() for the pixels from `x` on.
inline void sum_grey_from(int x, const Gray* values, int width, std::uint64_t* up_to) {
  for (std::uint64_t sums = up_to[x]; x < width; ++x) {
    const std::uint64_t v = values[x];
    sums += (v << 40U) + v * v;
    up_to[x + 1] = sums;
  }
}

inline void sum_grey(const Gray* values, int width, std::uint64_t* up_to) {
  up_to[0] = 0;
  sum_grey_from(0, values, width, up_to);
}

/// sum_disparities() for the pixels from `x` on.
inline void sum_disparities_from(int x, const std::int16_t* values, const std::uint8_t* floor, int width,
                                 std::uint64_t* up_to, std::uint64_t* squares_up_to) {
  std::uint64_t sums = up_to[x];
  std::uint64_t squares = squares_up_to[x];
  for (; x < width; ++x) {
    const bool valid = values[x] != kHole16;
    const bool on_floor = floor != nullptr && floor[x] != 0;
    const std::int64_t v = valid ? values[x] : 0;
    sums += (static_cast<std::uint64_t>(v) << 32U) + (valid ? 1U << 16U : 0U) + (on_floor ? 1U : 0U);
    squares += static_cast<std::uint64_t>(v * v);
    up_to[x + 1] = sums;
    squares_up_to[x + 1] = squares;
  }
}

inline void sum_disparities(const std::int16_t* values, const std::uint8_t* floor, int width,
                            std::uint64_t* up_to, std::uint64_t* squares_up_to) {
  up_to[0] = 0;
  squares_up_to[0] = 0;
  sum_disparities_from(0, values, floor, width, up_to, squares_up_to);
}

/// sum_colours() for the pixels from `x` on.
inline void sum_colours_from(int x, const Rgb* colours, int width, std::uint64_t* up_to) {
  for (std::uint64_t sums = up_to[x]; x < width; ++x) {
    sums += colours[x].r + (std::uint64_t{colours[x].g} << 21U) + (std::uint64_t{colours[x].b} << 42U);
    up_to[x + 1] = sums;
  }
}

inline void sum_colours(const Rgb* colours, int width, std::uint64_t* up_to) {
  up_to[0] = 0;
  sum_colours_from(0, colours, width, up_to);
}

// Every value is written, and overwritten if it does not count: the pattern is irregular.

inline int keep_known(const float* row, const float* by, int first, int last, float* kept) {
  int found = 0;
  for (int x = first; x < last; ++x) {
    kept[found] = row[x];
    found += by[x] == by[x] ? 1 : 0;
  }
  return found;
}

inline std::size_t keep_bucket(const float* values, std::size_t count, const Buckets& buckets,
                               std::int32_t wanted, float* kept) {
  std::size_t found = 0;
  for (std::size_t i = 0; i < count; ++i) {
    kept[found] = values[i];
    found += buckets.bucket(values[i]) == wanted ? 1 : 0;
  }
  return found;
}

inline FloatRange find_range(const float* values, std::size_t count) {
  FloatRange range{values[0], values[0]};
  for (std::size_t i = 1; i < count; ++i)
    range = {std::min(range.least, values[i]), std::max(range.most, values[i])};
  return range;
}

inline void number_buckets(const float* values, std::size_t count, const Buckets& buckets,
                           std::int32_t* numbers) {
  for (std::size_t i = 0; i < count; ++i) numbers[i] = buckets.bucket(values[i]);
}

/// find_marked() from `i` on, after `count_found` indices.
inline std::size_t find_marked_from(std::size_t i, std::size_t count_found, const std::uint8_t* marks,
                                    std::size_t count, std::uint32_t* found) {
  for (; i < count; ++i) {
    found[count_found] = static_cast<std::uint32_t>(i);
    count_found += marks[i] != 0 ? 1 : 0;
  }
  return count_found;
}

inline std::size_t find_marked(const std::uint8_t* marks, std::size_t count, std::uint32_t* found) {
  return find_marked_from(0, 0, marks, count, found);
}

inline constexpr LabelKernels kLabelKernels{compare,         count_up,       find_runs,     differing,
                                            past_crest,      touches_right,  touches_below, sum_grey,
                                            sum_disparities, sum_colours,    keep_known,    find_range,
                                            keep_bucket,     number_buckets, find_marked};

}  // namespace cairn::kernels::plain_labels
