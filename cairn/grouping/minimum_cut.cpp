// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/core/ids.hpp>
#include <cairn/grouping/minimum_cut.hpp>
#include <numeric>

namespace cairn {

MinimumCuts::MinimumCuts(std::size_t nodes, std::span<const Tie> ties, const Pool& pool)
    : memory_(pool),
      first_(nodes + 1, &memory_),
      arcs_(&memory_),
      costs_(nodes, &memory_),
      excess_(nodes, &memory_),
      level_(nodes, &memory_),
      next_(nodes, &memory_),
      queue_(&memory_) {
  for (const Tie& tie : ties) {
    ++first_[slot(tie.a) + 1];
    ++first_[slot(tie.b) + 1];
  }
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
  arcs_.resize(slot(first_.back()));
  std::pmr::vector<std::int32_t> place(first_.begin(), first_.end() - 1, &memory_);
  for (const Tie& tie : ties) {
    const std::int32_t there = place[slot(tie.a)]++;
    const std::int32_t back = place[slot(tie.b)]++;
    arcs_[slot(there)] = {tie.b, back, tie.cost};
    arcs_[slot(back)] = {tie.a, there, tie.cost};
  }
}

std::vector<std::int32_t> MinimumCuts::cut(std::span<const std::int64_t> cost_0,
                                           std::span<const std::int64_t> cost_1) {
  take_over(cost_0, cost_1);
  saturate();
  return labels();
}

/// What a node's costs grow by is added to what is left of them: the flow so far stays one.
void MinimumCuts::take_over(std::span<const std::int64_t> cost_0, std::span<const std::int64_t> cost_1) {
  std::ptrdiff_t givers = 0;
  std::ptrdiff_t takers = 0;
  for (std::size_t i = 0; i < costs_.size(); ++i) {
    const std::int64_t cost = cost_0[i] - cost_1[i];
    excess_[i] += swapped_ ? costs_[i] - cost : cost - costs_[i];
    costs_[i] = cost;
    givers += cost > 0 ? 1 : 0;
    takers += cost < 0 ? 1 : 0;
  }
  if (is_new_ && takers < givers) {  // ties are the same in both directions as long as nothing flows
    swapped_ = true;
    for (std::int64_t& excess : excess_) excess = -excess;
  }
  is_new_ = false;
}

void MinimumCuts::saturate() {
  while (find_levels()) {
    for (std::size_t head = 0; head < queue_.size() && level_[slot(queue_[head])] == 0; ++head) {
      while (excess_[slot(queue_[head])] > 0 && push_from(queue_[head])) {
      }
    }
  }
}

/// Breadth first from all nodes with something left to give; true where one with something to take is
/// reached. There paths end.
bool MinimumCuts::find_levels() {
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
    next_[slot(node)] = first_[slot(node)];
    if (excess_[slot(node)] < 0) {
      reached = true;
      continue;
    }
    for (std::int32_t i = first_[slot(node)]; i < first_[slot(node) + 1]; ++i) {
      const FlowArc& arc = arcs_[slot(i)];
      if (arc.capacity <= 0 || level_[slot(arc.to)] >= 0) continue;
      level_[slot(arc.to)] = level_[slot(node)] + 1;
      queue_.push_back(arc.to);
    }
  }
  return reached;
}

/// One augmenting path, depth first along rising levels; false where there is none from `start` any more.
bool MinimumCuts::push_from(std::int32_t start) {
  path_.clear();
  std::int32_t node = start;
  while (excess_[slot(node)] >= 0) {
    std::int32_t& i = next_[slot(node)];
    for (; i < first_[slot(node) + 1]; ++i) {
      const FlowArc& arc = arcs_[slot(i)];
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

/// 1 is what the givers still reach. Swapped, that is what still reaches the takers.
std::vector<std::int32_t> MinimumCuts::labels() const {
  std::vector<std::int32_t> label(excess_.size());
  for (std::size_t i = 0; i < label.size(); ++i) {
    label[i] = (swapped_ ? excess_[i] < 0 : level_[i] >= 0) ? 1 : 0;
  }
  if (swapped_) spread_ones(label);
  return label;
}

/// To those that still reach one of them.
void MinimumCuts::spread_ones(std::vector<std::int32_t>& label) const {
  std::vector<std::int32_t> to_do;
  const auto reach = [&](std::size_t node) {
    label[node] = 1;
    to_do.push_back(static_cast<std::int32_t>(node));
  };
  // What the givers reach reaches no taker, or there would be a path left.
  const auto undecided = [&](std::size_t node) { return level_[node] < 0 && label[node] == 0; };
  for (std::size_t node = 0; node < label.size(); ++node) {
    if (!undecided(node)) continue;
    for (std::int32_t i = first_[node]; i < first_[node + 1] && label[node] == 0; ++i) {
      if (arcs_[slot(i)].capacity > 0 && label[slot(arcs_[slot(i)].to)] != 0) reach(node);
    }
  }
  while (!to_do.empty()) {
    const std::size_t node = slot(to_do.back());
    to_do.pop_back();
    for (std::int32_t i = first_[node]; i < first_[node + 1]; ++i) {
      const FlowArc& arc = arcs_[slot(i)];
      if (undecided(slot(arc.to)) && arcs_[slot(arc.back)].capacity > 0) reach(slot(arc.to));
    }
  }
}

}  // namespace cairn
