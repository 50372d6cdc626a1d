// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "regions.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <tuple>

namespace cairn::reference {
namespace {

constexpr std::array<Point, 4> kAround{Point{0, -1}, Point{-1, 0}, Point{1, 0},
                                       Point{0, 1}};  // up, left, right, down

template <class T>
T clamped_at(View<const T> image, int x, int y) {
  return image(std::clamp(x, 0, image.width() - 1), std::clamp(y, 0, image.height() - 1));
}

/// weights[i] applies at +i and −i.
std::vector<std::int64_t> gaussian(float sigma) {
  const int reach = sigma > 0 ? std::min(static_cast<int>(std::ceil(3.0 * sigma)), 15) : 0;
  const auto bell = [&](int i) { return i == 0 ? 1.0 : std::exp(-0.5 * i * i / (double{sigma} * sigma)); };
  double total = 0;
  for (int i = -reach; i <= reach; ++i) total += bell(i);
  std::vector<std::int64_t> weights{256};
  for (int i = 1; i <= reach; ++i) {
    weights.push_back(std::lround(256 * bell(i) / total));
    weights[0] -= 2 * weights.back();
  }
  return weights;
}

/// The weighted sum over the window and the sum of the weights used; `value` returns each pixel's value, or
/// kHole16.
struct Sum {
  std::int64_t value = 0;
  std::int64_t weight = 0;
};
template <class Value>
Sum window_sum(int x, int y, const std::vector<std::int64_t>& weights, Value value) {
  Sum sum;
  const int r = static_cast<int>(weights.size()) - 1;
  for (int v = -r; v <= r; ++v) {
    for (int u = -r; u <= r; ++u) {
      const std::int64_t weight =
          weights[static_cast<std::size_t>(std::abs(u))] * weights[static_cast<std::size_t>(std::abs(v))];
      const std::int64_t here = value(x + u, y + v);
      if (here == kHole16) continue;
      sum.value += weight * here;
      sum.weight += weight;
    }
  }
  return sum;
}

/// Numbers the groups of equal keys in raster order of their first pixel.
template <class Key>
Basins numbered(const Image<Key>& keys) {
  Basins basins{Image<RegionId>(keys.size()), 0};
  std::map<Key, int> id;
  for (int y = 0; y < keys.height(); ++y) {
    for (int x = 0; x < keys.width(); ++x) {
      const auto [entry, is_new] = id.emplace(keys(x, y), basins.count);
      if (is_new) ++basins.count;
      basins.labels(x, y) = RegionId{entry->second};
    }
  }
  return basins;
}

/// The smallest index connected to each pixel; joined(p, q) defines which neighbours are connected.
template <class Joined>
Image<int> components(Size size, Joined joined) {
  Image<int> least(size);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) least(x, y) = y * size.width + x;
  }
  for (bool changed = true; changed;) {
    changed = false;
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) {
        for (const Point step : kAround) {
          const Point q{x + step.x, y + step.y};
          if (!least.view().contains(q.x, q.y) || !joined(Point{x, y}, q) || least(q.x, q.y) >= least(x, y))
            continue;
          least(x, y) = least(q.x, q.y);
          changed = true;
        }
      }
    }
  }
  return least;
}

/// A growing region graph, as sets.
struct RegionGrower {
  std::map<int, RegionGraph::Node> nodes;  // surviving regions
  std::map<int, std::set<int>> neighbours;
  Merges merged_into;

  explicit RegionGrower(const RegionGraph& graph) : merged_into(graph.nodes.size()) {
    std::iota(merged_into.begin(), merged_into.end(), 0);
    for (int i = 0; i < static_cast<int>(graph.nodes.size()); ++i) {
      const auto at = static_cast<std::size_t>(i);
      nodes[i] = graph.nodes[at];
      neighbours[i] = {graph.arcs.begin() + graph.first_arc[at],
                       graph.arcs.begin() + graph.first_arc[at + 1]};
    }
  }
  void absorb(int survivor, int other) {
    nodes[survivor].absorb(nodes[other]);
    for (const int n : neighbours[other]) {
      neighbours[n].erase(other);
      if (n != survivor) neighbours[n].insert(survivor), neighbours[survivor].insert(n);
    }
    nodes.erase(other);
    neighbours.erase(other);
    for (int& target : merged_into) target = target == other ? survivor : target;
  }
  int place(int region) { return nodes[region].first_pixel; }
  std::vector<int> in_raster_order(std::vector<int> regions) {
    std::sort(regions.begin(), regions.end(), [&](int a, int b) { return place(a) < place(b); });
    return regions;
  }
  std::vector<int> neighbours_in_raster_order(int region) {
    return in_raster_order({neighbours[region].begin(), neighbours[region].end()});
  }
  std::vector<int> living() {
    std::vector<int> all;
    for (const auto& [region, node] : nodes) all.push_back(region);
    return in_raster_order(all);
  }
};

