// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/core/parallel.hpp>
#include <cairn/grouping/cue_kernels.hpp>
#include <cairn/grouping/segmentation_of.hpp>
#include <cairn/grouping/superpixels.hpp>
#include <cairn/image/gradient.hpp>
#include <cairn/regions/label_kernels.hpp>
#include <cairn/regions/watershed.hpp>
#include <cmath>
#include <cstdint>
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
constexpr float kFlat = 4.0F;             // 1/4 grey level; a weaker edge is none …
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
      run.add_steps(edges.row(y), disparity_px.row(std::max(y - 1, 0)), disparity_px.row(y),
                    disparity_px.row(std::min(y + 1, height - 1)), edges.width(), kStepWeight, kLargestStep,
                    least, sum.row(y));
    }
  });
  return sum;
}

/// Merges basins pairwise.
class Fusing {
 public:
  Fusing(const Basins& basins, View<const std::uint16_t> edges) : left_(basins.count) {
    const auto count = slot(basins.count);
    areas_.assign(count, 0);
    for (int y = 0; y < basins.labels.height(); ++y) {
      for (int x = 0; x < basins.labels.width(); ++x) ++areas_[index(basins.labels(x, y))];
    }
    parents_.resize(count);
    std::iota(parents_.begin(), parents_.end(), 0);
    common_.assign(count, -1);
    links_of_.resize(count);
    const Size size = basins.labels.size();
    for (int y = 0; y < size.height; ++y) {
      const RegionId* const row = basins.labels.row(y);
      const RegionId* const below = y + 1 < size.height ? basins.labels.row(y + 1) : row;
      for (int x = 0; x < size.width; ++x) {
        if (x + 1 < size.width && row[x + 1] != row[x]) meet(row[x], row[x + 1], edges, {x, y}, {x + 1, y});
        if (below[x] != row[x]) meet(row[x], below[x], edges, {x, y}, {x, y + 1});
      }
    }
    std::vector<Entry> all;
    all.reserve(2 * links_.size());
    for (std::int32_t i = 0; slot(i) < links_.size(); ++i) all.push_back(entry(i, key_of(i)));
    queue_ = std::priority_queue<Entry>({}, std::move(all));
  }

  void until(int count) {
    while (left_ > count && !queue_.empty()) {
      const Entry next = queue_.top();
      queue_.pop();
      const Link& link = links_[slot(next.link)];
      // Stale: queued again with another key, or gone.
      if (link.queued_key != next.key || link.queued_first != next.first) continue;
      // Keys only grow as regions grow, so no entry is queued too late.
      const double key = key_of(next.link);
      if (key == next.key && link.first == next.first) {
        fuse(next.link);
      } else {
        queue(next.link, key);
      }
    }
  }

  /// The basin that `basin` has been merged into.
  std::int32_t root(std::int32_t basin) {
    while (parents_[slot(basin)] != basin) {
      parents_[slot(basin)] = parents_[slot(parents_[slot(basin)])];
      basin = parents_[slot(basin)];
    }
    return basin;
  }

 private:
  struct Link {
    std::int32_t a = 0;
    std::int32_t b = 0;
    std::int32_t first = 0;  // rank in raster order of first occurrence
    std::int64_t length = 0;
    std::int64_t edge_sum = 0;
    std::int32_t queued_first = 0;  // −1: the link no longer exists
    double queued_key = 0;
    [[nodiscard]] bool is_gone() const { return queued_first < 0; }
    [[nodiscard]] std::int32_t other(std::int32_t end) const { return a == end ? b : a; }
  };
  struct Entry {
    double key;
    std::int32_t first;
    std::int32_t link;
    bool operator<(const Entry& other) const {  // the greatest is at the top of the queue
      return is_after(key, first, other.key, other.first);
    }
  };

  /// Without branches, because the processor cannot predict which of two entries is later.
  static bool is_after(double key, std::int32_t first, double other_key, std::int32_t other_first) {
    return ((key > other_key) | ((key == other_key) & (first > other_first))) != 0;
  }

  void meet(RegionId a, RegionId b, View<const std::uint16_t> edges, Point p, Point q) {
    Link& link = link_between(number(a), number(b));
    ++link.length;
    link.edge_sum += std::max(edges(p.x, p.y), edges(q.x, q.y));
  }
  Link& link_between(std::int32_t a, std::int32_t b) {
    // From the end: the link met last is the likeliest to be met again.
    const std::vector<std::int32_t>& known = links_of_[slot(a)];
    const auto met = std::find_if(known.rbegin(), known.rend(),
                                  [&](std::int32_t i) { return links_[slot(i)].other(a) == b; });
    if (met != known.rend()) return links_[slot(*met)];
    const auto next = static_cast<std::int32_t>(links_.size());
    links_of_[slot(a)].push_back(next);
    links_of_[slot(b)].push_back(next);
    links_.push_back({a, b, next});
    return links_.back();
  }

