// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <array>
#include <cairn/core/ids.hpp>
#include <cairn/core/parallel.hpp>
#include <cairn/image/gaussian.hpp>
#include <cairn/image/gradient.hpp>
#include <cairn/image/gradient_kernels.hpp>
#include <vector>

namespace cairn {
namespace {

constexpr int kGrain = 16;  // rows

/// Working memory of a band of rows: the last three smoothed rows.
class SmoothedRows {
 public:
  SmoothedRows(const kernels::GradientKernels& run, const Kernel& kernel, Size size, int channels)
      : run_(run),
        kernel_(kernel),
        size_(size),
        channels_(channels),
        padded_(slot((size.width + 2 * kernel.radius) * channels)),
        sums_(slot(size.width * channels)) {
    for (auto& row : smooth_) row.resize(sums_.size());
  }

  /// Calls found(y, above, here, below) for the smoothed rows first … last − 1, with replicated borders.
  /// `row_at(y)` returns the samples of a row.
  template <class RowAt, class Found>
  void for_each(RowAt row_at, int first, int last, Found found) {
    const auto smooth_row = [&](int y) {
      std::array<const std::uint8_t*, 2 * kMaxRadius + 1> rows{};
      for (int i = 0; i <= 2 * kernel_.radius; ++i)
        rows.at(slot(i)) = row_at(std::clamp(y + i - kernel_.radius, 0, size_.height - 1));
      run_.smooth(rows.data(), size_.width, channels_, {kernel_.weights.data(), kernel_.radius},
                  padded_.data(), sums_.data(), smoothed(y));
    };
    for (int y = std::max(first - 1, 0); y <= first; ++y) smooth_row(y);
    for (int y = first; y < last; ++y) {
      if (y + 1 < size_.height) smooth_row(y + 1);
      found(y, smoothed(std::max(y - 1, 0)), smoothed(y), smoothed(std::min(y + 1, size_.height - 1)));
    }
  }

  /// Working memory of a row.
  [[nodiscard]] std::uint32_t* sums() { return sums_.data(); }

 private:
  std::int16_t* smoothed(int y) { return smooth_.at(slot(y % 3)).data(); }

  const kernels::GradientKernels& run_;
  const Kernel& kernel_;
  Size size_;
  int channels_;
  std::vector<std::uint16_t> padded_;
  std::vector<std::uint32_t> sums_;
  std::array<std::vector<std::int16_t>, 3> smooth_;
};

}  // namespace

Image<std::uint16_t> gradient(View<const Gray> image, float smoothing_sigma, const Exec& exec) {
  const Kernel kernel = gaussian(smoothing_sigma);
  const kernels::GradientKernels& run = kernels::gradient_kernels(exec);
  Image<std::uint16_t> result(image.size(), exec.pool);
  parallel_for(exec, image.height(), kGrain, [&](int first, int last) {
    SmoothedRows rows(run, kernel, image.size(), 1);
    rows.for_each([&](int y) { return image.row(y); }, first, last,
                  [&](int y, const std::int16_t* above, const std::int16_t* here, const std::int16_t* below) {
                    run.steepness(above, here, below, image.width(), result.row(y));
                  });
  });
  return result;
}

Image<std::uint16_t> edge_strength(View<const Gray> gray, View<const Rgb> rgb, float smoothing_sigma,
                                   const Exec& exec) {
  const Kernel kernel = gaussian(smoothing_sigma);
  const kernels::GradientKernels& run = kernels::gradient_kernels(exec);
  Image<std::uint16_t> strength(gray.size(), exec.pool);
  const int channels = rgb.empty() ? 1 : 3;
  const auto row_at = [&](int y) {
    return rgb.empty() ? gray.row(y) : reinterpret_cast<const std::uint8_t*>(rgb.row(y));
  };
  parallel_for(exec, gray.height(), kGrain, [&](int first, int last) {
    SmoothedRows rows(run, kernel, gray.size(), channels);
    rows.for_each(row_at, first, last,
                  [&](int y, const std::int16_t* above, const std::int16_t* here, const std::int16_t* below) {
                    run.edges(above, here, below, gray.width(), channels, rows.sums(), strength.row(y));
                  });
  });
  return strength;
}

}  // namespace cairn
