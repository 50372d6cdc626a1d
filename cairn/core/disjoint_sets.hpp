// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <algorithm>
#include <cairn/core/scratch.hpp>
#include <cstddef>
#include <cstdint>
#include <numeric>

namespace cairn {

/// A forest over the numbers 0 … count − 1: each tree is a set, and its root stands for it. At first each
/// number is a set of its own.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count, const Pool& pool = {}) : parents_(count, pool) {
    std::iota(parents_.begin(), parents_.end(), 0);
  }

  [[nodiscard]] std::size_t size() const { return parents_.size(); }
  [[nodiscard]] bool is_root(std::int32_t i) const { return parents_[i] == i; }
  /// The root of i's set; the way to it gets shorter.
  std::int32_t root(std::int32_t i) {
    std::int32_t* const parents = parents_.data();
    while (parents[i] != i) {
      parents[i] = parents[parents[i]];
      i = parents[i];
    }
    return i;
  }
  /// The smaller of the two roots becomes that of both. Used alone, this makes every set's smallest number
  /// its root.
  void unite(std::int32_t a, std::int32_t b) {
    a = root(a);
    b = root(b);
    parents_[std::max(a, b)] = std::min(a, b);
  }
  /// Hangs a root and all below it under another.
  void hang(std::int32_t root, std::int32_t under) { parents_[root] = under; }
  /// Where the smallest numbers are the roots: numbers the sets in the order of these, each element's set in
  /// numbers[i]. Returns how many sets there are.
  std::int32_t number(std::int32_t* numbers) const {
    std::int32_t count = 0;
    // A parent is smaller than its children and has its number already.
    for (std::ptrdiff_t i = 0; i < static_cast<std::ptrdiff_t>(parents_.size()); ++i)
      numbers[i] = parents_[i] == i ? count++ : numbers[parents_[i]];
    return count;
  }

 private:
  Scratch<std::int32_t> parents_;
};

}  // namespace cairn
