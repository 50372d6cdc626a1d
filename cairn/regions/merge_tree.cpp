// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/regions/merge_tree.hpp>
#include <numeric>
#include <queue>
#include <span>
#include <utility>

namespace cairn {
namespace {

constexpr float kOneSuperpixel = 20.0F;  // the log-odds given to a superpixel, which has no parts
constexpr int kMuch = 8;                 // a part of less than 1/8 of the other's area changes little

class TreeGrower {
 public:
  TreeGrower(const Superpixels& superpixels, const Cues& cues, const FittedTrees& same_thing,
             const Exec& exec, const JudgedPair& on_judged)
      : graph_(gather_cues(superpixels, cues, exec)),
        frame_(frame_cues(graph_, cues)),
        same_thing_(same_thing),
        on_judged_(on_judged),
        fits_(graph_.regions.size()),
        nodes_(graph_.regions.size()),
        contacts_of_(graph_.regions.size()),
        common_(graph_.regions.size(), -1),
        fusions_(graph_.regions.size(), 0),
        first_(graph_.contacts.size()),
        judged_(graph_.contacts.size()) {
    std::iota(first_.begin(), first_.end(), 0);
    tree_.superpixels = superpixels.count;
    tree_.superpixel_cues = graph_;
    tree_.nodes.reserve(2 * graph_.regions.size());
    tree_.nodes.resize(graph_.regions.size());
    for (std::size_t i = 0; i < graph_.contacts.size(); ++i) {
      contacts_of_[slot(graph_.contacts[i].a)].push_back(static_cast<std::int32_t>(i));
      contacts_of_[slot(graph_.contacts[i].b)].push_back(static_cast<std::int32_t>(i));
    }
    for (std::size_t r = 0; r < graph_.regions.size(); ++r) {
      nodes_[r] = static_cast<std::int32_t>(r);
      fit(r);
    }
    queue_all(exec);
    for (std::size_t r = 0; r < graph_.regions.size(); ++r) describe(r, {kOneSuperpixel, kOneSuperpixel, 1});
  }

  MergeTree run() {
    while (!queue_.empty()) {
      const Entry next = queue_.top();
      queue_.pop();
      if (judged_[slot(next.contact)].version != next.version) continue;
      if (fusions_at(next.contact) == next.fusions) {
        fuse(next.contact);
      } else {
        queue(next.contact);
      }
    }
    return std::move(tree_);
  }

 private:
  struct PairScore {
    float score = 0;
    std::int32_t version = 0;  // −1: the contact no longer exists
  };
  struct Entry {
    float score;
    std::int32_t first;
    std::int32_t contact;
    std::int32_t version;
    std::int64_t fusions;                       // of its two ends at the time of the judgement
    bool operator<(const Entry& other) const {  // the greatest is at the top of the queue
      return score < other.score || (score == other.score && first > other.first);
    }
  };

  [[nodiscard]] RegionSide side(std::int32_t region) const {
    return {graph_.regions[slot(region)], fits_[slot(region)]};
  }
  [[nodiscard]] std::int32_t other_end(std::int32_t contact, std::int32_t region) const {
    const ContactCues& c = graph_.contacts[slot(contact)];
    return c.a == region ? c.b : c.a;
  }
  [[nodiscard]] std::int64_t fusions_at(std::int32_t contact) const {
    const ContactCues& c = graph_.contacts[slot(contact)];
    return fusions_[slot(c.a)] + fusions_[slot(c.b)];
  }

  void fit(std::size_t region) { fits_[region] = fit_region(graph_.regions[region], frame_); }

  [[nodiscard]] MergeFeatures features_of(std::int32_t contact) const {
    const ContactCues& c = graph_.contacts[slot(contact)];
    const MergeFeatures features = merge_features(side(c.a), side(c.b), c, frame_);
    if (on_judged_) on_judged_(nodes_[slot(c.a)], nodes_[slot(c.b)], features);
    return features;
  }
  [[nodiscard]] Entry judged(std::int32_t contact, float score) {
    PairScore& judged = judged_[slot(contact)];
    judged.score = score;
    return {score, first_[slot(contact)], contact, judged.version, fusions_at(contact)};
  }
  void queue(std::int32_t contact) { queue_.push(judged(contact, same_thing_(features_of(contact)))); }
  void queue_all(const Exec& exec) {
    constexpr std::size_t kAtOnce = 64;  // features that stay in the cache
    std::vector<Entry> all;
    std::vector<MergeFeatures> features;
    features.reserve(kAtOnce);
    for (std::size_t first = 0; first < graph_.contacts.size(); first += kAtOnce) {
      features.clear();
      for (std::size_t i = first; i < std::min(first + kAtOnce, graph_.contacts.size()); ++i)
        features.push_back(features_of(static_cast<std::int32_t>(i)));
      const std::vector<std::span<const float>> samples(features.begin(), features.end());
      for (const float score : same_thing_(samples, exec))
        all.push_back(judged(static_cast<std::int32_t>(all.size()), score));
    }
    queue_ = std::priority_queue<Entry>({}, std::move(all));
  }

