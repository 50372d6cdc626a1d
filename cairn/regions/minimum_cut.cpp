// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/core/ids.hpp>
#include <cairn/regions/minimum_cut.hpp>
#include <numeric>

namespace cairn {
namespace {

/// The nodes and their residual capacities. What a node could take from the source or give to the sink is
/// kept beside it, so that source and sink are no nodes.
class Network {
 public:
  Network(const std::vector<std::int64_t>& cost_0, const std::vector<std::int64_t>& cost_1,
          const std::vector<Tie>& ties)
      : first_(cost_0.size() + 1), excess_(cost_0.size()), level_(cost_0.size()), next_(cost_0.size()) {
    for (std::size_t i = 0; i < excess_.size(); ++i) excess_[i] = cost_0[i] - cost_1[i];
    for (const Tie& tie : ties) {
      ++first_[slot(tie.a) + 1];
      ++first_[slot(tie.b) + 1];
    }
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    arcs_.resize(slot(first_.back()));
    std::vector<std::int32_t> place(first_.begin(), first_.end() - 1);
    for (const Tie& tie : ties) {
      const std::int32_t there = place[slot(tie.a)]++;
      const std::int32_t back = place[slot(tie.b)]++;
      arcs_[slot(there)] = {tie.b, back, tie.cost};
      arcs_[slot(back)] = {tie.a, there, tie.cost};
    }
  }

  void saturate() {
    while (find_levels()) {
      std::copy(first_.begin(), first_.end() - 1, next_.begin());
      for (std::size_t i = 0; i < excess_.size(); ++i) {
        while (excess_[i] > 0 && push_from(static_cast<std::int32_t>(i))) {
        }
      }
    }
  }

  /// The nodes that the source still reaches.
  [[nodiscard]] std::vector<std::int32_t> source_side() const {
    std::vector<std::int32_t> side(excess_.size());
    std::transform(level_.begin(), level_.end(), side.begin(),
                   [](std::int32_t level) { return level >= 0 ? 1 : 0; });
    return side;
  }

 private:
  struct Arc {
    std::int32_t to = 0;
    std::int32_t back = 0;  // the arc the other way
    std::int64_t capacity = 0;
  };

  /// Breadth first from all nodes with something left to give; true where one with something to take is
  /// reached.
  bool find_levels() {
    std::fill(level_.begin(), level_.end(), -1);
    queue_.clear();
    for (std::size_t i = 0; i < excess_.size(); ++i) {
      if (excess_[i] <= 0) continue;
      level_[i] = 0;
      queue_.push_back(static_cast<std::int32_t>(i));
    }
    bool reached = false;
    for (std::size_t head = 0; head < queue_.size(); ++head) {
      const std::int32_t node = queue_[head];
      reached = reached || excess_[slot(node)] < 0;
      for (std::int32_t i = first_[slot(node)]; i < first_[slot(node) + 1]; ++i) {
        const Arc& arc = arcs_[slot(i)];
        if (arc.capacity <= 0 || level_[slot(arc.to)] >= 0) continue;
        level_[slot(arc.to)] = level_[slot(node)] + 1;
        queue_.push_back(arc.to);
      }
    }
    return reached;
  }

  /// One augmenting path, depth first along rising levels; false where there is none from `start` any more.
  bool push_from(std::int32_t start) {
    path_.clear();
    std::int32_t node = start;
    while (excess_[slot(node)] >= 0) {
      std::int32_t& i = next_[slot(node)];
      for (; i < first_[slot(node) + 1]; ++i) {
        const Arc& arc = arcs_[slot(i)];
        if (arc.capacity > 0 && level_[slot(arc.to)] == level_[slot(node)] + 1) break;
      }
      if (i < first_[slot(node) + 1]) {
        path_.push_back(i);
        node = arcs_[slot(i)].to;
        continue;
      }
      if (path_.empty()) return false;
      node = arcs_[slot(arcs_[slot(path_.back())].back)].to;
      path_.pop_back();
      ++next_[slot(node)];
    }
    std::int64_t amount = std::min(excess_[slot(start)], -excess_[slot(node)]);
    for (const std::int32_t i : path_) amount = std::min(amount, arcs_[slot(i)].capacity);
    for (const std::int32_t i : path_) {
      arcs_[slot(i)].capacity -= amount;
      arcs_[slot(arcs_[slot(i)].back)].capacity += amount;
    }
    excess_[slot(start)] -= amount;
    excess_[slot(node)] += amount;
    return true;
  }

  std::vector<std::int32_t> first_;
  std::vector<Arc> arcs_;
  std::vector<std::int64_t> excess_;  // positive: to give, negative: to take
  std::vector<std::int32_t> level_;
  std::vector<std::int32_t> next_;
  std::vector<std::int32_t> queue_;
  std::vector<std::int32_t> path_;
};

}  // namespace

std::vector<std::int32_t> minimum_cut(const std::vector<std::int64_t>& cost_0,
                                      const std::vector<std::int64_t>& cost_1, const std::vector<Tie>& ties) {
  Network network(cost_0, cost_1, ties);
  network.saturate();
  return network.source_side();
}

}  // namespace cairn
