// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/ids.hpp>
#include <cstdint>
#include <span>

namespace cairn {

/// A sum of small decision trees, fitted by gradient boosting (Friedman 2001): the output is the sum of the
/// leaves that a sample reaches. The numbers were fitted by fitting/fit.py; comparisons and one sum in a
/// fixed order give the same bits on every platform.
struct FittedTrees {
  struct Node {
    std::int16_t feature;  // −1 = a leaf
    std::int16_t below;    // child for feature < `value`; the other child is the next node
    float value;           // threshold; the output of a leaf
  };
  float base = 0;
  std::span<const std::int16_t> roots;
  std::span<const Node> nodes;

  /// The log-odds.
  [[nodiscard]] float operator()(std::span<const float> features) const {
    float sum = base;
    for (const std::int16_t root : roots) {
      const Node* node = &nodes[slot(root)];
      while (node->feature >= 0)
        node = &nodes[slot(node->below + (features[slot(node->feature)] < node->value ? 0 : 1))];
      sum += node->value;
    }
    return sum;
  }
};

/// The log-odds that two neighbouring regions belong to one object, from merge_features().
extern const FittedTrees kSameThing;
/// The log-odds that a region is exactly one whole object, from object_features().
extern const FittedTrees kWholeObject;

}  // namespace cairn
