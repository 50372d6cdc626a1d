// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/sequence/repair.hpp>

#include <algorithm>

namespace cairn {
namespace {

// IoU of a region with a track below which it does not fit, and above which it fits fully.
constexpr float kNoFit = 0.3F;
constexpr float kWholeFit = 0.8F;

/// For each node and track: number of pixels of the node where the track is predicted.
std::vector<std::int32_t> expected_in(const MergeTree& tree, const Superpixels& superpixels,
                                      const MaskPrediction& warped, std::size_t tracks,
                                      const std::vector<TrackId>& ids) {
  std::vector<std::int32_t> expected(tree.nodes.size() * tracks);
  TrackId last = TrackId::none;
  std::size_t t = 0;
  for (int y = 0; y < warped.ids.height(); ++y) {
    for (int x = 0; x < warped.ids.width(); ++x) {
      const TrackId id = warped.ids(x, y);
      if (id == TrackId::none) continue;
      if (id != last) t = static_cast<std::size_t>(std::ranges::lower_bound(ids, last = id) - ids.begin());
      ++expected[index(superpixels.labels(x, y)) * tracks + t];
    }
  }
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    const MergeNode& node = tree.nodes[i];
    if (node.part_a < 0) continue;
    for (std::size_t k = 0; k < tracks; ++k) {
      expected[i * tracks + k] =
          expected[slot(node.part_a) * tracks + k] + expected[slot(node.part_b) * tracks + k];
    }
  }
  return expected;
}

}  // namespace

std::vector<float> repaired_scores(const MergeTree& tree, std::vector<float> scores,
                                   const Superpixels& superpixels, const MaskPrediction& warped,
                                   const Tracks& tracks, const RepairConfig& config) {
  const std::size_t count = tracks.list.size();
  if (config.method == RepairMethod::off || count == 0) return scores;
  std::vector<TrackId> ids;
  for (const Track& track : tracks.list) ids.push_back(track.id);
  const std::vector<std::int32_t> expected = expected_in(tree, superpixels, warped, count, ids);
  std::vector<std::int32_t> predicted(count);
  for (std::size_t i = 0; i < slot(tree.superpixels); ++i) {
    for (std::size_t t = 0; t < count; ++t) predicted[t] += expected[i * count + t];
  }
  for (std::size_t i = 0; i < scores.size(); ++i) {
    if (scores[i] == 0) continue;  // too small
    const auto area = static_cast<float>(tree.nodes[i].area);
    float touched = 0;
    float best_iou = 0;
    std::size_t best = 0;
    for (std::size_t t = 0; t < count; ++t) {
      const auto common = static_cast<float>(expected[i * count + t]);
      if (common == 0) continue;
      touched += common / area * tracks.list[t].confidence;
      const float iou = common / (area + static_cast<float>(predicted[t]) - common);
      if (iou > best_iou) {
        best_iou = iou;
        best = t;
      }
    }
    if (touched == 0) continue;
    const float said = config.weight * std::min(touched, 1.0F);
    const float fit = std::clamp((best_iou - kNoFit) / (kWholeFit - kNoFit), 0.0F, 1.0F);
    scores[i] = (1 - said) * scores[i] + said * tracks.list[best].confidence * fit;
  }
  return scores;
}

ChosenObjects choose_candidates(const MergeTree& tree, const std::vector<float>& scores,
                                const ChoiceLimits& limits, float low_confidence) {
  ChosenObjects chosen = choose_by_scores(tree, scores, limits);
  if (low_confidence >= limits.min_score) return chosen;
  // Exclude regions that overlap an object.
  std::vector<float> left = scores;
  std::vector<bool> is_taken(tree.nodes.size());
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    const MergeNode& node = tree.nodes[i];
    is_taken[i] = node.part_a < 0 ? chosen.object_of[i] > 0
                                  : is_taken[slot(node.part_a)] || is_taken[slot(node.part_b)];
    if (is_taken[i]) left[i] = 0;
  }
  const ChosenObjects weak = choose_by_scores(tree, std::move(left), {low_confidence, limits.min_area});
  const auto first = static_cast<std::int32_t>(chosen.scores.size()) - 1;
  for (std::size_t i = 0; i < chosen.object_of.size(); ++i) {
    if (weak.object_of[i] > 0) chosen.object_of[i] = first + weak.object_of[i];
  }
  chosen.scores.insert(chosen.scores.end(), weak.scores.begin() + 1, weak.scores.end());
  return chosen;
}

}  // namespace cairn
