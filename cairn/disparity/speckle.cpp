// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/core/disjoint_sets.hpp>
#include <cairn/core/ids.hpp>
#include <cairn/core/parallel.hpp>
#include <cairn/disparity/speckle.hpp>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace cairn {
namespace {

constexpr int kGrain = 64;  // rows

/// Pixels of one row that belong together, [begin, end).
struct Run {
  int begin;
  int end;
};

/// The runs of an image, row by row, and which of them make an island.
class Islands {
 public:
  Islands(View<const float> disparity_px, float range, const Exec& exec)
      : disparity_(disparity_px),
        range_(range),
        row_begin_(count_runs(exec)),
        runs_(static_cast<std::size_t>(row_begin_.back())),
        sets_(runs_.size()),
        island_(runs_.size()) {
    std::vector<char> starts_block(static_cast<std::size_t>(disparity_px.height()), 0);
    parallel_for(exec, disparity_px.height(), kGrain, [&](int first, int last) {
      starts_block[static_cast<std::size_t>(first)] = 1;
      for (int y = first; y < last; ++y) {
        find_runs(y);
        if (y > first) join_with_row_above(y);
      }
    });
    // Blocks were joined inside themselves; what is left are the seams.
    for (int y = 1; y < disparity_px.height(); ++y) {
      if (starts_block[static_cast<std::size_t>(y)] != 0) join_with_row_above(y);
    }
    measure();
  }

  /// Calls visit(begin, end) for each run of row y that belongs to an island of at most `size` pixels.
  template <class Visit>
  void for_each_small(int y, int size, Visit visit) const {
    for (int i = row_begin(y); i < row_begin(y + 1); ++i) {
      if (pixels_[slot(island_[slot(i)])] <= size) visit(run(i).begin, run(i).end);
    }
  }

 private:
  [[nodiscard]] bool linked(float d, float other) const {
    return std::abs(d - other) <= range_;
  }  // never with NaN
  [[nodiscard]] int row_begin(int y) const { return row_begin_[static_cast<std::size_t>(y)]; }
  [[nodiscard]] Run& run(int i) { return runs_[static_cast<std::size_t>(i)]; }
  [[nodiscard]] const Run& run(int i) const { return runs_[static_cast<std::size_t>(i)]; }

  /// How many runs begin above each row, and above the end.
  [[nodiscard]] std::vector<int> count_runs(const Exec& exec) const {
    std::vector<int> begin(static_cast<std::size_t>(disparity_.height()) + 1);
    parallel_for(exec, disparity_.height(), kGrain, [&](int first, int last) {
      for (int y = first; y < last; ++y) {
        const float* const d = disparity_.row(y);
        int count = std::isnan(d[0]) ? 0 : 1;
        for (int x = 1; x < disparity_.width(); ++x) {
          count += static_cast<int>(d[x] == d[x]) & static_cast<int>(!linked(d[x], d[x - 1]));
        }
        begin[slot(y) + 1] = count;
      }
    });
    for (std::size_t y = 1; y < begin.size(); ++y) begin[y] += begin[y - 1];
    return begin;
  }

  void find_runs(int y) {
    const float* const d = disparity_.row(y);
    const int width = disparity_.width();
    int i = row_begin(y);
    for (int x = 0; x < width;) {
      if (std::isnan(d[x])) {
        ++x;
        continue;
      }
      const int begin = x++;
      while (x < width && linked(d[x], d[x - 1])) ++x;
      run(i++) = {begin, x};
    }
  }

  void join_with_row_above(int y) {
    const float* const above = disparity_.row(y - 1);
    const float* const here = disparity_.row(y);
    int i = row_begin(y - 1);
    int j = row_begin(y);
    while (i < row_begin(y) && j < row_begin(y + 1)) {
      const int end = std::min(run(i).end, run(j).end);
      for (int x = std::max(run(i).begin, run(j).begin); x < end; ++x) {
        if (!linked(above[x], here[x])) continue;
        sets_.unite(i, j);
        break;  // once is enough for two runs
      }
      if (run(i).end == end) {
        ++i;
      } else {
        ++j;
      }
    }
  }

  void measure() {
    pixels_.resize(slot(sets_.number(island_.data())));
    for (std::size_t i = 0; i < runs_.size(); ++i) pixels_[slot(island_[i])] += runs_[i].end - runs_[i].begin;
  }

  View<const float> disparity_;
  float range_;
  std::vector<int> row_begin_;
  std::vector<Run> runs_;
  DisjointSets sets_;                 // of runs: the islands
  std::vector<std::int32_t> island_;  // of each run
  std::vector<int> pixels_;           // of each island
};

}  // namespace

DisparityMap reject_speckles(DisparityMap disparity, const SpeckleConfig& config, const Exec& exec) {
  if (config.size <= 0 || disparity.disparity_px.empty()) return disparity;
  const Islands islands(disparity.disparity_px, config.range, exec);
  parallel_for(exec, disparity.disparity_px.height(), kGrain, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      islands.for_each_small(y, config.size, [&](int begin, int end) {
        for (int x = begin; x < end; ++x) {
          disparity.disparity_px(x, y) = std::numeric_limits<float>::quiet_NaN();
          disparity.reject(x, y) |= Reject::speckle;
        }
      });
    }
  });
  return disparity;
}

}  // namespace cairn
