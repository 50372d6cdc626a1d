// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/regions/merge_tree.hpp>
#include <cairn/stereo/disparity_map.hpp>
#include <vector>

namespace cairn {

/// The limits of an object.
struct ChoiceLimits {
  float min_score = 0;        // 0 … 1: smallest probability
  std::int64_t min_area = 0;  // px
};

/// Regions chosen as objects; no two share a superpixel.
struct ChosenObjects {
  std::vector<std::int32_t> object_of;  // per superpixel: its object, 1 … scores.size()−1; 0 = none
  std::vector<float> scores;            // probability of each object, 0 … 1; scores[0] = 0
  std::vector<float> likeliest{};       // per superpixel: the highest probability of a region with it
};

/// Chooses the non-overlapping nodes of the tree with the greatest sum of scores above min_score, each node
/// scored by `whole_object` of its features: a node is chosen if it gains at least as much as the best choice
/// among its parts. Exact, in one pass from the superpixels up. Objects are numbered from the last node down.
/// (docs/stages/grouping.md, beyond the paper)
ChosenObjects choose_objects(const MergeTree& tree, const FittedTrees& whole_object,
                             const ChoiceLimits& limits, const Exec& exec = {});

/// The first step of choose_objects(), for callers with more knowledge of the regions: the probability of
/// each node to be a whole object, 0 … 1; 0 below min_area.
std::vector<float> score_nodes(const MergeTree& tree, const FittedTrees& whole_object,
                               const ChoiceLimits& limits, const Exec& exec = {});
/// The second step: the choice by these scores.
ChosenObjects choose_by_scores(const MergeTree& tree, std::vector<float> scores, const ChoiceLimits& limits);

/// The objects as regions 1, 2 … with the statistics of their disparities, in px; region 0 is the rest
/// (is_background).
Segmentation object_regions(const Superpixels& superpixels, const ChosenObjects& chosen,
                            const DisparityMap& disparity, const Exec& exec);

}  // namespace cairn
