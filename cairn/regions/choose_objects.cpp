// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/core/statistics.hpp>
#include <cairn/regions/choose_objects.hpp>
#include <cairn/regions/superpixel_regions.hpp>
#include <cmath>

namespace cairn {
ChosenObjects choose_objects(const MergeTree& tree, const FittedTrees& whole_object,
                             const ChoiceLimits& limits, const Exec& exec) {
  return choose_by_scores(tree, score_nodes(tree, whole_object, limits, exec), limits);
}

std::vector<float> score_nodes(const MergeTree& tree, const FittedTrees& whole_object,
                               const ChoiceLimits& limits, const Exec& exec) {
  std::vector<std::size_t> scored;
  std::vector<std::span<const float>> features;
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    if (tree.nodes[i].area < limits.min_area) continue;
    scored.push_back(i);
    features.emplace_back(tree.nodes[i].features);
  }
  const std::vector<float> log_odds = whole_object(features, exec);
  std::vector<float> scores(tree.nodes.size());
  for (std::size_t i = 0; i < scored.size(); ++i) scores[scored[i]] = likelihood(log_odds[i]);
  return scores;
}

ChosenObjects choose_by_scores(const MergeTree& tree, std::vector<float> scores, const ChoiceLimits& limits) {
  const std::size_t count = tree.nodes.size();
  std::vector<double> best(count);     // gain over min_score of the best choice at or below each node
  std::vector<bool> is_chosen(count);  // whether that choice is the node itself
  for (std::size_t i = 0; i < count; ++i) {
    const MergeNode& node = tree.nodes[i];
    if (node.part_a >= 0) best[i] = best[slot(node.part_a)] + best[slot(node.part_b)];
    if (node.area < limits.min_area) continue;
    const double gain = double{scores[i]} - limits.min_score;
    is_chosen[i] = gain > 0 && gain >= best[i];
    if (is_chosen[i]) best[i] = gain;
  }
  ChosenObjects chosen{{}, {0.0F}, {}};
  std::vector<std::int32_t> object(count, 0);
  for (std::size_t i = count; i-- > 0;) {
    const std::int32_t whole = tree.nodes[i].whole;
    if (whole >= 0) object[i] = object[slot(whole)];
    if (object[i] > 0 || !is_chosen[i]) continue;
    object[i] = static_cast<std::int32_t>(chosen.scores.size());
    chosen.scores.push_back(scores[i]);
  }
  chosen.object_of.assign(object.begin(), object.begin() + tree.superpixels);
  // From the root down: a region is at least as likely as the regions that contain it.
  for (std::size_t i = count; i-- > 0;) {
    const std::int32_t whole = tree.nodes[i].whole;
    if (whole >= 0) scores[i] = std::max(scores[i], scores[slot(whole)]);
  }
  chosen.likeliest.assign(scores.begin(), scores.begin() + tree.superpixels);
  return chosen;
}

Segmentation object_regions(const Superpixels& superpixels, const ChosenObjects& chosen,
                            const DisparityMap& disparity, const Exec& exec) {
  Image<RegionId> labels(superpixels.labels.size(), exec.pool);
  for (int y = 0; y < labels.height(); ++y) {
    const RegionId* const superpixel = superpixels.labels.row(y);
    std::transform(superpixel, superpixel + labels.width(), labels.row(y),
                   [&](RegionId i) { return RegionId{chosen.object_of[index(i)]}; });
  }
  Segmentation groups =
      superpixel_regions(std::move(labels), chosen.scores.size(), exec, [&](const Run& run, Region& region) {
        const float* const disparity_px = disparity.disparity_px.row(run.y);
        int count = region.valid_count;
        double sum = region.mean;
        double squares = region.variance;
        for (int x = run.first; x < run.last; ++x) {
          const bool is_known = disparity_px[x] == disparity_px[x];
          const double d =
              is_known ? double{disparity_px[x]} : 0;  // adding 0 changes no sum, and needs no branch
          count += is_known ? 1 : 0;
          sum += d;
          squares += d * d;
        }
        region.valid_count = count;
        region.mean = sum;
        region.variance = squares;
      });
  groups.regions.front().is_background = true;
  return groups;
}

}  // namespace cairn
