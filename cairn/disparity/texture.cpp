// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <array>
#include <cairn/core/parallel.hpp>
#include <cairn/disparity/texture.hpp>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace cairn {
namespace {

struct Shift {
  int dx;
  int dy;
};
constexpr std::array kShifts{Shift{1, 0}, Shift{0, 1}, Shift{1, 1}, Shift{1, -1}};

constexpr int kGrain = 48;  // rows; each range first sums a whole window's height

/// One row of numbers for each shift; too small to be worth a place in the pool.
template <class T>
using RowPerShift = std::array<std::vector<T>, kShifts.size()>;

template <class T>
RowPerShift<T> row_per_shift(int length) {
  RowPerShift<T> rows;
  for (auto& row : rows) row.resize(static_cast<std::size_t>(length));
  return rows;
}

/// Per column x and shift: Σ (I(q) − I(q+s))² over the rows of the window, kept up to date as the window
/// moves down. A column sum has at most 31·255² < 2²¹, a window's 2²⁶.
class ColumnSums {
 public:
  explicit ColumnSums(View<const Gray> image)
      : image_(image), sums_(row_per_shift<std::uint32_t>(image.width())) {}

  void add_row(int y) {
    for_each_pair(y, [](std::uint32_t sum, std::uint32_t square) { return sum + square; });
  }
  void remove_row(int y) {
    for_each_pair(y, [](std::uint32_t sum, std::uint32_t square) { return sum - square; });
  }
  [[nodiscard]] const std::uint32_t* of(std::size_t shift) const { return sums_[shift].data(); }

 private:
  template <class Update>
  void for_each_pair(int y, Update update) {
    if (y < 0 || y >= image_.height()) return;
    for (std::size_t s = 0; s < kShifts.size(); ++s) {
      const int other_y = y + kShifts[s].dy;
      if (other_y < 0 || other_y >= image_.height()) continue;
      const Gray* const here = image_.row(y);
      const Gray* const there = image_.row(other_y) + kShifts[s].dx;
      std::uint32_t* const sums = sums_[s].data();
      const int pairs = image_.width() - kShifts[s].dx;
      for (int x = 0; x < pairs; ++x) {
        // 16 bits hold the square of a difference of bytes, and multiply twice as many at once.
        const auto difference = static_cast<std::int16_t>(here[x] - there[x]);
        sums[x] = update(sums[x], static_cast<std::uint16_t>(difference * difference));
      }
    }
  }

  View<const Gray> image_;
  RowPerShift<std::uint32_t> sums_;
};

/// How many of [p − radius, p + radius] begin a pair that ends inside [0, length).
int pairs_along(int p, int radius, int shift, int length) {
  const int first = std::max({0, -shift, p - radius});
  const int last = std::min({length, length - shift, p + radius + 1});
  return std::max(0, last - first);
}

/// The least sum of `count` squares that is not below a mean of `threshold`. Exact: 24 bits times 10.
std::int32_t least_sum(float threshold, int count) {
  return static_cast<std::int32_t>(std::ceil(double{threshold} * count));
}

/// Judges rows from the top down.
class MoravecRows {
 public:
  MoravecRows(View<const Gray> image, const TextureConfig& config, int first_row)
      : image_(image),
        radius_(config.window_size / 2),
        threshold_(config.threshold),
        row_(first_row),
        columns_(image),
        prefixes_(row_per_shift<std::uint32_t>(image.width() + 2 * radius_ + 1)),
        limits_(row_per_shift<std::int32_t>(image.width())) {
    pairs_down_.fill(-1);
    for (int y = first_row - radius_; y < first_row + radius_; ++y) columns_.add_row(y);
  }

  void judge_next(Reject* verdict) {
    columns_.add_row(row_ + radius_);
    update_prefixes();
    update_limits();
    compare(verdict);
    columns_.remove_row(row_ - radius_);
    ++row_;
  }

 private:
  // prefix[x + radius + 1] = Σ columns[0 … x], the ends continued: a window's sum is the difference of two
  // prefixes, modulo 2³², and no pixel at the border needs a case of its own.
  void update_prefixes() {
    const int width = image_.width();
    const int offset = radius_ + 1;
    const std::array from{columns_.of(0), columns_.of(1), columns_.of(2), columns_.of(3)};
    const std::array to{prefixes_[0].data() + offset, prefixes_[1].data() + offset,
                        prefixes_[2].data() + offset, prefixes_[3].data() + offset};
    std::array<std::uint32_t, 4> sum{};
    for (int x = 0; x < width; ++x) {  // four chains at once: each alone would wait for its own additions
      to[0][x] = sum[0] += from[0][x];
      to[1][x] = sum[1] += from[1][x];
      to[2][x] = sum[2] += from[2][x];
      to[3][x] = sum[3] += from[3][x];
    }
    for (std::size_t s = 0; s < to.size(); ++s) std::fill_n(to[s] + width, radius_, sum[s]);
  }

  void update_limits() {
    for (std::size_t s = 0; s < kShifts.size(); ++s) {
      const int down = pairs_along(row_, radius_, kShifts[s].dy, image_.height());
      if (down == pairs_down_[s]) continue;
      pairs_down_[s] = down;
      for (int x = 0; x < image_.width(); ++x) {
        limits_[s][static_cast<std::size_t>(x)] =
            least_sum(threshold_, down * pairs_along(x, radius_, kShifts[s].dx, image_.width()));
      }
    }
  }

  void compare(Reject* verdict) const {
    const int width = image_.width();
    const int window = 2 * radius_ + 1;
    std::fill_n(verdict, width, Reject::none);
    for (std::size_t s = 0; s < kShifts.size(); ++s) {
      const std::uint32_t* const prefix = prefixes_[s].data();
      const std::int32_t* const limit = limits_[s].data();
      for (int x = 0; x < width; ++x) {
        const auto sum = static_cast<std::int32_t>(prefix[x + window] - prefix[x]);
        verdict[x] |= sum < limit[x] ? Reject::no_texture : Reject::none;
      }
    }
  }

  View<const Gray> image_;
  int radius_;
  float threshold_;
  int row_;
  ColumnSums columns_;
  RowPerShift<std::uint32_t> prefixes_;
  RowPerShift<std::int32_t> limits_;  // the least sum that is enough texture
  std::array<int, kShifts.size()> pairs_down_{};
};

}  // namespace

Image<Reject> reject_textureless(View<const Gray> left, const TextureConfig& config, const Exec& exec) {
  if (config.threshold < 0) return Image<Reject>(left.size(), Reject::none, exec.pool);
  if (left.size() == Size{1, 1})
    return Image<Reject>(left.size(), Reject::no_texture, exec.pool);  // not one pair
  Image<Reject> verdict(left.size(), exec.pool);
  parallel_for(exec, left.height(), kGrain, [&](int first, int last) {
    MoravecRows rows(left, config, first);
    for (int y = first; y < last; ++y) rows.judge_next(verdict.row(y));
  });
  return verdict;
}

}  // namespace cairn
