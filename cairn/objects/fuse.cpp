// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/core/parallel.hpp>
#include <cairn/objects/fuse.hpp>
#include <cassert>
#include <numeric>

namespace cairn {
namespace {

constexpr int kGrain = 64;  // rows

/// Pixels beside each other that lie in one intensity and one disparity region.
struct Overlap {
  RegionId by_intensity;
  RegionId by_disparity;
  std::int32_t pixels;
};

std::vector<Overlap> overlaps(View<const RegionId> by_intensity, View<const RegionId> by_disparity) {
  std::vector<Overlap> result;
  const int width = by_intensity.width();
  for (int y = 0; y < by_intensity.height(); ++y) {
    const RegionId* const i = by_intensity.row(y);
    const RegionId* const d = by_disparity.row(y);
    for (int x = 0; x < width;) {
      const int start = x;
      do ++x;
      while (x < width && i[x] == i[start] && d[x] == d[start]);
      result.push_back({i[start], d[start], x - start});
    }
  }
  return result;
}

/// Sorted by intensity region, each one's overlaps together; first[i] … first[i + 1] − 1 are region i's.
std::vector<Overlap> grouped(const std::vector<Overlap>& found, std::size_t regions,
                             std::vector<std::size_t>& first) {
  first.assign(regions + 1, 0);
  for (const Overlap& o : found) ++first[index(o.by_intensity) + 1];
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<std::size_t> next(first.begin(), first.end() - 1);
  std::vector<Overlap> result(found.size());
  for (const Overlap& o : found) result[next[index(o.by_intensity)]++] = o;
  return result;
}

/// Equation (4): the disparity region that each intensity region overlaps most.
std::vector<RegionId> best_overlaps(const Segmentation& by_intensity, const Segmentation& by_disparity) {
  std::vector<std::size_t> first;
  const std::vector<Overlap> found =
      grouped(overlaps(by_intensity.labels, by_disparity.labels), by_intensity.regions.size(), first);
  const auto mean = [&](RegionId id) { return by_disparity.regions[index(id)].mean; };

  std::vector<RegionId> chosen(by_intensity.regions.size());
  std::vector<std::int64_t> area(by_disparity.regions.size(), 0);  // A(I_i ∩ D_j) of one i
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    for (std::size_t k = first[i]; k < first[i + 1]; ++k)
      area[index(found[k].by_disparity)] += found[k].pixels;
    RegionId best = first[i] < first[i + 1] ? found[first[i]].by_disparity : RegionId{0};
    const auto better = [&](RegionId a, RegionId b) {
      if (area[index(a)] != area[index(b)]) return area[index(a)] > area[index(b)];
      if (mean(a) != mean(b)) return mean(a) > mean(b);
      return a < b;
    };
    for (std::size_t k = first[i]; k < first[i + 1]; ++k) {
      if (better(found[k].by_disparity, best)) best = found[k].by_disparity;
    }
    for (std::size_t k = first[i]; k < first[i + 1]; ++k) area[index(found[k].by_disparity)] = 0;
    chosen[i] = best;
  }
  return chosen;
}

}  // namespace

Fusion fuse(const Segmentation& by_intensity, const Segmentation& by_disparity, const Exec& exec) {
  assert(by_intensity.labels.size() == by_disparity.labels.size());
  const std::vector<RegionId> chosen = best_overlaps(by_intensity, by_disparity);

  Fusion fusion{Image<RegionId>(by_intensity.labels.size(), exec.pool), {}, {}};
  std::vector<std::vector<RegionId>> parts(by_disparity.regions.size());
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    parts[index(chosen[i])].push_back(RegionId{static_cast<std::int32_t>(i)});
  }
  std::vector<RegionId> fused(chosen.size());  // per intensity region
  for (std::size_t d = 0; d < parts.size(); ++d) {
    if (parts[d].empty()) continue;
    for (const RegionId part : parts[d])
      fused[index(part)] = RegionId{static_cast<std::int32_t>(fusion.parts.size())};
    fusion.parts.push_back(std::move(parts[d]));
    fusion.disparity_region.push_back(RegionId{static_cast<std::int32_t>(d)});
  }

  parallel_for(exec, fusion.labels.height(), kGrain, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      const RegionId* const in = by_intensity.labels.row(y);
      RegionId* const out = fusion.labels.row(y);
      for (int x = 0; x < fusion.labels.width(); ++x) out[x] = fused[index(in[x])];
    }
  });
  return fusion;
}

}  // namespace cairn
