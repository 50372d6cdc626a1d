// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <bit>
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
#include <queue>
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

/// Merges basins pairwise.
class BasinFuser {
 public:
  BasinFuser(const Basins& basins, View<const std::uint16_t> edges, const Exec& exec)
      : memory_(exec.pool),
        links_(&memory_),
        left_(basins.count),
        areas_(slot(basins.count)),
        parents_(slot(basins.count)),
        links_of_(slot(basins.count), -1),
        common_(slot(basins.count), -1) {
    std::iota(parents_.begin(), parents_.end(), 0);
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
    std::pmr::vector<Entry> all(&memory_);
    all.reserve(2 * links_.size());
    for (std::int32_t i = 0; slot(i) < links_.size(); ++i)
      all.push_back(links_[slot(i)].queued = entry_of(i));
    queue_ = Queue({}, std::move(all));
  }

  void until(int count) {
    while (left_ > count && !queue_.empty()) {
      const Entry next = queue_.top();
      queue_.pop();
      const Link& link = links_[slot(next.link())];
      if (link.queued != next) continue;  // stale: queued again with another key, or gone
      // Keys only grow as regions grow, so no entry is queued too late.
      const Entry now = entry_of(next.link());
      if (now == next) {
        fuse(next.link());
      } else {
        queue(now);
      }
    }
  }

  /// The number of each basin's superpixel, in the order of their first basins; `count`: of superpixels.
  std::vector<RegionId> numbers(std::int32_t& count) {
    std::vector<RegionId> numbers(parents_.size(), RegionId{-1});
    count = 0;
    for (std::size_t basin = 0; basin < numbers.size(); ++basin) {
      RegionId& of_root = numbers[slot(root(static_cast<std::int32_t>(basin)))];
      // The root may come later than the first of its basins.
      if (number(of_root) < 0) of_root = RegionId{count++};
      numbers[basin] = of_root;
    }
    return numbers;
  }

 private:
  /// In the order of merging: by key, then by first occurrence. Integers are compared, without branches, because
  /// the processor cannot predict which of two entries is later.
  class Entry {
   public:
    Entry() = default;
    Entry(double key, std::int32_t first, std::int32_t link)
        : key_(std::bit_cast<std::uint64_t>(key)),  // ordered as the keys are, which are not negative
          rest_((static_cast<std::uint64_t>(first) << 32U) | static_cast<std::uint32_t>(link)) {}
    [[nodiscard]] std::int32_t link() const { return static_cast<std::int32_t>(rest_ & UINT32_MAX); }
    friend bool operator==(const Entry&, const Entry&) = default;
    bool operator<(const Entry& other) const {  // the greatest is at the top of the queue
      return ((key_ > other.key_) | ((key_ == other.key_) & (rest_ > other.rest_))) != 0;
    }

   private:
    std::uint64_t key_ = 0;
    std::uint64_t rest_ = 0;
  };
  struct Link {
    std::int32_t a = 0;
    std::int32_t b = 0;
    // The next link in the list of a, and of b; −1 = none.
    std::int32_t next_of_a = -1;
    std::int32_t next_of_b = -1;
    std::int32_t first = 0;  // rank in raster order of first occurrence
    std::int32_t length = 0;
    std::int64_t edge_sum = 0;
    Entry queued{};  // its valid entry in the queue; Entry() = the link no longer exists
    [[nodiscard]] bool is_gone() const { return queued == Entry(); }
    [[nodiscard]] std::int32_t other(std::int32_t end) const { return a == end ? b : a; }
    [[nodiscard]] std::int32_t& next(std::int32_t end) { return a == end ? next_of_a : next_of_b; }
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

  std::int32_t root(std::int32_t basin) {
    while (parents_[slot(basin)] != basin) {
      parents_[slot(basin)] = parents_[slot(parents_[slot(basin)])];
      basin = parents_[slot(basin)];
    }
    return basin;
  }

  [[nodiscard]] Entry entry_of(std::int32_t i) const {
    const Link& link = links_[slot(i)];
    const auto area = static_cast<double>(std::min(areas_[slot(link.a)], areas_[slot(link.b)]));
    const double edge = static_cast<double>(link.edge_sum) / static_cast<double>(link.length);
    return {(edge + kEvenWithoutEdge) * std::sqrt(area), link.first, i};
  }
  void queue(const Entry& entry) {
    links_[slot(entry.link())].queued = entry;
    queue_.push(entry);
  }

  void fuse(std::int32_t across) {
    std::int32_t kept = links_[slot(across)].a;
    std::int32_t lost = links_[slot(across)].b;
    if (areas_[slot(kept)] < areas_[slot(lost)])
      std::swap(kept, lost);  // the smaller one usually has fewer links
    links_[slot(across)].queued = {};
    parents_[slot(lost)] = kept;
    areas_[slot(kept)] += areas_[slot(lost)];
    --left_;
    std::int32_t* end = &links_of_[slot(kept)];
    while (*end >= 0) {
      Link& link = links_[slot(*end)];
      if (link.is_gone()) {
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
      if (link.is_gone()) continue;
      const std::int32_t known = common_[slot(link.other(lost))];
      if (known >= 0) {
        Link& both = links_[slot(known)];
        both.first = std::min(both.first, link.first);
        both.length += link.length;
        both.edge_sum += link.edge_sum;
        link.queued = {};
        // An entry that is too early is queued again when its turn comes; only one that is too late must be
        // replaced.
        const Entry now = entry_of(known);
        if (both.queued < now) queue(now);
      } else {
        (link.a == lost ? link.a : link.b) = kept;
        link.next(kept) = std::exchange(links_of_[slot(kept)], i);
      }
    }
    for (std::int32_t i = links_of_[slot(kept)]; i >= 0; i = links_[slot(i)].next(kept))
      common_[slot(links_[slot(i)].other(kept))] = -1;
  }

  using Queue = std::priority_queue<Entry, std::pmr::vector<Entry>>;

  PoolMemory memory_;
  std::pmr::vector<Link> links_;
  int left_;
  std::vector<std::int64_t> areas_;
  std::vector<std::int32_t> parents_;
  std::vector<std::int32_t> links_of_;  // the first of each basin's list; some of its links may be gone
  std::vector<std::int32_t> common_;    // during a merge: the link with the basin that is kept; −1 = none
  Queue queue_{{}, std::pmr::vector<Entry>(&memory_)};
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
  fusing.until(config.count);
  std::int32_t count = 0;
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
