// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/ids.hpp>
#include <cstdint>
#include <span>

namespace cairn {

/// A sum of small decision trees, fitted by gradient boosting (Friedman 2001): what stands in the leaves that
/// a case comes to is added up. Its numbers were fitted by fitting/fit.py; comparisons and one sum in a fixed
/// order give the same bits everywhere.
struct FittedTrees {
  struct Node {
    std::int16_t feature;  // −1 = a leaf
    std::int16_t below;    // the node to go to where the feature is less than `value`; else the one after it
    float value;           // of a leaf: what it adds
  };
  float base = 0;
  std::span<const std::int16_t> roots;
  std::span<const Node> nodes;

  /// The logarithm of the odds.
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

/// The logarithm of the odds that two neighbouring regions show one thing: of merge_features().
extern const FittedTrees kSameThing;
/// … that a region is a whole object and not more: of object_features().
extern const FittedTrees kWholeObject;

}  // namespace cairn
