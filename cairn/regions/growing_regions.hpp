// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <algorithm>
#include <bit>
#include <cairn/core/disjoint_sets.hpp>
#include <cairn/core/scratch.hpp>
#include <cairn/regions/grow_statistical.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>

namespace cairn {

/// Ordered like the values, NaN last.
inline std::uint64_t ascending_bits(double value) {
  const auto bits = std::bit_cast<std::uint64_t>(value);
  return bits ^
         (static_cast<std::uint64_t>(static_cast<std::int64_t>(bits) >> 63) | (std::uint64_t{1} << 63U));
}

/// A graph of regions that fuse. Private to the growing stages.
///
/// All data is in flat arrays indexed by the node numbers of the graph. A living region is the root of a
/// union-find tree. Its neighbours are those of all its members, which form a chain: a fusion joins two
/// chains end to end and changes no list. Numbers in the lists become stale and are mapped to their living
/// region when read.
class GrowingRegions {
 public:
  /// The data of a region for Eq. (2) and (3).
  struct Brief {
    double mean;
    std::int64_t sum;
    std::int32_t valid_count;
    static Brief of(const RegionGraph::Node& node) {
      const auto valid_count = static_cast<std::int32_t>(node.valid_count);
      return {mean_of(node.sum, valid_count, node.is_floor), node.sum, valid_count};
    }
  };

  GrowingRegions(const RegionGraph& graph, const Exec& exec)
      : arcs_(2 * graph.arcs.size(), exec.pool),
        sets_(graph.nodes.size(), exec.pool),
        means_(graph.nodes.size(), exec.pool),
        places_(graph.nodes.size(), exec.pool),
        seen_(graph.nodes.size(), -1, exec.pool),
        rests_(graph.nodes.size(), exec.pool) {
    std::copy(graph.arcs.begin(), graph.arcs.end(), arcs_.room_for(graph.arcs.size()));
    arcs_.grown(graph.arcs.size());
    for (std::int32_t i = 0; i < count(); ++i) {
      const auto at = static_cast<std::size_t>(i);
      const RegionGraph::Node& node = graph.nodes[at];
      means_[i] = mean_of(node.sum, static_cast<std::int32_t>(node.valid_count), node.is_floor);
      places_[i] = node.first_pixel;
      rests_[i] = {graph.first_arc[at],
                   graph.first_arc[at + 1],
                   -1,
                   i,
                   node.sum,
                   node.sum_of_squares,
                   static_cast<std::int32_t>(node.valid_count),
                   static_cast<std::int32_t>(node.pixel_count),
                   node.is_floor};
    }
  }

  [[nodiscard]] std::int32_t count() const { return static_cast<std::int32_t>(sets_.size()); }
  [[nodiscard]] Brief brief(std::int32_t region) const {
    return {means_[region], rests_[region].sum, rests_[region].valid_count};
  }
  /// NaN if the region cannot fuse by similarity: floor, or no valid pixel.
  [[nodiscard]] double mean(std::int32_t region) const { return means_[region]; }
  /// The first pixel: unique among living regions, ascending in raster order.
  [[nodiscard]] std::int32_t place(std::int32_t region) const { return places_[region]; }
  [[nodiscard]] std::int32_t valid_count(std::int32_t region) const { return rests_[region].valid_count; }
  /// Sum of the squares of the values.
  [[nodiscard]] std::int64_t squares(std::int32_t region) const { return rests_[region].squares; }
  [[nodiscard]] std::int32_t pixel_count(std::int32_t region) const { return rests_[region].pixel_count; }
  [[nodiscard]] bool is_floor(std::int32_t region) const { return rests_[region].is_floor; }
  [[nodiscard]] bool is_alive(std::int32_t region) const { return sets_.is_root(region); }

  /// Calls found(neighbour) for each living neighbour of `region`, some of them repeatedly, and possibly for
  /// the region itself.
  template <class Found>
  void for_each_neighbour(std::int32_t region, Found found) {
    for (std::int32_t member = region; member >= 0; member = rests_[member].next_member) {
      for (const std::int32_t neighbour : arcs_of(member)) found(sets_.root(neighbour));
    }
  }

  /// Sets the mean to NaN until the region fuses or show_mean() is called. Returns the mean.
  double hide_mean(std::int32_t region) {
    return std::exchange(means_[region], std::numeric_limits<double>::quiet_NaN());
  }
  void show_mean(std::int32_t region) {
    const Rest& rest = rests_[region];
    means_[region] = mean_of(rest.sum, rest.valid_count, rest.is_floor);
  }

  /// From here on append_new_neighbours() returns each region once.
  void start_visit(std::int32_t region) {
    ++visit_;
    seen_[region] = visit_;
  }
  /// Appends the living neighbours of `region` that this visit has not returned yet. Branch-free: one in two
  /// or three is known already, unpredictably.
  void append_new_neighbours(std::int32_t region, ScratchList<std::int32_t>& found) {
    std::int32_t* const seen = seen_.data();
    for (std::int32_t member = region; member >= 0; member = rests_[member].next_member) {
      const std::span<const std::int32_t> arcs = arcs_of(member);
      std::int32_t* const room = found.room_for(arcs.size() + 1);
      std::size_t count = 0;
      for (const std::int32_t arc : arcs) {
        const std::int32_t neighbour = sets_.root(arc);
        room[count] = neighbour;
        count += seen[neighbour] != visit_ ? 1 : 0;
        seen[neighbour] = visit_;
      }
      found.grown(count);
    }
  }

