// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/core/parallel.hpp>
#include <cairn/core/pool_memory.hpp>
#include <cairn/image/gradient.hpp>
#include <cairn/regions/contacts.hpp>
#include <cairn/regions/cue_kernels.hpp>
#include <cairn/regions/superpixel_regions.hpp>
#include <cairn/regions/superpixels.hpp>
#include <cairn/regions/watershed.hpp>
#include <cairn/stereo/label_kernels.hpp>
#include <cmath>
#include <cstdint>
#include <memory_resource>
#include <numeric>
#include <utility>
#include <vector>

namespace cairn {
namespace {

constexpr int kGrain = 16;                // rows
constexpr float kSmoothing = 0.7F;        // px
constexpr float kStepWeight = 8.0F;       // 1/4 grey level for each px of a step of disparity
constexpr float kLargestStep = 4.0F;      // px
constexpr float kFlat = 4.0F;             // 1/4 grey level; weaker edges are ignored …
constexpr float kFlatInNoise = 4.0F;      // … and this much more per grey level of noise
constexpr double kEvenWithoutEdge = 2.0;  // 1/4 grey level

/// Edges plus steps of disparity; 0 where neither exceeds the noise, which would cause most of the basins.
Image<std::uint16_t> with_steps(View<const std::uint16_t> edges, View<const float> disparity_px,
                                float noise_sigma, const Exec& exec) {
  const int least = static_cast<int>(kFlat + kFlatInNoise * noise_sigma);
  const kernels::CueKernels& run = kernels::cue_kernels(exec);
  const int height = edges.height();
  Image<std::uint16_t> sum(edges.size(), exec.pool);
  parallel_for(exec, height, kGrain, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      run.add_steps(edges.row(y),
                    {disparity_px.row(std::max(y - 1, 0)), disparity_px.row(y),
                     disparity_px.row(std::min(y + 1, height - 1))},
                    edges.width(), {kStepWeight, kLargestStep, least}, sum.row(y));
    }
  });
  return sum;
}

/// Merges basins pairwise, by ascending key. No merge makes the key of a border smaller than both that it joins, so
/// two regions that are each other's best neighbour stay so until they merge. Hence they are merged where chains of
/// best neighbours end, which is near in the image and thus in memory, and ordered by key afterwards.
class BasinFuser {
 public:
  BasinFuser(const Basins& basins, View<const std::uint16_t> edges, const Exec& exec)
      : memory_(exec.pool),
        links_(&memory_),
        areas_(slot(basins.count)),
        roots_(slot(basins.count)),
        links_of_(slot(basins.count), -1),
        common_(slot(basins.count), -1) {
    links_.reserve(3 * slot(basins.count));  // a planar graph has no more
    const int width = basins.labels.width();
    for (int y = 0; y < basins.labels.height(); ++y) areas_[index(basins.labels(width - 1, y))] += width;
    for_each_contact(basins.labels, 0, basins.labels.height(), [&](int x, int y, int dx, int dy) {
      const std::int32_t here = number(basins.labels(x, y));
      const std::int32_t there = number(basins.labels(x + dx, y + dy));
      areas_[slot(here)] += dx * (x + 1);  // the run of `there` starts where that of `here` ends
      areas_[slot(there)] -= dx * (x + 1);
      Link& link = link_between(here, there);
      ++link.length;
      link.edge_sum += std::max(edges(x, y), edges(x + dx, y + dy));
    });
    for (std::size_t i = 0; i < areas_.size(); ++i) roots_[i] = std::sqrt(static_cast<double>(areas_[i]));
    merges_.reserve(slot(basins.count));
    if (basins.count > 0) merge();
  }