  void describe(std::size_t region, const Origin& origin) {
    neighbours_.clear();
    for (const std::int32_t i : contacts_of_[region]) {
      if (judged_[slot(i)].version < 0) continue;
      const ContactCues& c = graph_.contacts[slot(i)];
      const bool turned = slot(c.b) == region;
      neighbours_.push_back({side(turned ? c.a : c.b), c, turned, judged_[slot(i)].score});
    }
    MergeNode& node = tree_.nodes[slot(nodes_[region])];
    node.area = graph_.regions[region].area;
    node.origin = origin;
    node.features = object_features(side(static_cast<std::int32_t>(region)), neighbours_, origin, frame_);
  }

  void forget_gone(std::vector<std::int32_t>& contacts) const {
    std::erase_if(contacts, [&](std::int32_t i) { return judged_[slot(i)].version < 0; });
  }

  /// Moves the contacts of `lost` to `kept`. Returns the contacts that changed.
  std::vector<std::int32_t> hand_over(std::int32_t kept, std::int32_t lost) {
    std::vector<std::int32_t>& contacts = contacts_of_[slot(kept)];
    for (const std::int32_t i : contacts) common_[slot(other_end(i, kept))] = i;
    std::vector<std::int32_t> changed;
    for (const std::int32_t i : contacts_of_[slot(lost)]) {
      ContactCues& contact = graph_.contacts[slot(i)];
      const bool first = contact.a == lost;
      const std::int32_t known = common_[slot(first ? contact.b : contact.a)];
      if (known >= 0) {
        ContactCues& both = graph_.contacts[slot(known)];
        both.add(contact, (both.a == kept) != first);
        judged_[slot(i)].version = -1;
        first_[slot(known)] = std::min(first_[slot(known)], first_[slot(i)]);
        changed.push_back(known);
      } else {
        (first ? contact.a : contact.b) = kept;
        contacts.push_back(i);
        changed.push_back(i);
      }
    }
    contacts_of_[slot(lost)] = {};
    for (const std::int32_t i : contacts) common_[slot(other_end(i, kept))] = -1;
    return changed;
  }

  void fuse(std::int32_t across) {
    const float score = judged_[slot(across)].score;
    std::int32_t kept = graph_.contacts[slot(across)].a;
    std::int32_t lost = graph_.contacts[slot(across)].b;
    judged_[slot(across)].version = -1;
    forget_gone(contacts_of_[slot(kept)]);
    forget_gone(contacts_of_[slot(lost)]);
    if (contacts_of_[slot(kept)].size() < contacts_of_[slot(lost)].size()) std::swap(kept, lost);
    RegionCues& region = graph_.regions[slot(kept)];
    const auto [small, large] = std::minmax(region.area, graph_.regions[slot(lost)].area);
    const bool much = small * kMuch > large;
    const Origin origin = fused_node(kept, lost, score);
    region.add(graph_.regions[slot(lost)], graph_.contacts[slot(across)].length);
    ++fusions_[slot(kept)];
    fit(slot(kept));
    const std::vector<std::int32_t> changed = hand_over(kept, lost);
    for (const std::int32_t i : much ? contacts_of_[slot(kept)] : changed) {
      ++judged_[slot(i)].version;
      queue(i);
    }
    describe(slot(kept), origin);
  }

  /// Creates the node that unites the nodes of the two regions; it becomes the node of `kept`.
  Origin fused_node(std::int32_t kept, std::int32_t lost, float score) {
    const auto node = static_cast<std::int32_t>(tree_.nodes.size());
    const std::array parts{nodes_[slot(kept)], nodes_[slot(lost)]};
    const std::int64_t area = tree_.nodes[slot(parts[0])].area + tree_.nodes[slot(parts[1])].area;
    Origin origin{.same_thing = score, .least_same_thing = score};
    for (const std::int32_t i : parts) {
      MergeNode& part = tree_.nodes[slot(i)];
      part.whole = node;
      const float share = static_cast<float>(part.area) / static_cast<float>(area);
      report_end(part.features, share, score);
      origin.least_same_thing = std::min(origin.least_same_thing, part.origin.least_same_thing);
      origin.larger_part = i == parts[0] ? share : std::max(origin.larger_part, share);
    }
    MergeNode& fused = tree_.nodes.emplace_back();
    fused.part_a = parts[0];
    fused.part_b = parts[1];
    nodes_[slot(kept)] = node;
    return origin;
  }

  RegionGraphCues graph_;
  FrameCues frame_;
  const FittedTrees& same_thing_;
  const JudgedPair& on_judged_;
  std::vector<RegionFits> fits_;
  std::vector<std::int32_t> nodes_;  // of each region
  std::vector<std::vector<std::int32_t>> contacts_of_;
  std::vector<std::int32_t> common_;  // during a merge: the contact with the region that is kept; −1 = none
  std::vector<std::int64_t> fusions_;  // of each region
  std::vector<std::int32_t> first_;    // of each contact: its rank in raster order of first occurrence
  std::vector<PairScore> judged_;      // each contact
  std::vector<Neighbour> neighbours_;  // of the region that describe() works on
  std::priority_queue<Entry> queue_;
  MergeTree tree_;
};

}  // namespace

MergeTree grow_merge_tree(const Superpixels& superpixels, const Cues& cues, const FittedTrees& same_thing,
                          const Exec& exec, const JudgedPair& on_judged) {
  return TreeGrower(superpixels, cues, same_thing, exec, on_judged).run();
}

}  // namespace cairn
