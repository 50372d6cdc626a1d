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
/// any island; row.follows(x) whether x, too, is such a pixel and connected to x − 1, which is one;
/// row.joins(above, x) whether x is connected to the pixel above, both being such pixels. Islands are numbered by
/// their first pixels in raster order. Private to the library.
template <class Rows>
class Islands {
 public:
  Islands(Size size, Rows rows, const Exec& exec)
      : size_(size),
        rows_(rows),
        row_begin_(slot(size.height) + 1),
        runs_(find_runs(exec)),
        sets_(runs_.size()),
        island_(runs_.size()) {
    parallel_for(exec, blocks(), 1, [&](int first, int last) {
      for (int block = first; block < last; ++block) {
        for (int y = begin_of(block) + 1; y < begin_of(block + 1); ++y) join_with_row_above(y);
      }
    });
    // Each block is joined internally; the seams between blocks remain.
    for (int block = 1; block < blocks(); ++block) join_with_row_above(begin_of(block));
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
  // Blocks of rows are searched at the same time.
  static constexpr int kBlock = 64;  // rows
  [[nodiscard]] int blocks() const { return (size_.height + kBlock - 1) / kBlock; }
  [[nodiscard]] int begin_of(int block) const { return std::min(kBlock * block, size_.height); }

  /// A run of connected pixels in one row, [begin, end).
  struct Run {
    int begin;
    int end;
  };

  [[nodiscard]] int row_begin(int y) const { return row_begin_[slot(y)]; }
  [[nodiscard]] const Run& run(int i) const { return runs_[slot(i)]; }

  /// The runs of all rows; also finds where those of each row begin.
  std::vector<Run> find_runs(const Exec& exec) {
    std::vector<std::vector<Run>> found(slot(blocks()));
    parallel_for(exec, blocks(), 1, [&](int first, int last) {
      for (int block = first; block < last; ++block) {
        std::vector<Run>& runs = found[slot(block)];
        for (int y = begin_of(block); y < begin_of(block + 1); ++y) {
          find_runs(y, runs);
          row_begin_[slot(y) + 1] = static_cast<int>(runs.size());
        }
      }
    });
    std::vector<Run> all;
    for (int block = 0; block < blocks(); ++block) {
      const std::vector<Run>& runs = found[slot(block)];
      for (int y = begin_of(block); y < begin_of(block + 1); ++y)
        row_begin_[slot(y) + 1] += static_cast<int>(all.size());
      all.insert(all.end(), runs.begin(), runs.end());
    }
    return all;
  }

  void find_runs(int y, std::vector<Run>& runs) const {
    const auto row = rows_(y);
    const int width = size_.width;
    for (int x = 0; x < width;) {
      if (!row.is_pixel(x)) {
        ++x;
        continue;
      }
      const int begin = x++;
      while (x < width && row.follows(x)) ++x;
      runs.push_back({begin, x});
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