void fuse_small_regions(RegionGrower& growing, std::int64_t min_region_area) {
  while (true) {
    int smallest = -1, target = -1;
    for (const int region : growing.living()) {
      const auto& node = growing.nodes[region];
      const bool small = node.pixel_count < min_region_area || node.valid_count == 0;
      const auto& around = growing.neighbours[region];
      const bool can =
          std::any_of(around.begin(), around.end(), [&](int n) { return !growing.nodes[n].is_floor; });
      if (!small || node.is_floor || !can) continue;
      if (smallest < 0 || node.pixel_count < growing.nodes[smallest].pixel_count) smallest = region;
    }
    if (smallest < 0) return;
    const auto& node = growing.nodes[smallest];
    double least = 0;
    for (const int n : growing.neighbours_in_raster_order(smallest)) {
      const auto& other = growing.nodes[n];
      if (other.is_floor) continue;
      const double value = other.valid_count == 0  ? std::numeric_limits<double>::infinity()
                           : node.valid_count == 0 ? other.mean()
                                                   : std::abs(node.mean() - other.mean());
      if (target < 0 || value < least) target = n, least = value;
    }
    growing.absorb(target, smallest);
  }
}

std::int64_t pixels_in(float percent, Size image) {
  return static_cast<std::int64_t>(std::ceil(double{percent} * static_cast<double>(image.area()) / 100));
}

}  // namespace

Image<std::uint16_t> gradient(View<const Gray> image, float smoothing_sigma) {
  const auto weights = gaussian(smoothing_sigma);
  const auto grey = [&](int x, int y) -> std::int64_t { return clamped_at(image, x, y); };
  // The sum of weights is 65536; the result is in 1/16 grey levels.
  Image<int> smooth(image.size());
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      smooth(x, y) = static_cast<int>((window_sum(x, y, weights, grey).value + 2048) / 4096);
    }
  }
  Image<std::uint16_t> result(image.size());
  const View<const int> s = smooth;
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      const double gx = clamped_at(s, x + 1, y) - clamped_at(s, x - 1, y);
      const double gy = clamped_at(s, x, y + 1) - clamped_at(s, x, y - 1);
      result(x, y) =
          static_cast<std::uint16_t>(std::min(std::lround(std::sqrt(gx * gx + gy * gy) / 16), 255L));
    }
  }
  return result;
}

Image<std::int16_t> quantised(const DisparityMap& disparity) {
  Image<std::int16_t> result(disparity.disparity_px.size());
  for (int y = 0; y < result.height(); ++y) {
    for (int x = 0; x < result.width(); ++x) {
      const double d = disparity.disparity_px(x, y);
      result(x, y) = std::isnan(d) ? kHole16 : static_cast<std::int16_t>(std::floor(d * 16 + 0.5));
    }
  }
  return result;
}

Image<std::uint16_t> gradient(View<const std::int16_t> disparity16, float smoothing_sigma) {
  const auto weights = gaussian(smoothing_sigma);
  const auto value = [&](int x, int y) { return disparity16.contains(x, y) ? disparity16(x, y) : kHole16; };
  Image<int> smooth(disparity16.size());
  for (int y = 0; y < smooth.height(); ++y) {
    for (int x = 0; x < smooth.width(); ++x) {
      const Sum sum = window_sum(x, y, weights, value);
      const double mean =
          static_cast<double>(sum.value) / static_cast<double>(std::max<std::int64_t>(sum.weight, 1));
      smooth(x, y) = disparity16(x, y) == kHole16 ? kHole16 : static_cast<int>(std::floor(mean + 0.5));
    }
  }
  Image<std::uint16_t> result(disparity16.size());
  for (int y = 0; y < smooth.height(); ++y) {
    for (int x = 0; x < smooth.width(); ++x) {
      const auto at = [&](int u, int v) {
        return smooth.view().contains(u, v) && smooth(u, v) != kHole16 ? smooth(u, v) : smooth(x, y);
      };
      const double gx = at(x + 1, y) - at(x - 1, y);
      const double gy = at(x, y + 1) - at(x, y - 1);
      // The root is a float by definition; above the cap its argument would not be exact.
      const double square = std::min(gx * gx + gy * gy, double{kSteepest16} * kSteepest16);
      const long root = std::lround(std::sqrt(static_cast<float>(square)));
      result(x, y) = smooth(x, y) == kHole16 ? kHoleGradient : static_cast<std::uint16_t>(root);
    }
  }
  return result;
}