  /// The number of each basin's superpixel, in the order of their first basins, after all but `count` − 1 merges;
  /// `count` becomes the number of superpixels.
  std::vector<RegionId> numbers(std::int32_t& count) {
    const std::size_t basins = areas_.size();
    const std::size_t made = basins - std::min(basins, slot(count));
    if (made < merges_.size())
      std::nth_element(merges_.begin(), merges_.begin() + static_cast<std::ptrdiff_t>(made), merges_.end());
    std::vector<std::int32_t> parents(basins);
    std::iota(parents.begin(), parents.end(), 0);
    const auto root = [&](std::int32_t basin) {
      while (parents[slot(basin)] != basin)
        basin = parents[slot(basin)] = parents[slot(parents[slot(basin)])];
      return basin;
    };
    for (std::size_t i = 0; i < made; ++i) {
      const std::int32_t p = root(merges_[i].a);
      const std::int32_t q = root(merges_[i].b);
      parents[slot(std::max(p, q))] = std::min(p, q);
    }
    std::vector<RegionId> numbers(basins);
    count = 0;
    for (std::size_t basin = 0; basin < basins; ++basin) {
      const std::size_t first = slot(root(static_cast<std::int32_t>(basin)));
      numbers[basin] = first == basin ? RegionId{count++} : numbers[first];
    }
    return numbers;
  }

 private:
  struct Link {
    std::int32_t a = 0;
    std::int32_t b = 0;
    // The next link in the list of a, and of b; −1 = none.
    std::int32_t next_of_a = -1;
    std::int32_t next_of_b = -1;
    std::int32_t first = 0;   // rank in raster order of first occurrence
    std::int32_t length = 0;  // 0 = the link no longer exists
    std::int64_t edge_sum = 0;
    [[nodiscard]] std::int32_t other(std::int32_t end) const { return a == end ? b : a; }
    [[nodiscard]] std::int32_t& next(std::int32_t end) { return a == end ? next_of_a : next_of_b; }
  };
  struct Merge {
    double key;
    std::int32_t first;
    std::int32_t a;  // regions are numbered like one of their basins
    std::int32_t b;
    bool operator<(const Merge& other) const {
      return key < other.key || (key == other.key && first < other.first);
    }
  };

  Link& link_between(std::int32_t a, std::int32_t b) {
    for (std::int32_t i = links_of_[slot(a)]; i >= 0; i = links_[slot(i)].next(a)) {
      if (links_[slot(i)].other(a) == b) return links_[slot(i)];
    }
    const auto made = static_cast<std::int32_t>(links_.size());
    links_.push_back(
        {a, b, std::exchange(links_of_[slot(a)], made), std::exchange(links_of_[slot(b)], made), made});
    return links_.back();
  }

  /// The best link of a region, −1 if it has none; drops those that no longer exist from its list.
  std::int32_t best_of(std::int32_t region, double& least) {
    std::int32_t best = -1;
    std::int32_t* end = &links_of_[slot(region)];
    const double root = roots_[slot(region)];
    while (*end >= 0) {
      Link& link = links_[slot(*end)];
      if (link.length == 0) {
        *end = link.next(region);
        continue;
      }
      const double edge = static_cast<double>(link.edge_sum) / static_cast<double>(link.length);
      const double key = (edge + kEvenWithoutEdge) * std::min(root, roots_[slot(link.other(region))]);
      if (best < 0 || key < least || (key == least && link.first < links_[slot(best)].first)) {
        best = *end;
        least = key;
      }
      end = &link.next(region);
    }
    return best;
  }

  /// Down to one region: the image is connected.
  void merge() {
    std::vector<std::int32_t> chain{0};
    double key = 0;
    for (std::int32_t best = 0; (best = best_of(chain.back(), key)) >= 0;) {
      const std::int32_t here = chain.back();
      const std::int32_t there = links_[slot(best)].other(here);
      if (chain.size() < 2 || chain[chain.size() - 2] != there) {
        chain.push_back(there);
        continue;
      }
      chain.resize(chain.size() - 2);
      merges_.push_back({key, links_[slot(best)].first, here, there});
      const std::int32_t kept = fuse(best);
      if (chain.empty()) chain.push_back(kept);
    }
  }

