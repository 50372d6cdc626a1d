// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <algorithm>
#include <array>
#include <cairn/regions/label_kernels.hpp>

namespace cairn::kernels::plain_labels {

/// counts[byte][i]: how many of the bits 0 … i of the byte are set.
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

// The loops below have no branch that depends on a label: no processor can foretell where labels change.

/// find_runs() from pixel `x` on, `runs` of them found already.
inline int find_runs_from(int x, int runs, const RegionId* label, int width, std::int32_t* ends) {
  for (; x + 1 < width; ++x) {
    ends[runs] = x + 1;
    runs += label[x] != label[x + 1] ? 1 : 0;
  }
  ends[runs] = width;
  return runs + 1;
}

inline int find_runs(const RegionId* label, int width, std::int32_t* ends) {
  return find_runs_from(0, 0, label, width, ends);
}

/// touches_below() from pixel `x` ≥ 1 on, `count` pairs found already.
inline int touches_below_from(int x, int count, const RegionId* row, const RegionId* below, int width,
                              LabelPairs pairs) {
  for (; x < width; ++x) {
    pairs.a[count] = std::min(number(row[x]), number(below[x]));
    pairs.b[count] = std::max(number(row[x]), number(below[x]));
    count += static_cast<int>((row[x] != below[x]) & ((row[x - 1] != row[x]) | (below[x - 1] != below[x])));
  }
  return count;
}

/// The first column has none before it.
inline int touches_in_first_column(const RegionId* row, const RegionId* below, LabelPairs pairs) {
  pairs.a[0] = std::min(number(row[0]), number(below[0]));
  pairs.b[0] = std::max(number(row[0]), number(below[0]));
  return row[0] != below[0] ? 1 : 0;
}

inline int touches_below(const RegionId* row, const RegionId* below, int width, LabelPairs pairs) {
  return touches_below_from(1, touches_in_first_column(row, below, pairs), row, below, width, pairs);
}

inline constexpr LabelKernels kLabelKernels{compare, count_up, find_runs, touches_below};

}  // namespace cairn::kernels::plain_labels
