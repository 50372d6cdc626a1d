// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/core/parallel.hpp>
#include <cairn/disparity/speckle.hpp>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

namespace cairn {
namespace {

constexpr int kGrain = 64;  // rows

/// Pixels of one row that belong together, [begin, end).
struct Run {
  int begin;
  int end;
  // Of the first run of an island: −(pixels of the island). Of any other: a run that is nearer to the first.
  int parent;
};

/// The runs of an image, row by row, as a forest: each tree is one island.
class Islands {
 public:
  Islands(View<const float> disparity_px, float range, const Exec& exec)
      : disparity_(disparity_px),
        range_(range),
        row_begin_(static_cast<std::size_t>(disparity_px.height()) + 1) {
    count_runs(exec);
    runs_.resize(static_cast<std::size_t>(row_begin_.back()));
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
  }

  /// Calls visit(begin, end) for each run of row y that belongs to an island of at most `size` pixels.
  template <class Visit>
  void for_each_small(int y, int size, Visit visit) const {
    for (int i = row_begin(y); i < row_begin(y + 1); ++i) {
      int root = i;
      while (run(root).parent >= 0) root = run(root).parent;
      if (-run(root).parent <= size) visit(run(i).begin, run(i).end);
    }
  }

 private:
  [[nodiscard]] bool linked(float d, float other) const {
    return std::abs(d - other) <= range_;
  }  // never with NaN
  [[nodiscard]] int row_begin(int y) const { return row_begin_[static_cast<std::size_t>(y)]; }
  [[nodiscard]] Run& run(int i) { return runs_[static_cast<std::size_t>(i)]; }
  [[nodiscard]] const Run& run(int i) const { return runs_[static_cast<std::size_t>(i)]; }

  void count_runs(const Exec& exec) {
    parallel_for(exec, disparity_.height(), kGrain, [&](int first, int last) {
      for (int y = first; y < last; ++y) {
        const float* const d = disparity_.row(y);
        int count = std::isnan(d[0]) ? 0 : 1;
        for (int x = 1; x < disparity_.width(); ++x) {
          count += static_cast<int>(d[x] == d[x]) & static_cast<int>(!linked(d[x], d[x - 1]));
        }
        row_begin_[static_cast<std::size_t>(y) + 1] = count;
      }
    });
    for (std::size_t y = 1; y < row_begin_.size(); ++y) row_begin_[y] += row_begin_[y - 1];
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
      run(i++) = {begin, x, begin - x};
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
        join(i, j);
        break;  // once is enough for two runs
      }
      if (run(i).end == end) {
        ++i;
      } else {
        ++j;
      }
    }
  }

  int root(int i) {
    while (run(i).parent >= 0) {
      const int parent = run(i).parent;
      if (run(parent).parent >= 0) run(i).parent = run(parent).parent;
      i = parent;
    }
    return i;
  }

  void join(int i, int j) {
    int first = root(i);
    int second = root(j);
    if (first == second) return;
    if (second < first) std::swap(first, second);
    run(first).parent += run(second).parent;
    run(second).parent = first;
  }

  View<const float> disparity_;
  float range_;
  std::vector<int> row_begin_;
  std::vector<Run> runs_;
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
