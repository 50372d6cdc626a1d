// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/pool_memory.hpp>
#include <cstdint>
#include <memory_resource>
#include <span>
#include <vector>

namespace cairn {

/// What it costs to part two nodes.
struct Tie {
  std::int32_t a = 0;
  std::int32_t b = 0;
  std::int64_t cost = 0;
};

/// What still may flow along a tie, from one of its nodes to the other.
struct FlowArc {
  std::int32_t to = 0;
  std::int32_t back = 0;  // number of the arc the other way
  std::int64_t capacity = 0;
};

/// Labels every node 0 or 1 so that the sum of cost_0 of the nodes labelled 0, cost_1 of those labelled 1,
/// and the costs of ties between differently labelled nodes is least; of several such labellings the one with
/// the fewest 1s. Exact: a minimum s-t cut (Greig, Porteous & Seheult 1989), found with Dinic's augmenting
/// paths. No cost is negative. The nodes' ties stay and their costs change: each cut begins with the flow of
/// the one before (Kohli & Torr 2005, "Efficiently solving dynamic Markov random fields using graph cuts").
class MinimumCuts {
 public:
  MinimumCuts(std::size_t nodes, std::span<const Tie> ties, const Pool& pool = {});
  MinimumCuts(const MinimumCuts&) = delete;
  MinimumCuts& operator=(const MinimumCuts&) = delete;

  std::vector<std::int32_t> cut(std::span<const std::int64_t> cost_0, std::span<const std::int64_t> cost_1);

 private:
  void take_over(std::span<const std::int64_t> cost_0, std::span<const std::int64_t> cost_1);
  void saturate();
  bool find_levels();
  bool push_from(std::int32_t start);
  [[nodiscard]] std::vector<std::int32_t> labels() const;
  void spread_ones(std::vector<std::int32_t>& label) const;

  // What a node could take from the source or give to the sink is kept beside it, so that source and sink are
  // no nodes.
  PoolMemory memory_;
  std::pmr::vector<std::int32_t> first_;
  std::pmr::vector<FlowArc> arcs_;
  std::pmr::vector<std::int64_t> costs_;   // of label 0 above those of label 1
  std::pmr::vector<std::int64_t> excess_;  // positive: to give, negative: to take
  // Paths are looked for from the side that has fewer nodes. Where those are the nodes that would be 0,
  // everything is seen with the labels swapped.
  bool swapped_ = false;
  bool is_new_ = true;
  std::pmr::vector<std::int32_t> level_;
  std::pmr::vector<std::int32_t> next_;
  std::pmr::vector<std::int32_t> queue_;
  std::vector<std::int32_t> path_;
};

}  // namespace cairn
