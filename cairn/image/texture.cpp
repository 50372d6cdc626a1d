// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <array>
#include <cairn/core/parallel.hpp>
#include <cairn/image/texture.hpp>
#include <cairn/image/texture_kernels.hpp>
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

/// One row of numbers for each shift; too small for the pool.
template <class T>
using RowPerShift = std::array<std::vector<T>, kShifts.size()>;

template <class T>
RowPerShift<T> row_per_shift(int length) {
  RowPerShift<T> rows;
  for (auto& row : rows) row.resize(static_cast<std::size_t>(length));
  return rows;
}

/// Per column x and shift: Σ min((I(q) − I(q+s))², most) over the rows of the window, updated as the window
/// moves down; `radius` zeros on either side.
template <class Sum>
class ColumnSums {
 public:
  ColumnSums(View<const Gray> image, int radius, std::uint16_t most, const kernels::SquareKernels<Sum>& run)
      : image_(image),
        radius_(radius),
        most_(most),
        run_(run),
        sums_(row_per_shift<Sum>(image.width() + 2 * radius)) {}

  void add_row(int y) { for_each_pair(y, run_.add); }
  void remove_row(int y) { for_each_pair(y, run_.remove); }
  /// Starts with the zeros.
  [[nodiscard]] const Sum* of(std::size_t shift) const { return sums_[shift].data(); }

 private:
  void for_each_pair(int y, decltype(kernels::SquareKernels<Sum>::add) update) {
    if (y < 0 || y >= image_.height()) return;
    for (std::size_t s = 0; s < kShifts.size(); ++s) {
      const int other_y = y + kShifts[s].dy;
      if (other_y < 0 || other_y >= image_.height()) continue;
      update(image_.row(y), image_.row(other_y) + kShifts[s].dx, image_.width() - kShifts[s].dx, most_,
             sums_[s].data() + radius_);
    }
  }

  View<const Gray> image_;
  int radius_;
  std::uint16_t most_;
  const kernels::SquareKernels<Sum>& run_;
  RowPerShift<Sum> sums_;
};

/// The number of positions in [p − radius, p + radius] whose pair is inside [0, length).
int pairs_along(int p, int radius, int shift, int length) {
  const int first = std::max({0, -shift, p - radius});
  const int last = std::min({length, length - shift, p + radius + 1});
  return std::max(0, last - first);
}

/// The smallest sum of `count` squares with a mean of at least `threshold`. Exact: 24 bits times 10.
std::uint32_t least_sum(float threshold, int count) {
  return static_cast<std::uint32_t>(std::ceil(double{threshold} * count));
}

constexpr std::uint16_t kMaxSquare = 255 * 255;

/// Squares are clipped to the limit of a whole window: a single one of that size is enough texture for any
/// window.
std::uint16_t most_that_counts(const TextureLimit& limit) {
  const std::uint32_t least = least_sum(limit.threshold, limit.window_size * limit.window_size);
  return static_cast<std::uint16_t>(std::min(least, std::uint32_t{kMaxSquare}));
}

/// Whether sums of up to 31² clipped squares fit 16 bits; 26 bits always suffice.
bool fit_16_bits(const TextureLimit& limit) {
  return std::uint32_t{most_that_counts(limit)} *
             static_cast<std::uint32_t>(limit.window_size * limit.window_size) <=
         0xFFFF;
}

/// Judges rows from top to bottom.
template <class Sum>
class MoravecRows {
 public:
  MoravecRows(View<const Gray> image, const TextureLimit& limit, int first_row,
              const kernels::SquareKernels<Sum>& run)
      : image_(image),
        radius_(limit.window_size / 2),
        threshold_(limit.threshold),
        row_(first_row),
        run_(run),
        columns_(image, radius_, most_that_counts(limit), run_),
        blocks_(2 * static_cast<std::size_t>(image.width() + 2 * radius_ + 1)),
        sums_(static_cast<std::size_t>(image.width())),
        limits_(row_per_shift<Sum>(image.width())) {
    pairs_down_.fill(-1);
    for (int y = first_row - radius_; y < first_row + radius_; ++y) columns_.add_row(y);
  }

  void judge_next(std::uint8_t* low) {
    columns_.add_row(row_ + radius_);
    update_limits();
    std::fill_n(low, image_.width(), std::uint8_t{0});
    for (std::size_t s = 0; s < kShifts.size(); ++s) {
      run_.flag_low(columns_.of(s), image_.width(), 2 * radius_ + 1, limits_[s].data(), blocks_.data(),
                    sums_.data(), low);
    }
    columns_.remove_row(row_ - radius_);
    ++row_;
  }

 private:
  void update_limits() {
    for (std::size_t s = 0; s < kShifts.size(); ++s) {
      const int down = pairs_along(row_, radius_, kShifts[s].dy, image_.height());
      if (down == pairs_down_[s]) continue;
      pairs_down_[s] = down;
      for (int x = 0; x < image_.width(); ++x) {
        limits_[s][static_cast<std::size_t>(x)] = static_cast<Sum>(
            least_sum(threshold_, down * pairs_along(x, radius_, kShifts[s].dx, image_.width())));
      }
    }
  }

  View<const Gray> image_;
  int radius_;
  float threshold_;
  int row_;
  const kernels::SquareKernels<Sum>& run_;
  ColumnSums<Sum> columns_;
  std::vector<Sum> blocks_;  // working memory
  std::vector<Sum> sums_;
  RowPerShift<Sum> limits_;  // the smallest sum that is enough texture
  std::array<int, kShifts.size()> pairs_down_{};
};

template <class Sum>
Image<std::uint8_t> judge(View<const Gray> image, const TextureLimit& limit,
                          const kernels::SquareKernels<Sum>& run, const Exec& exec) {
  Image<std::uint8_t> low(image.size(), exec.pool);
  parallel_for(exec, image.height(), kGrain, [&](int first, int last) {
    MoravecRows<Sum> rows(image, limit, first, run);
    for (int y = first; y < last; ++y) rows.judge_next(low.row(y));
  });
  return low;
}

}  // namespace

Image<std::uint8_t> lacks_texture(View<const Gray> image, const TextureLimit& limit, const Exec& exec) {
  if (image.size() == Size{1, 1}) return Image<std::uint8_t>(image.size(), 1, exec.pool);  // has no pair
  const kernels::TextureKernels& run = kernels::texture_kernels(exec);
  return fit_16_bits(limit) ? judge(image, limit, run.narrow_squares, exec)
                            : judge(image, limit, run.wide_squares, exec);
}

}  // namespace cairn
