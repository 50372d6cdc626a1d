// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <array>
#include <cairn/core/ids.hpp>
#include <cairn/fitted/fitted.hpp>
#include <cairn/regions/cue_kernels.hpp>
#include <cairn/regions/fitted_trees.hpp>
#include <utility>

namespace cairn {
namespace {

// A step down depends on the previous one, so several trees are walked concurrently.
constexpr std::size_t kAtOnce = 8;

std::size_t depth_below(std::span<const FittedTrees::Node> nodes, std::int16_t node) {
  const FittedTrees::Node& n = nodes[slot(node)];
  if (n.feature < 0) return 0;
  return 1 +
         std::max(depth_below(nodes, n.below), depth_below(nodes, static_cast<std::int16_t>(n.below + 1)));
}

}  // namespace

FittedTrees::FittedTrees(float base, std::span<const std::int16_t> roots, std::span<const Node> nodes)
    : base_(base), count_(roots.size()) {
  for (const std::int16_t root : roots) depth_ = std::max(depth_, depth_below(nodes, root));
  const std::size_t stored = (count_ + kAtOnce - 1) / kAtOnce * kAtOnce;
  splits_.resize(stored << depth_);
  leaves_.resize(stored << depth_);
  for (std::size_t tree = 0; tree < count_; ++tree) complete(nodes, roots[tree], tree, 1);
}

/// Stores the subtree below `node` at a place of a tree. A leaf that is not deep enough is repeated.
void FittedTrees::complete(std::span<const Node> nodes, std::int16_t node, std::size_t tree,
                           std::size_t place) {
  const Node& n = nodes[slot(node)];
  const std::size_t size = std::size_t{1} << depth_;
  if (place >= size) {
    leaves_[tree * size + place - size] = n.value;
    return;
  }
  const bool is_leaf = n.feature < 0;
  if (!is_leaf) splits_[tree * size + place] = {n.feature, n.value};
  complete(nodes, is_leaf ? node : n.below, tree, 2 * place);
  complete(nodes, is_leaf ? node : static_cast<std::int16_t>(n.below + 1), tree, 2 * place + 1);
}

float FittedTrees::operator()(std::span<const float> features) const {
  const std::size_t size = std::size_t{1} << depth_;
  float sum = base_;
  for (std::size_t first = 0; first < count_; first += kAtOnce) {
    const Split* const splits = splits_.data() + first * size;
    std::array<std::size_t, kAtOnce> at{};
    at.fill(1);
    const auto step_down = [&]<std::size_t... i>(std::index_sequence<i...>) {
      const auto below = [&](const Split& split, std::size_t place) {
        return 2 * place + (features[slot(split.feature)] < split.value ? 0 : 1);
      };
      ((at[i] = below(splits[i * size + at[i]], at[i])), ...);
    };
    for (std::size_t depth = 0; depth < depth_; ++depth) step_down(std::make_index_sequence<kAtOnce>());
    for (std::size_t i = 0; i < std::min(kAtOnce, count_ - first); ++i)
      sum += leaves_[(first + i - 1) * size + at[i]];
  }
  return sum;
}

std::vector<float> FittedTrees::operator()(std::span<const std::span<const float>> samples,
                                           const Exec& exec) const {
  constexpr std::size_t kLanes = kernels::kTreeLanes;
  std::vector<float> sums(samples.size(), base_);
  std::size_t first = 0;
  if (depth_ > 0 && depth_ <= kernels::kDeepestTree) {
    const kernels::CueKernels& run = kernels::cue_kernels(exec);
    const std::size_t features = samples.empty() ? 0 : samples.front().size();
    std::vector<float> of_feature(features * kLanes);
    for (; first + kLanes <= samples.size(); first += kLanes) {
      for (std::size_t i = 0; i < features; ++i) {
        for (std::size_t lane = 0; lane < kLanes; ++lane)
          of_feature[i * kLanes + lane] = samples[first + lane][i];
      }
      run.sum_trees(splits_.data(), leaves_.data(), depth_, count_, of_feature.data(), sums.data() + first);
    }
  }
  for (; first < samples.size(); ++first) sums[first] = (*this)(samples[first]);
  return sums;
}

FittedTrees load_trees(std::span<const std::byte> file) {
  fitted::Reader reader(file, "tree");
  const float base = reader.next<float>().front();
  const auto roots = reader.next<std::int16_t>();
  return {base, roots, reader.next<FittedTrees::Node>()};
}

const FittedTrees& merge_classifier() {
  static const FittedTrees trees = load_trees(fitted::same_thing());
  return trees;
}

const FittedTrees& object_classifier() {
  static const FittedTrees trees = load_trees(fitted::whole_object());
  return trees;
}

}  // namespace cairn