  [[nodiscard]] double key_of(std::int32_t i) const {
    const Link& link = links_[slot(i)];
    const auto area = static_cast<double>(std::min(areas_[slot(link.a)], areas_[slot(link.b)]));
    const double edge = static_cast<double>(link.edge_sum) / static_cast<double>(link.length);
    return (edge + kEvenWithoutEdge) * std::sqrt(area);
  }
  /// Notes that link i is queued.
  Entry entry(std::int32_t i, double key) {
    Link& link = links_[slot(i)];
    link.queued_key = key;
    link.queued_first = link.first;
    return {key, link.first, i};
  }
  void queue(std::int32_t i, double key) { queue_.push(entry(i, key)); }

  void fuse(std::int32_t across) {
    std::int32_t kept = links_[slot(across)].a;
    std::int32_t lost = links_[slot(across)].b;
    if (links_of_[slot(kept)].size() < links_of_[slot(lost)].size()) std::swap(kept, lost);
    links_[slot(across)].queued_first = -1;
    parents_[slot(lost)] = kept;
    areas_[slot(kept)] += areas_[slot(lost)];
    --left_;
    std::vector<std::int32_t>& links = links_of_[slot(kept)];
    std::erase_if(links, [&](std::int32_t i) { return links_[slot(i)].is_gone(); });
    for (const std::int32_t i : links) common_[slot(links_[slot(i)].other(kept))] = i;
    for (const std::int32_t i : links_of_[slot(lost)]) {
      Link& link = links_[slot(i)];
      if (link.is_gone()) continue;
      const std::int32_t known = common_[slot(link.other(lost))];
      if (known >= 0) {
        Link& both = links_[slot(known)];
        both.first = std::min(both.first, link.first);
        both.length += link.length;
        both.edge_sum += link.edge_sum;
        link.queued_first = -1;
        // An entry that is too early is queued again when its turn comes; only one that is too late must be
        // replaced.
        const double key = key_of(known);
        if (is_after(both.queued_key, both.queued_first, key, both.first)) queue(known, key);
      } else {
        (link.a == lost ? link.a : link.b) = kept;
        links.push_back(i);
      }
    }
    links_of_[slot(lost)] = {};
    for (const std::int32_t i : links) common_[slot(links_[slot(i)].other(kept))] = -1;
  }

  int left_;
  std::vector<std::int64_t> areas_;
  std::vector<std::int32_t> parents_;
  std::vector<Link> links_;
  std::vector<std::vector<std::int32_t>> links_of_;
  std::vector<std::int32_t> common_;  // during a merge: the link with the basin that is kept; −1 = none
  std::priority_queue<Entry> queue_;
};

}  // namespace

Image<std::uint16_t> superpixel_edges(View<const Gray> gray, View<const Rgb> rgb, const Exec& exec) {
  return edge_strength(gray, rgb, kSmoothing, exec);
}

Superpixels cut_superpixels(Image<std::uint16_t> edges, View<const float> disparity_px, float noise_sigma,
                            const SuperpixelsConfig& config, const Exec& exec) {
  const Image<std::uint16_t> with_depth = with_steps(edges, disparity_px, noise_sigma, exec);
  Basins basins = watershed(with_depth, exec);
  Fusing fusing(basins, with_depth);
  fusing.until(config.count);
  std::vector<std::int32_t> numbers(slot(basins.count), -1);
  std::int32_t count = 0;
  for (int y = 0; y < edges.height(); ++y) {
    RegionId* const row = basins.labels.row(y);
    for (int x = 0; x < edges.width(); ++x) {
      std::int32_t& number_of = numbers[slot(fusing.root(number(row[x])))];
      if (number_of < 0) number_of = count++;
      row[x] = RegionId{number_of};
    }
  }
  return {std::move(basins.labels), count, std::move(edges)};
}

Superpixels cut_superpixels(View<const Gray> gray, View<const Rgb> rgb, View<const float> disparity_px,
                            float noise_sigma, const SuperpixelsConfig& config, const Exec& exec) {
  return cut_superpixels(superpixel_edges(gray, rgb, exec), disparity_px, noise_sigma, config, exec);
}

Segmentation segmentation_of(const Superpixels& superpixels, View<const Gray> left, const Exec& exec) {
  constexpr int kMostSummed = 1 << 15;  // pixels: fewer than those at which the kernel's sums overflow
  std::vector<std::uint64_t> up_to(slot(left.width()) + 1);
  return segmentation_of(
      superpixels.labels.clone(exec.pool), slot(superpixels.count), exec,
      [&](const Run& run, Region& region) {
        if (run.first == 0)
          kernels::label_kernels(exec).sum_grey(left.row(run.y), left.width(), up_to.data());
        region.valid_count += run.length();
        for (int x = run.first; x < run.last; x += kMostSummed) {
          const std::uint64_t sums = up_to[slot(std::min(x + kMostSummed, run.last))] - up_to[slot(x)];
          region.mean += static_cast<double>(sums >> 40U);
          region.variance += static_cast<double>(sums & ((std::uint64_t{1} << 40U) - 1));
        }
      });
}

}  // namespace cairn
