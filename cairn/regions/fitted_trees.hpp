// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace cairn {

/// A sum of small decision trees, fitted by gradient boosting (Friedman 2001): the output is the sum of the
/// leaves that a sample reaches. The numbers were fitted by lab/fit.py; comparisons and one sum in a
/// fixed order give the same bits on every platform.
class FittedTrees {
 public:
  struct Node {
    std::int16_t feature;  // −1 = a leaf
    std::int16_t below;    // child for feature < `value`; the other child is the next node
    float value;           // threshold; the output of a leaf
  };

  FittedTrees() = default;
  /// Memory grows with 2 to the power of the depth of the deepest tree. Precondition: roots and children are
  /// indices into `nodes`, and no node is below itself.
  FittedTrees(float base, std::span<const std::int16_t> roots, std::span<const Node> nodes);

  /// The sum, e.g. log-odds. Precondition: `features` contains every feature used by a node.
  [[nodiscard]] float operator()(std::span<const float> features) const;
  /// The same for many samples of one size, several times as fast.
  [[nodiscard]] std::vector<float> operator()(std::span<const std::span<const float>> samples,
                                              const Exec& exec) const;

  struct Split {
    std::int32_t feature = 0;
    float value = 0;
  };

 private:
  void complete(std::span<const Node> nodes, std::int16_t node, std::size_t tree, std::size_t place);

  float base_ = 0;
  std::size_t depth_ = 0;
  std::size_t count_ = 0;
  // Every tree is stored as a complete one of the same depth, so that a step down needs no branch. Its root is at
  // place 1, the children of place i are at 2i and 2i + 1, and its leaves follow its splits: 2^depth of each.
  std::vector<Split> splits_;
  std::vector<float> leaves_;
};

/// The trees of a file of lab/fitted_files.py, see cairn/fitted. Throws Error for another kind of file.
FittedTrees load_trees(std::span<const std::byte> file);

/// The log-odds that two neighbouring regions belong to one object, from merge_features().
const FittedTrees& merge_classifier();
/// The log-odds that a region is exactly one whole object, from object_features().
const FittedTrees& object_classifier();

}  // namespace cairn
