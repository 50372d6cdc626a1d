// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/regions/fitted_trees.hpp>
#include <cairn/regions/region_features.hpp>
#include <functional>
#include <vector>

namespace cairn {

/// A superpixel, or the union of two nodes.
struct MergeNode {
  std::int32_t part_a = -1;  // the part with more neighbours; −1: a superpixel
  std::int32_t part_b = -1;
  std::int32_t whole = -1;  // the parent; −1 = root
  std::int64_t area = 0;    // px
  Origin origin{};
  ObjectFeatures features{};
};

/// The hierarchy of merged superpixels, from single superpixels to the whole image. A node follows its parts;
/// node i < superpixels is superpixel i.
struct MergeTree {
  int superpixels = 0;
  std::vector<MergeNode> nodes;
  RegionGraphCues superpixel_cues{};  // gather_cues(): of the superpixels and of their contacts
};

/// Called for each pair of nodes evaluated, with its features: for fitting.
using JudgedPair = std::function<void(std::int32_t node_a, std::int32_t node_b, const MergeFeatures& by)>;

/// Greedy agglomeration: the pair of neighbours most likely to belong to one object, by `same_thing`, is
/// merged next, until no neighbours are left. (Nunez-Iglesias et al. 2013, "Machine Learning of Hierarchical
/// Clustering to Segment 2D and 3D Images"; docs/stages/grouping.md, beyond the paper)
///
/// The statistics of a merged region are the sums of those of its parts. The part with more neighbours (ties:
/// a of the contact) inherits the contacts of the other; contacts with a common neighbour are added. These
/// are re-evaluated at once, and all of its contacts if the smaller part had more than an eighth of the area
/// of the larger; others are re-evaluated when their turn comes, and are queued again if they are not the
/// likeliest any more. Ties: the contact that occurs first in raster order.
MergeTree grow_merge_tree(const Superpixels& superpixels, const Cues& cues, const FittedTrees& same_thing,
                          const Exec& exec, const JudgedPair& on_judged = {});

}  // namespace cairn
