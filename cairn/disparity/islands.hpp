// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <algorithm>
#include <cairn/core/disjoint_sets.hpp>
#include <cairn/core/geometry.hpp>
#include <cairn/core/ids.hpp>
#include <cairn/core/parallel.hpp>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace cairn {

/// The 4-connected components of an image. `rows(y)` describes row y: row.is_pixel(x) whether x belongs to
/// any island; row.follows(x) whether x and x − 1 are such pixels and connected; row.joins(above, x) whether
/// x is connected to the pixel above, both being such pixels. Islands are numbered by their first pixels in
/// raster order. Private to the library.
template <class Rows>
class Islands {
 public:
  Islands(Size size, Rows rows, const Exec& exec)
      : size_(size),
        rows_(rows),
        row_begin_(count_runs(exec)),
        runs_(slot(row_begin_.back())),
        sets_(runs_.size()),
        island_(runs_.size()) {
    std::vector<char> starts_block(slot(size.height), 0);
    parallel_for(exec, size.height, kGrain, [&](int first, int last) {
      starts_block[slot(first)] = 1;
      for (int y = first; y < last; ++y) {
        find_runs(y);
        if (y > first) join_with_row_above(y);
      }
    });
    // Each block is joined internally; the seams between blocks remain.
    for (int y = 1; y < size.height; ++y) {
      if (starts_block[slot(y)] != 0) join_with_row_above(y);
    }
    measure();
  }

  [[nodiscard]] std::size_t count() const { return pixels_.size(); }
  [[nodiscard]] int pixels(std::int32_t island) const { return pixels_[slot(island)]; }

  /// Calls visit(island, begin, end) for each run of row y, from left to right.
  template <class Visit>
  void for_each_run(int y, Visit visit) const {
    for (int i = row_begin(y); i < row_begin(y + 1); ++i) visit(island_[slot(i)], run(i).begin, run(i).end);
  }

 private:
  static constexpr int kGrain = 64;  // rows

  /// A run of connected pixels in one row, [begin, end).
  struct Run {
    int begin;
    int end;
  };

  [[nodiscard]] int row_begin(int y) const { return row_begin_[slot(y)]; }
  [[nodiscard]] Run& run(int i) { return runs_[slot(i)]; }
  [[nodiscard]] const Run& run(int i) const { return runs_[slot(i)]; }

  /// Number of runs above each row, and in all.
  [[nodiscard]] std::vector<int> count_runs(const Exec& exec) const {
    std::vector<int> begin(slot(size_.height) + 1);
    parallel_for(exec, size_.height, kGrain, [&](int first, int last) {
      for (int y = first; y < last; ++y) {
        const auto row = rows_(y);
        int count = row.is_pixel(0) ? 1 : 0;
        for (int x = 1; x < size_.width; ++x)
          count += static_cast<int>(row.is_pixel(x)) & static_cast<int>(!row.follows(x));
        begin[slot(y) + 1] = count;
      }
    });
    for (std::size_t y = 1; y < begin.size(); ++y) begin[y] += begin[y - 1];
    return begin;
  }

  void find_runs(int y) {
    const auto row = rows_(y);
    int i = row_begin(y);
    for (int x = 0; x < size_.width;) {
      if (!row.is_pixel(x)) {
        ++x;
        continue;
      }
      const int begin = x++;
      while (x < size_.width && row.follows(x)) ++x;
      run(i++) = {begin, x};
    }
  }

  void join_with_row_above(int y) {
    const auto above = rows_(y - 1);
    const auto here = rows_(y);
    int i = row_begin(y - 1);
    int j = row_begin(y);
    while (i < row_begin(y) && j < row_begin(y + 1)) {
      const int end = std::min(run(i).end, run(j).end);
      for (int x = std::max(run(i).begin, run(j).begin); x < end; ++x) {
        if (!here.joins(above, x)) continue;
        sets_.unite(i, j);
        break;  // two runs need joining once only
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

  Size size_;
  Rows rows_;
  std::vector<int> row_begin_;
  std::vector<Run> runs_;
  DisjointSets sets_;                 // of runs: the islands
  std::vector<std::int32_t> island_;  // of each run
  std::vector<int> pixels_;           // of each island
};

}  // namespace cairn