Image<std::uint16_t> levelled_below(double threshold, View<const std::uint16_t> gradient) {
  Image<std::uint16_t> result(gradient.size());
  for (int y = 0; y < gradient.height(); ++y) {
    for (int x = 0; x < gradient.width(); ++x)
      result(x, y) = gradient(x, y) < threshold ? std::uint16_t{0} : gradient(x, y);
  }
  return result;
}

Basins watershed(View<const std::uint16_t> gradient) {
  constexpr int kFar = std::numeric_limits<int>::max();
  const Size size = gradient.size();
  // The pixel that each pixel flows to, itself if unknown, and the distance to its plateau's lower border.
  Image<Point> to(size);
  Image<int> distance(size);
  const auto search = [&](Point p, auto accepts) {
    for (const Point step : kAround) {
      const Point q{p.x + step.x, p.y + step.y};
      if (gradient.contains(q.x, q.y) && accepts(q, to(p.x, p.y))) to(p.x, p.y) = q;
    }
    return !(to(p.x, p.y) == p);
  };
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      to(x, y) = {x, y};
      const auto lower = [&](Point q, Point best) { return gradient(q.x, q.y) < gradient(best.x, best.y); };
      distance(x, y) = search({x, y}, lower) ? 0 : kFar;
    }
  }
  for (int level = 1; level < static_cast<int>(size.area()); ++level) {
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) {
        if (distance(x, y) != kFar) continue;
        const auto nearer = [&](Point q, Point best) {
          return best == Point{x, y} && gradient(q.x, q.y) == gradient(x, y) &&
                 distance(q.x, q.y) == level - 1;
        };
        if (search({x, y}, nearer)) distance(x, y) = level;
      }
    }
  }
  return numbered(components(size, [&](Point p, Point q) {
    const bool same_floor = distance(p.x, p.y) == kFar && distance(q.x, q.y) == kFar;
    return to(p.x, p.y) == q || to(q.x, q.y) == p || same_floor;
  }));
}

Image<std::uint8_t> floor_with_holes(const Basins& basins, View<const std::uint8_t> floor,
                                     View<const std::int16_t> values) {
  std::map<RegionId, int> floor_pixels, other_pixels;
  Image<std::uint8_t> result(floor.size());
  for (const bool counting : {true, false}) {
    for (int y = 0; y < floor.height(); ++y) {
      for (int x = 0; x < floor.width(); ++x) {
        const RegionId basin = basins.labels(x, y);
        const bool is_floor = floor(x, y) != 0, is_hole = values(x, y) == kHole16;
        if (counting) {
          if (is_floor) ++floor_pixels[basin];
          if (!is_floor && !is_hole) ++other_pixels[basin];
        } else {
          const bool is_hole_in_floor = is_hole && floor_pixels[basin] > other_pixels[basin];
          result(x, y) = is_floor || is_hole_in_floor ? 255 : 0;
        }
      }
    }
  }
  return result;
}

Basins split_floor(const Basins& basins, View<const std::uint8_t> floor) {
  Image<int> keys = components(basins.labels.size(), [&](Point p, Point q) {
    return basins.labels(p.x, p.y) == basins.labels(q.x, q.y) && floor(p.x, p.y) == 0 && floor(q.x, q.y) == 0;
  });
  for (int y = 0; y < keys.height(); ++y) {
    for (int x = 0; x < keys.width(); ++x) keys(x, y) = floor(x, y) != 0 ? -1 : keys(x, y);
  }
  return numbered(keys);
}

