// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/core/parallel.hpp>
#include <cairn/core/scratch.hpp>
#include <cairn/objects/fuse.hpp>
#include <cairn/stereo/label_kernels.hpp>
#include <cassert>
#include <numeric>
#include <span>
#include <vector>

namespace cairn {
namespace {

constexpr int kGrain = 64;  // rows

/// Adjacent pixels in the same intensity region and the same disparity region.
struct Overlap {
  RegionId by_intensity;
  RegionId by_disparity;
  std::int32_t pixels;
};

ScratchList<Overlap> overlaps(View<const RegionId> by_intensity, View<const RegionId> by_disparity,
                              const Exec& exec) {
  const kernels::LabelKernels& run = kernels::label_kernels(exec);
  const int width = by_intensity.width();
  ScratchList<Overlap> result(static_cast<std::size_t>(by_intensity.size().area() / 8), exec.pool);
  std::vector<std::int32_t> ends(slot(width) + kernels::kListSlack);
  for (int y = 0; y < by_intensity.height(); ++y) {
    const RegionId* const i = by_intensity.row(y);
    const RegionId* const d = by_disparity.row(y);
    const auto runs = slot(run.find_runs(i, d, width, ends.data()));
    Overlap* const room = result.room_for(runs);
    std::int32_t start = 0;
    for (std::size_t k = 0; k < runs; ++k) {
      room[k] = {i[start], d[start], ends[k] - start};
      start = ends[k];
    }
    result.grown(runs);
  }
  return result;
}

/// Sorted by intensity region, each one's overlaps together; first[i] … first[i + 1] − 1 are region i's.
Scratch<Overlap> grouped(const ScratchList<Overlap>& found, std::size_t regions,
                         std::vector<std::int32_t>& first, const Exec& exec) {
  first.assign(regions + 1, 0);
  for (const Overlap& o : found) ++first[index(o.by_intensity) + 1];
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<std::int32_t> next(first.begin(), first.end() - 1);
  Scratch<Overlap> result(found.size(), exec.pool);
  for (const Overlap& o : found) result[next[index(o.by_intensity)]++] = o;
  return result;
}

/// Equation (4): the disparity region that each intensity region overlaps most.
std::vector<RegionId> best_overlaps(const Segmentation& by_intensity, const Segmentation& by_disparity,
                                    const Exec& exec) {
  std::vector<std::int32_t> first;
  const Scratch<Overlap> found = grouped(overlaps(by_intensity.labels, by_disparity.labels, exec),
                                         by_intensity.regions.size(), first, exec);
  const auto mean = [&](RegionId id) { return by_disparity.regions[index(id)].mean; };

  std::vector<RegionId> chosen(by_intensity.regions.size());
  std::vector<std::int32_t> area(by_disparity.regions.size(), 0);  // A(I_i ∩ D_j) of one i
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const std::span<const Overlap> of_region(found.begin() + first[i], found.begin() + first[i + 1]);
    for (const Overlap& o : of_region) area[index(o.by_disparity)] += o.pixels;
    RegionId best = of_region.empty() ? RegionId{0} : of_region.front().by_disparity;
    const auto better = [&](RegionId a, RegionId b) {
      if (area[index(a)] != area[index(b)]) return area[index(a)] > area[index(b)];
      if (mean(a) != mean(b)) return mean(a) > mean(b);
      return a < b;
    };
    for (const Overlap& o : of_region) {
      if (o.by_disparity != best && better(o.by_disparity, best)) best = o.by_disparity;
    }
    for (const Overlap& o : of_region) area[index(o.by_disparity)] = 0;
    chosen[i] = best;
  }
  return chosen;
}

}  // namespace

Fusion fuse(const Segmentation& by_intensity, const Segmentation& by_disparity, const Exec& exec) {
  assert(by_intensity.labels.size() == by_disparity.labels.size());
  const std::vector<RegionId> chosen = best_overlaps(by_intensity, by_disparity, exec);

  Fusion fusion{Image<RegionId>(by_intensity.labels.size(), exec.pool), {}, {}, {}};
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
    fusion.is_floor.push_back(by_disparity.regions[d].is_floor);
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
