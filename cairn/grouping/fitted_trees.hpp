// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

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

  /// The log-odds. Precondition: `features` has each feature that a node names.
  [[nodiscard]] float operator()(std::span<const float> features) const;
};

/// The log-odds that two neighbouring regions belong to one object, from merge_features().
extern const FittedTrees kSameThing;
/// The log-odds that a region is exactly one whole object, from object_features().
extern const FittedTrees kWholeObject;

}  // namespace cairn
