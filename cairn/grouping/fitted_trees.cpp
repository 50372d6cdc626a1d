// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <array>
#include <cairn/core/ids.hpp>
#include <cairn/grouping/fitted_trees.hpp>

namespace cairn {
namespace {

#include <cairn/grouping/fitted_same_thing.inc>
#include <cairn/grouping/fitted_whole_object.inc>

}  // namespace

float FittedTrees::operator()(std::span<const float> features) const {
  // A step down waits for the node that the step before led to, so several trees are walked at the same time.
  constexpr std::size_t kAtOnce = 8;
  float sum = base;
  for (std::size_t first = 0; first < roots.size(); first += kAtOnce) {
    const std::span<const std::int16_t> walked =
        roots.subspan(first, std::min(kAtOnce, roots.size() - first));
    std::array<const Node*, kAtOnce> at{};
    for (std::size_t i = 0; i < kAtOnce; ++i) at[i] = &nodes[slot(walked[std::min(i, walked.size() - 1)])];
    for (bool moves = true; moves;) {
      moves = false;
      for (const Node*& node : at) {
        if (node->feature < 0) continue;
        node = &nodes[slot(node->below + (features[slot(node->feature)] < node->value ? 0 : 1))];
        moves = true;
      }
    }
    for (std::size_t i = 0; i < walked.size(); ++i) sum += at[i]->value;
  }
  return sum;
}

constinit const FittedTrees kSameThing{kSameThingBase, kSameThingRoots, kSameThingNodes};
constinit const FittedTrees kWholeObject{kWholeObjectBase, kWholeObjectRoots, kWholeObjectNodes};

}  // namespace cairn