RegionGraph build_graph(View<const RegionId> labels, int count, View<const std::int16_t> values,
                        View<const std::uint8_t> floor) {
  RegionGraph graph;
  graph.nodes.resize(static_cast<std::size_t>(count));
  std::vector<std::set<std::int32_t>> neighbours(graph.nodes.size());
  for (int y = 0; y < labels.height(); ++y) {
    for (int x = 0; x < labels.width(); ++x) {
      const bool valid = values(x, y) != kHole16;
      const int value = valid ? values(x, y) : 0;
      graph.nodes[index(labels(x, y))].absorb({.pixel_count = 1,
                                               .valid_count = valid ? 1 : 0,
                                               .sum = value,
                                               .sum_of_squares = value * value,
                                               .first_pixel = y * labels.width() + x,
                                               .box = {x, y, 1, 1},
                                               .is_floor = !floor.empty() && floor(x, y) != 0});
      for (const Point step : kAround) {
        if (!labels.contains(x + step.x, y + step.y)) continue;
        const RegionId other = labels(x + step.x, y + step.y);
        if (other != labels(x, y)) neighbours[index(labels(x, y))].insert(number(other));
      }
    }
  }
  for (const auto& list : neighbours) {
    graph.first_arc.push_back(static_cast<std::int32_t>(graph.arcs.size()));
    graph.arcs.insert(graph.arcs.end(), list.begin(), list.end());
  }
  graph.first_arc.push_back(static_cast<std::int32_t>(graph.arcs.size()));
  return graph;
}

bool may_fuse(const RegionGraph::Node& visited, const RegionGraph::Node& neighbour,
              const GrowCriteria& criteria) {
  if (visited.is_floor || neighbour.is_floor || visited.valid_count == 0 || neighbour.valid_count == 0)
    return false;
  const double new_mean = static_cast<double>(visited.sum + neighbour.sum) /
                          static_cast<double>(visited.valid_count + neighbour.valid_count);
  const double sigma = std::max(std::sqrt(visited.variance()), criteria.sigma_min);
  return std::abs(visited.mean() - neighbour.mean()) <= criteria.mean_difference_max &&
         std::abs(new_mean - visited.mean()) / sigma <= criteria.deviation_max;
}

Merges grow_statistical(const RegionGraph& graph, const GrowCriteria& criteria) {
  RegionGrower growing(graph);
  for (bool pass_fused = true; pass_fused;) {
    pass_fused = false;
    for (const int region : growing.living()) {
      bool round_fused = growing.nodes.contains(region);
      while (round_fused) {
        round_fused = false;
        for (const int neighbour : growing.neighbours_in_raster_order(region)) {
          if (!reference::may_fuse(growing.nodes[region], growing.nodes[neighbour], criteria)) continue;
          growing.absorb(region, neighbour);
          round_fused = pass_fused = true;
        }
      }
    }
  }
  fuse_small_regions(growing, criteria.min_region_area);
  return growing.merged_into;
}

Merges grow_near_to_far(const RegionGraph& graph, const GrowCriteria& criteria) {
  RegionGrower growing(graph);
  const auto mean = [&](int region) { return growing.nodes[region].mean(); };
  std::vector<int> order = growing.living();
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return mean(a) > mean(b); });
  for (const int node : order) {
    std::set<int> tried;
    while (growing.nodes.contains(node)) {
      int cheapest = -1;
      for (const int n : growing.neighbours_in_raster_order(node)) {
        if (tried.contains(n) || growing.nodes[n].valid_count == 0 || growing.nodes[n].is_floor) continue;
        const bool cheaper =
            cheapest < 0 || std::abs(mean(node) - mean(n)) < std::abs(mean(node) - mean(cheapest));
        if (cheaper) cheapest = n;
      }
      if (cheapest < 0) break;
      tried.insert(cheapest);
      if (reference::may_fuse(growing.nodes[node], growing.nodes[cheapest], criteria))
        growing.absorb(node, cheapest);
    }
  }
  fuse_small_regions(growing, criteria.min_region_area);
  return growing.merged_into;
}

Merges fuse_small_regions(const RegionGraph& graph, const Merges& merged_into, std::int64_t min_region_area) {
  RegionGrower growing(graph);
  for (int i = 0; i < static_cast<int>(merged_into.size()); ++i) {
    const int survivor = merged_into[static_cast<std::size_t>(i)];
    if (survivor != i) growing.absorb(survivor, i);
  }
  fuse_small_regions(growing, min_region_area);
  return growing.merged_into;
}