  /// Returns the number of the merged region.
  std::int32_t fuse(std::int32_t across) {
    std::int32_t kept = links_[slot(across)].a;
    std::int32_t lost = links_[slot(across)].b;
    if (areas_[slot(kept)] < areas_[slot(lost)])
      std::swap(kept, lost);  // the smaller one usually has fewer links
    links_[slot(across)].length = 0;
    areas_[slot(kept)] += areas_[slot(lost)];
    roots_[slot(kept)] = std::sqrt(static_cast<double>(areas_[slot(kept)]));
    std::int32_t* end = &links_of_[slot(kept)];
    while (*end >= 0) {
      Link& link = links_[slot(*end)];
      if (link.length == 0) {
        *end = link.next(kept);
      } else {
        common_[slot(link.other(kept))] = *end;
        end = &link.next(kept);
      }
    }
    for (std::int32_t next = links_of_[slot(lost)]; next >= 0;) {
      const std::int32_t i = next;
      Link& link = links_[slot(i)];
      next = link.next(lost);
      if (link.length == 0) continue;
      const std::int32_t known = common_[slot(link.other(lost))];
      if (known >= 0) {
        Link& both = links_[slot(known)];
        both.first = std::min(both.first, link.first);
        both.length += std::exchange(link.length, 0);
        both.edge_sum += link.edge_sum;
      } else {
        (link.a == lost ? link.a : link.b) = kept;
        link.next(kept) = std::exchange(links_of_[slot(kept)], i);
      }
    }
    for (std::int32_t i = links_of_[slot(kept)]; i >= 0; i = links_[slot(i)].next(kept))
      common_[slot(links_[slot(i)].other(kept))] = -1;
    return kept;
  }

  PoolMemory memory_;
  std::pmr::vector<Link> links_;
  std::vector<std::int64_t> areas_;     // 0 = merged into another region
  std::vector<double> roots_;           // of the areas
  std::vector<std::int32_t> links_of_;  // the first of each region's list; some of its links may be gone
  std::vector<std::int32_t> common_;    // during a merge: the link with the region that is kept; −1 = none
  std::vector<Merge> merges_;
};

}  // namespace

Image<std::uint16_t> superpixel_edges(const LeftImage& left, const Exec& exec) {
  return edge_strength(left.gray, left.rgb, kSmoothing, exec);
}

Superpixels cut_superpixels(Image<std::uint16_t> edges, View<const float> disparity_px, float noise_sigma,
                            const SuperpixelsConfig& config, const Exec& exec) {
  const Image<std::uint16_t> with_depth = with_steps(edges, disparity_px, noise_sigma, exec);
  Basins basins = watershed(with_depth, exec);
  BasinFuser fusing(basins, with_depth, exec);
  std::int32_t count = config.count;
  const std::vector<RegionId> numbers = fusing.numbers(count);
  for (int y = 0; y < edges.height(); ++y) {
    RegionId* const row = basins.labels.row(y);
    for (int x = 0; x < edges.width(); ++x) row[x] = numbers[index(row[x])];
  }
  return {std::move(basins.labels), count, std::move(edges)};
}

Superpixels cut_superpixels(const LeftImage& left, View<const float> disparity_px,
                            const SuperpixelsConfig& config, const Exec& exec) {
  return cut_superpixels(superpixel_edges(left, exec), disparity_px, left.noise_sigma, config, exec);
}

Segmentation superpixel_regions(const Superpixels& superpixels, View<const Gray> left, const Exec& exec) {
  constexpr int kMaxSummed = 1 << 15;  // pixels: fewer than those at which the kernel's sums overflow
  std::vector<std::uint64_t> up_to(slot(left.width()) + 1);
  return superpixel_regions(
      superpixels.labels.clone(exec.pool), slot(superpixels.count), exec,
      [&](const Run& run, Region& region) {
        if (run.first == 0)
          kernels::label_kernels(exec).sum_grey(left.row(run.y), left.width(), up_to.data());
        region.valid_count += run.length();
        for (int x = run.first; x < run.last; x += kMaxSummed) {
          const std::uint64_t sums = up_to[slot(std::min(x + kMaxSummed, run.last))] - up_to[slot(x)];
          region.mean += static_cast<double>(sums >> 40U);
          region.variance += static_cast<double>(sums & ((std::uint64_t{1} << 40U) - 1));
        }
      });
}

}  // namespace cairn
