// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/disparity/disparity_map.hpp>
#include <cairn/grouping/merge_tree.hpp>
#include <vector>

namespace cairn {

/// What must be true of an object.
struct ChoiceLimits {
  float min_score = 0;        // 0 … 1: how likely it is one
  std::int64_t min_area = 0;  // px
};

/// Regions that are objects, no two of them sharing a superpixel.
struct ChosenObjects {
  std::vector<std::int32_t> object_of;  // per superpixel: its object, 1 … scores.size()−1; 0 = none
  std::vector<float> scores;            // how likely each of these is one, 0 … 1; scores[0] = 0
  std::vector<float> likeliest{};  // per superpixel: how likely the likeliest region that holds it is one
};

/// Of all nodes of the tree those whose scores together exceed min_score by most, each scored by
/// `whole_object` of its features: a node is taken where it gains at least as much as the best choice among
/// its parts. Exact, in one pass from the superpixels up. Objects are numbered from the last node down.
/// (docs/stages/grouping.md, beyond the paper)
ChosenObjects choose_objects(const MergeTree& tree, const FittedTrees& whole_object,
                             const ChoiceLimits& limits);

/// Its two halves, for who knows more of the regions than their features. First: how likely each node of the
/// tree is a whole object, 0 … 1; 0 where it is smaller than min_area.
std::vector<float> score_nodes(const MergeTree& tree, const FittedTrees& whole_object,
                               const ChoiceLimits& limits);
/// Second: the choice itself, by these scores.
ChosenObjects choose_by_scores(const MergeTree& tree, std::vector<float> scores, const ChoiceLimits& limits);

/// The objects as regions 1, 2 … with the statistics of their disparities, in px; region 0 is all else
/// (is_background).
Segmentation groups_of(const Superpixels& superpixels, const ChosenObjects& chosen,
                       const DisparityMap& disparity, const Exec& exec);

}  // namespace cairn
