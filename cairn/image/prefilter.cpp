// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/core/parallel.hpp>
#include <cairn/image/prefilter.hpp>
#include <cairn/image/prefilter_kernels.hpp>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace cairn {
namespace {

int mirrored(int y, int height) {
  if (height == 1) return 0;
  if (y < 0) return 1;
  return y < height ? y : height - 2;
}

/// Running column sums of the window, so the time per row does not depend on its size.
class ColumnSums {
 public:
  ColumnSums(View<const Gray> image, int half) : image_(image), half_(half), sums_(columns(image)) {}

  /// Sums over the rows y ± half inside the image. The first call may have any y, each further one the next
  /// y.
  const std::vector<int>& at(int y) {
    if (started_) {
      change(y - half_ - 1, -1);
      change(y + half_, +1);
    } else {
      for (int row = y - half_; row <= y + half_; ++row) change(row, +1);
      started_ = true;
    }
    return sums_;
  }

 private:
  static std::size_t columns(View<const Gray> image) { return static_cast<std::size_t>(image.width()); }
  void change(int y, int sign) {
    if (y < 0 || y >= image_.height()) return;
    const Gray* row = image_.row(y);
    for (std::size_t x = 0; x < sums_.size(); ++x) sums_[x] += sign * row[x];
  }

  View<const Gray> image_;
  int half_;
  std::vector<int> sums_;
  bool started_ = false;
};

/// ⌊numerator / count⌋ by multiplication. Exact for numerators below 2^22 and counts below 2^10, because
/// numerator·(factor − 2^32 / count) < 2^32 / count.
class Quotient {
 public:
  explicit Quotient(int count) : factor_((std::uint64_t{1} << 32) / static_cast<std::uint64_t>(count) + 1) {}
  [[nodiscard]] int of(int numerator) const {
    return static_cast<int>(static_cast<std::uint64_t>(numerator) * factor_ >> 32);
  }

 private:
  std::uint64_t factor_;
};

}  // namespace

Image<Gray> filter_xsobel(View<const Gray> image, int cap, const Exec& exec) {
  Image<Gray> filtered(image.size(), exec.pool);
  const Size size = image.size();
  const kernels::PrefilterKernels& run = kernels::prefilter_kernels(exec);
  parallel_for(exec, size.height, 16, [&](int first, int last) {
    std::vector<std::int16_t> columns(static_cast<std::size_t>(size.width));
    for (int y = first; y < last; ++y) {
      run.filter_row(image.row(mirrored(y - 1, size.height)), image.row(y),
                     image.row(mirrored(y + 1, size.height)), size.width, cap, columns.data(),
                     filtered.row(y));
    }
  });
  return filtered;
}

Image<std::int16_t> remove_mean(View<const Gray> image, int window_size, const Exec& exec) {
  Image<std::int16_t> flat(image.size(), exec.pool);
  const int half = window_size / 2;
  const int width = image.width();
  parallel_for(exec, image.height(), 2 * window_size, [&](int first, int last) {
    ColumnSums columns(image, half);
    for (int y = first; y < last; ++y) {
      const std::vector<int>& sums = columns.at(y);
      const int rows = std::min(y + half, image.height() - 1) - std::max(y - half, 0) + 1;
      const Gray* in = image.row(y);
      std::int16_t* out = flat.row(y);
      int sum = 0;
      for (int x = 0; x < std::min(half, width); ++x) sum += sums[static_cast<std::size_t>(x)];
      const auto write = [&](int x, int count, const Quotient& quotient) {
        const int mean = quotient.of(kMeanSteps * sum + count / 2);
        out[x] = static_cast<std::int16_t>(kMeanSteps * in[x] - mean);
      };
      const auto slide_at_border = [&](int x) {
        if (x + half < width) sum += sums[static_cast<std::size_t>(x + half)];
        if (x > half) sum -= sums[static_cast<std::size_t>(x - half - 1)];
        const int count = rows * (std::min(x + half, width - 1) - std::max(x - half, 0) + 1);
        write(x, count, Quotient(count));
      };
      const int x_inside = std::min(half + 1, width);
      const int x_border = std::max(x_inside, width - half);
      for (int x = 0; x < x_inside; ++x) slide_at_border(x);
      const int count = rows * (2 * half + 1);
      const Quotient quotient(count);
      for (int x = x_inside; x < x_border; ++x) {
        sum += sums[static_cast<std::size_t>(x + half)] - sums[static_cast<std::size_t>(x - half - 1)];
        write(x, count, quotient);
      }
      for (int x = x_border; x < width; ++x) slide_at_border(x);
    }
  });
  return flat;
}

}  // namespace cairn