  void absorb(std::int32_t survivor, std::int32_t other) {
    Rest& rest = rests_[survivor];
    const Rest& absorbed = rests_[other];
    rest.sum += absorbed.sum;
    rest.squares += absorbed.squares;
    rest.valid_count += absorbed.valid_count;
    rest.pixel_count += absorbed.pixel_count;
    show_mean(survivor);
    places_[survivor] = std::min(places_[survivor], places_[other]);
    sets_.hang(other, survivor);
    rests_[rest.last_member].next_member = other;
    rest.last_member = absorbed.last_member;
  }

  /// Replaces the neighbours of `region`, so that later visits skip its inner borders. Calls neighbour_at(i)
  /// for i = 0 … count − 1.
  template <class NeighbourAt>
  void set_neighbours(std::int32_t region, std::size_t count, NeighbourAt neighbour_at) {
    std::int32_t* const room = arcs_.room_for(count);
    for (std::size_t i = 0; i < count; ++i) room[i] = neighbour_at(i);
    const auto begin = static_cast<std::int32_t>(arcs_.size());
    arcs_.grown(count);
    Rest& rest = rests_[region];
    rest.begin = begin;
    rest.end = begin + static_cast<std::int32_t>(count);
    rest.next_member = -1;
    rest.last_member = region;
  }

  [[nodiscard]] Merges merges() {
    Merges merged_into(sets_.size());
    for (std::int32_t i = 0; i < count(); ++i) merged_into[static_cast<std::size_t>(i)] = sets_.root(i);
    return merged_into;
  }

 private:
  struct Rest {
    std::int32_t begin;  // of the neighbours of this member in arcs_
    std::int32_t end;
    std::int32_t next_member;
    std::int32_t last_member;  // from here on: valid for living regions
    std::int64_t sum;
    std::int64_t squares;
    std::int32_t valid_count;
    std::int32_t pixel_count;
    bool is_floor;
  };

  [[nodiscard]] std::span<const std::int32_t> arcs_of(std::int32_t member) const {
    return {arcs_.begin() + rests_[member].begin, arcs_.begin() + rests_[member].end};
  }
  static double mean_of(std::int64_t sum, std::int32_t valid_count, bool is_floor) {
    return valid_count == 0 || is_floor ? std::numeric_limits<double>::quiet_NaN()
                                        : static_cast<double>(sum) / static_cast<double>(valid_count);
  }

  ScratchList<std::int32_t> arcs_;  // those of the graph, followed by replaced ones
  // Separate arrays for what a look at a neighbour reads: short ones stay in cache.
  DisjointSets sets_;  // the roots are the living regions
  Scratch<double> means_;
  Scratch<std::int32_t> places_;
  Scratch<std::int32_t> seen_;  // the last visit that returned it
  Scratch<Rest> rests_;
  std::int32_t visit_ = 0;
};

/// Equations (1) to (3) for one visited region and many neighbours; caches what depends on the visited one.
class Absorption {
 public:
  using Brief = GrowingRegions::Brief;

  Absorption(const Brief& visited, std::int64_t squares, const GrowCriteria& criteria) : criteria_(criteria) {
    update(visited, squares);
  }

  /// To be called after a fusion.
  void update(const Brief& visited, std::int64_t squares) {
    sum_ = visited.sum;
    valid_count_ = visited.valid_count;
    if (std::isnan(visited.mean)) return;  // mean_ stays NaN: never near
    const auto n = static_cast<double>(valid_count_);
    mean_ = visited.mean;
    const double variance = std::max(0.0, static_cast<double>(squares) / n - mean_ * mean_);
    sigma_ = std::max(std::sqrt(variance), criteria_.sigma_min);
  }
  [[nodiscard]] double mean() const { return mean_; }
  [[nodiscard]] bool may_absorb() const { return mean_ == mean_; }
  /// Eq. (1)
  [[nodiscard]] bool is_near(double neighbour_mean) const {
    return std::abs(mean_ - neighbour_mean) <= criteria_.mean_difference_max;
  }
  /// Eq. (2) and (3), for a neighbour with is_near().
  [[nodiscard]] bool admits(const Brief& neighbour) const {
    const double new_mean = static_cast<double>(sum_ + neighbour.sum) /
                            static_cast<double>(std::int64_t{valid_count_} + neighbour.valid_count);
    return std::abs(new_mean - mean_) / sigma_ <= criteria_.deviation_max;
  }

 private:
  GrowCriteria criteria_;
  std::int64_t sum_ = 0;
  std::int32_t valid_count_ = 0;
  double mean_ = std::numeric_limits<double>::quiet_NaN();
  double sigma_ = 0;
};

/// Whether Eq. (1) holds for any neighbour. It does not in most visits.
bool has_near_neighbour(GrowingRegions& regions, std::int32_t region, const Absorption& absorption);

/// fuse_small_regions() on growing regions.
void fuse_small_regions(GrowingRegions& regions, std::int64_t min_region_area, const Exec& exec);

}  // namespace cairn
