// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/grouping/fitted_trees.hpp>
#include <cairn/grouping/region_features.hpp>
#include <functional>
#include <vector>

namespace cairn {

/// A superpixel, or two nodes that fused.
struct MergeNode {
  std::int32_t part_a = -1;  // the one that had more neighbours; −1: a superpixel
  std::int32_t part_b = -1;
  std::int32_t whole = -1;  // what it is a part of; −1 = nothing
  std::int64_t area = 0;    // px
  Origin origin{};
  ObjectFeatures features{};
};

/// All regions that superpixels fuse to, from the superpixels to the whole image. Every node stands behind
/// its parts; node i < superpixels is superpixel i.
struct MergeTree {
  int superpixels = 0;
  std::vector<MergeNode> nodes;
};

/// Told each pair of nodes that is judged, and by what: for fitting.
using JudgedPair = std::function<void(std::int32_t node_a, std::int32_t node_b, const MergeFeatures& by)>;

/// Greedy agglomeration: those two neighbours fuse next that are likeliest one thing, by `same_thing`, until
/// no neighbours are left. (Nunez-Iglesias et al. 2013, "Machine Learning of Hierarchical Clustering to
/// Segment 2D and 3D Images"; docs/stages/grouping.md, beyond the paper)
///
/// What is known of a fused region is the sum of what was known of its parts. The one that had more
/// neighbours (ties: the contact's a) takes over the other's contacts, and adds those with a neighbour of
/// both to its own. These are judged anew at once, and all of its contacts where the smaller part had more
/// than an eighth of the larger one's area; others when their turn comes, and wait on if they are not the
/// likeliest any more. Ties: the contact that the picture's rows show first.
MergeTree grow_merge_tree(const Superpixels& superpixels, const Cues& cues, const FittedTrees& same_thing,
                          const Exec& exec, const JudgedPair& told = {});

}  // namespace cairn
