// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "reference/facets.hpp"

#include <algorithm>
#include <functional>
#include <map>
#include <utility>
#include <vector>

#include "reference/evidence.hpp"
#include "reference/regions.hpp"

namespace cairn::reference {
namespace {

/// Everything that is `from` becomes `to`.
void repaint(Image<RegionId>& labels, RegionId from, RegionId to) {
  for (int y = 0; y < labels.height(); ++y) {
    for (int x = 0; x < labels.width(); ++x) {
      if (labels(x, y) == from) labels(x, y) = to;
    }
  }
}

/// Numbers in raster order of the first pixel; how many there are.
int renumber(Image<RegionId>& labels) {
  std::map<RegionId, int> numbers;
  for (int y = 0; y < labels.height(); ++y) {
    for (int x = 0; x < labels.width(); ++x) {
      const auto known = numbers.try_emplace(labels(x, y), static_cast<int>(numbers.size())).first;
      labels(x, y) = RegionId{known->second};
    }
  }
  return static_cast<int>(numbers.size());
}

}  // namespace

Facets segment_facets(View<const Gray> gray, View<const Rgb> rgb, const FacetsConfig& config) {
  const Image<std::uint16_t> edges = reference::edge_strength(gray, rgb, config.smoothing_sigma);
  Image<RegionId> labels = reference::watershed(edges).labels;
  // The strongest edge that at least one pixel in fifty has or exceeds.
  std::vector<int> strengths;
  strengths.reserve(static_cast<std::size_t>(edges.size().area()));
  for (int y = 0; y < edges.height(); ++y) {
    for (int x = 0; x < edges.width(); ++x) strengths.push_back(edges(x, y));
  }
  std::sort(strengths.begin(), strengths.end(), std::greater<>());
  const int clear_edge = strengths[strengths.size() / 50];
  const double limit = 4.0 * (config.edge_min + config.noise_factor * reference::noise_sigma(gray)) +
                       0.01 * config.contrast_share * clear_edge;
  for (int round = 0; round < 16; ++round) {
    std::map<std::int32_t, Border> weakest;  // of each region
    for (const Border& border : reference::borders_of(labels, edges)) {
      for (const std::int32_t end : {border.a, border.b}) {
        const auto [known, is_first] = weakest.try_emplace(end, border);
        if (!is_first && border.mean_edge() < known->second.mean_edge()) known->second = border;
      }
    }
    std::erase_if(weakest, [limit](const auto& of) { return !(of.second.mean_edge() < limit); });
    if (weakest.empty()) break;
    std::map<std::int32_t, RegionId> now;
    const auto painted = [&](std::int32_t region) {
      return now.try_emplace(region, RegionId{region}).first->second;
    };
    for (const auto& [region, border] : weakest) {
      const RegionId from = painted(border.b);
      const RegionId to = painted(border.a);
      repaint(labels, from, to);
      for (auto& [unused, colour] : now) colour = colour == from ? to : colour;
    }
    renumber(labels);
  }
  const int count = renumber(labels);
  auto borders = reference::borders_of(labels, edges);
  return {std::move(labels), count, std::move(borders)};
}

}  // namespace cairn::reference