Segmentation apply_merges(View<const RegionId> labels, const RegionGraph& graph, const Merges& merged_into,
                          double value_scale) {
  Image<int> survivors(labels.size());
  for (int y = 0; y < labels.height(); ++y) {
    for (int x = 0; x < labels.width(); ++x) survivors(x, y) = merged_into[index(labels(x, y))];
  }
  Basins merged = numbered(survivors);
  Segmentation result{std::move(merged.labels), {}};
  for (int id = 0; id < merged.count; ++id) {
    RegionGraph::Node node;
    std::set<int> members;
    for (int y = 0; y < labels.height(); ++y) {
      for (int x = 0; x < labels.width(); ++x) {
        if (number(result.labels(x, y)) == id) members.insert(number(labels(x, y)));
      }
    }
    for (const int member : members) node.absorb(graph.nodes[static_cast<std::size_t>(member)]);
    result.regions.push_back({static_cast<int>(node.pixel_count), static_cast<int>(node.valid_count),
                              node.box, node.mean() * value_scale,
                              node.variance() * value_scale * value_scale, node.is_floor});
  }
  return result;
}

Segmentation segment_intensity(View<const Gray> image, const IntensityConfig& config) {
  Image<std::int16_t> values(image.size());
  for (int y = 0; y < image.height(); ++y) std::copy_n(image.row(y), image.width(), values.row(y));
  const Image<std::uint16_t> steepness = gradient(image, config.smoothing_sigma);
  const Image<std::uint16_t> edges = levelled_below(config.gradient_threshold, steepness);
  const Basins basins = watershed(edges);
  const RegionGraph graph = build_graph(basins.labels, basins.count, values, {});
  const Merges merges =
      reference::grow_statistical(graph, {config.mean_difference_max, config.deviation_max, config.sigma_min,
                                          pixels_in(config.min_region_area, image.size())});
  return apply_merges(basins.labels, graph, merges, 1.0);
}

Segmentation segment_disparity(const DisparityMap& disparity, View<const std::uint8_t> floor,
                               const DisparityConfig& config) {
  const Image<std::int16_t> values = quantised(disparity);
  const Image<std::uint16_t> steepness = gradient(values, config.smoothing_sigma);
  const Image<std::uint16_t> edges = levelled_below(double{config.gradient_threshold} * 16, steepness);
  Basins basins = watershed(edges);
  Image<std::uint8_t> whole_floor;
  if (!floor.empty()) {
    whole_floor = floor_with_holes(basins, floor, values);
    basins = split_floor(basins, whole_floor);
  }
  const RegionGraph graph = build_graph(basins.labels, basins.count, values, whole_floor);
  const Merges merges = reference::grow_near_to_far(
      graph, {config.mean_difference_max * 16.0, config.deviation_max, config.sigma_min * 16.0,
              pixels_in(config.min_region_area, values.size())});
  return apply_merges(basins.labels, graph, merges, 1.0 / 16);
}

Fusion fuse(const Segmentation& by_intensity, const Segmentation& by_disparity) {
  const Size size = by_intensity.labels.size();
  std::map<RegionId, std::map<RegionId, int>> overlap;
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) ++overlap[by_intensity.labels(x, y)][by_disparity.labels(x, y)];
  }
  std::map<RegionId, std::vector<RegionId>> parts;
  std::map<RegionId, RegionId> chosen;
  for (const auto& [i, overlapped] : overlap) {
    const auto& areas = overlapped;
    const auto rank = [&](RegionId d) {
      return std::tuple(areas.at(d), by_disparity.regions[index(d)].mean, -number(d));
    };
    RegionId best = areas.begin()->first;
    for (const auto& [d, area] : areas) best = rank(d) > rank(best) ? d : best;
    parts[best].push_back(i);
    chosen[i] = best;
  }
  Fusion fusion{Image<RegionId>(size), {}, {}, {}};
  std::map<RegionId, RegionId> fused;
  for (const auto& [d, list] : parts) {
    fused[d] = RegionId{static_cast<int>(fusion.parts.size())};
    fusion.parts.push_back(list);
    fusion.disparity_region.push_back(d);
    fusion.is_floor.push_back(by_disparity.regions[index(d)].is_floor);
  }
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) fusion.labels(x, y) = fused[chosen[by_intensity.labels(x, y)]];
  }
  return fusion;
}

}  // namespace cairn::reference
