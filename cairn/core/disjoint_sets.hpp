// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <algorithm>
#include <cairn/core/scratch.hpp>
#include <cstddef>
#include <cstdint>
#include <numeric>

namespace cairn {

/// A union-find forest over the numbers 0 … count − 1: each tree is a set, represented by its root. Initially
/// each number is a set of its own.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count, const Pool& pool = {}) : parents_(count, pool) {
    std::iota(parents_.begin(), parents_.end(), 0);
  }

  [[nodiscard]] std::size_t size() const { return parents_.size(); }
  [[nodiscard]] bool is_root(std::int32_t i) const { return parents_[i] == i; }
  /// The root of i's set; halves the path to it.
  std::int32_t root(std::int32_t i) {
    std::int32_t* const parents = parents_.data();
    while (parents[i] != i) {
      parents[i] = parents[parents[i]];
      i = parents[i];
    }
    return i;
  }
  /// Merges two sets; the smaller root becomes the root of both. If only unite() is used, the root of a set
  /// is its smallest number.
  void unite(std::int32_t a, std::int32_t b) {
    a = root(a);
    b = root(b);
    parents_[std::max(a, b)] = std::min(a, b);
  }
  /// Makes a root, with all below it, a child of another element.
  void hang(std::int32_t root, std::int32_t under) { parents_[root] = under; }
  /// Numbers the sets in order of their roots: numbers[i] = the set of element i. Requires every root to be
  /// the smallest number of its set. Returns the number of sets.
  std::int32_t number(std::int32_t* numbers) const {
    std::int32_t count = 0;
    // A parent is smaller than its children and is numbered before them.
    for (std::ptrdiff_t i = 0; i < static_cast<std::ptrdiff_t>(parents_.size()); ++i)
      numbers[i] = parents_[i] == i ? count++ : numbers[parents_[i]];
    return count;
  }

 private:
  Scratch<std::int32_t> parents_;
};

}  // namespace cairn
