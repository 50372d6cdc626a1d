// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <algorithm>
#include <cairn/regions/grow_statistical.hpp>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

namespace cairn {

/// A graph whose regions fuse. Private to the growing stages.
///
/// Everything lies in flat arrays indexed by the graph's node numbers. A living region is the root of a
/// union-find tree. Its neighbours are those of all its members, which form a chain, so a fusion joins two
/// chains end to end and touches no list; numbers in the lists go stale and are led to their living region
/// when they are read.
class GrowingRegions {
 public:
  using Node = RegionGraph::Node;

  explicit GrowingRegions(const RegionGraph& graph)
      : nodes_(graph.nodes),
        arcs_(graph.arcs),
        lists_(graph.nodes.size()),
        parent_(graph.nodes.size()),
        seen_(graph.nodes.size(), -1),
        mean_(graph.nodes.size()) {
    std::iota(parent_.begin(), parent_.end(), 0);
    for (int i = 0; i < count(); ++i) {
      lists_[at(i)] = {graph.first_arc[at(i)], graph.first_arc[at(i) + 1], -1, i};
      mean_[at(i)] = nodes_[at(i)].mean();
    }
  }

  [[nodiscard]] int count() const { return static_cast<int>(nodes_.size()); }
  [[nodiscard]] const Node& node(int region) const { return nodes_[at(region)]; }
  [[nodiscard]] double mean(int region) const { return mean_[at(region)]; }
  [[nodiscard]] bool is_alive(int region) const { return parent_[at(region)] == region; }
  /// Where it stands in raster order: different for any two living regions.
  [[nodiscard]] int place(int region) const { return nodes_[at(region)].first_pixel; }

  /// From here on found_neighbours() names each region once.
  void start_visit(int region) {
    ++visit_;
    seen_[at(region)] = visit_;
  }
  /// Calls found(neighbour) for each living neighbour of `region` that this visit has not named yet.
  template <class Found>
  void for_each_new_neighbour(int region, Found found) {
    for (int member = region; member >= 0; member = lists_[at(member)].next_member) {
      for (int i = lists_[at(member)].begin; i < lists_[at(member)].end; ++i) {
        const int neighbour = living(arcs_[at(i)]);
        if (seen_[at(neighbour)] == visit_) continue;
        seen_[at(neighbour)] = visit_;
        found(neighbour);
      }
    }
  }

  void absorb(int survivor, int other) {
    nodes_[at(survivor)].absorb(nodes_[at(other)]);
    mean_[at(survivor)] = nodes_[at(survivor)].mean();
    parent_[at(other)] = survivor;
    lists_[at(lists_[at(survivor)].last_member)].next_member = other;
    lists_[at(survivor)].last_member = lists_[at(other)].last_member;
  }

  /// States anew which regions are beside `region`, so that later visits do not wade through its inner
  /// borders.
  void set_neighbours(int region, const std::vector<std::int32_t>& neighbours) {
    const int begin = static_cast<int>(arcs_.size());
    arcs_.insert(arcs_.end(), neighbours.begin(), neighbours.end());
    lists_[at(region)] = {begin, static_cast<int>(arcs_.size()), -1, region};
  }

  [[nodiscard]] Merges merges() {
    Merges merged_into(nodes_.size());
    for (int i = 0; i < count(); ++i) merged_into[at(i)] = living(i);
    return merged_into;
  }

 private:
  struct List {
    std::int32_t begin = 0;  // this member's neighbours: arcs_[begin] … arcs_[end − 1]
    std::int32_t end = 0;
    std::int32_t next_member = -1;
    std::int32_t last_member = -1;  // kept up for living regions
  };
  static std::size_t at(int i) { return static_cast<std::size_t>(i); }

  int living(int region) {
    while (parent_[at(region)] != region) {
      parent_[at(region)] = parent_[at(parent_[at(region)])];
      region = parent_[at(region)];
    }
    return region;
  }

  std::vector<Node> nodes_;
  std::vector<std::int32_t> arcs_;
  std::vector<List> lists_;
  std::vector<std::int32_t> parent_;
  std::vector<std::int32_t> seen_;
  std::vector<double> mean_;  // of living regions
  std::int32_t visit_ = 0;
};

/// Equations (1) to (3) for one visited region and many neighbours: what depends on the visited one is kept.
class Absorption {
 public:
  Absorption(const RegionGraph::Node& visited, const GrowCriteria& criteria) : criteria_(criteria) {
    update(visited);
  }

  /// After a fusion.
  void update(const RegionGraph::Node& visited) {
    valid_count_ = visited.valid_count;
    sum_ = visited.sum;
    mean_ = visited.mean();
    sigma_ = std::max(std::sqrt(visited.variance()), criteria_.sigma_min);
    may_absorb_ = visited.valid_count > 0 && !visited.is_floor;
  }
  [[nodiscard]] double mean() const { return mean_; }
  [[nodiscard]] bool may_absorb() const { return may_absorb_; }
  [[nodiscard]] bool is_near(double neighbour_mean) const {
    return std::abs(mean_ - neighbour_mean) <= criteria_.mean_difference_max;  // Eq. (1)
  }
  [[nodiscard]] bool admits(const RegionGraph::Node& neighbour, double neighbour_mean) const {
    if (!may_absorb_ || neighbour.valid_count == 0 || neighbour.is_floor || !is_near(neighbour_mean))
      return false;
    // Eq. (3): N·μ is the sum, exactly
    const double new_mean =
        static_cast<double>(sum_ + neighbour.sum) / static_cast<double>(valid_count_ + neighbour.valid_count);
    return std::abs(new_mean - mean_) / sigma_ <= criteria_.deviation_max;  // Eq. (2)
  }

 private:
  GrowCriteria criteria_;
  std::int64_t valid_count_ = 0;
  std::int64_t sum_ = 0;
  double mean_ = 0;
  double sigma_ = 0;
  bool may_absorb_ = false;
};

/// fuse_small_regions() on regions that are growing already.
void fuse_small_regions(GrowingRegions& regions, std::int64_t min_region_area);

}  // namespace cairn
