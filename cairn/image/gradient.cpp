// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <array>
#include <cairn/core/ids.hpp>
#include <cairn/core/parallel.hpp>
#include <cairn/disparity/row_kernels.hpp>
#include <cairn/image/gradient.hpp>
#include <cmath>
#include <vector>

namespace cairn {
namespace {

constexpr int kGrain = 16;  // rows
constexpr int kMaxRadius = 15;
constexpr int kWeightSum = 256;

/// One side of a symmetric kernel: weights[i] stands at +i and −i.
struct Kernel {
  int radius = 0;
  std::array<int, kMaxRadius + 1> weights{kWeightSum};
};

Kernel gaussian(float sigma) {
  Kernel kernel;
  if (!(sigma > 0)) return kernel;
  const double s = sigma;
  const int reach = static_cast<int>(std::min(std::ceil(3 * s), static_cast<double>(kMaxRadius)));
  const auto bell = [s](int i) { return std::exp(-0.5 * i * i / (s * s)); };
  double total = 1;
  for (int i = 1; i <= reach; ++i) total += 2 * bell(i);
  for (int i = 1; i <= reach; ++i) {
    const auto at = static_cast<std::size_t>(i);
    kernel.weights[at] = static_cast<int>(std::lround(kWeightSum * bell(i) / total));
    kernel.weights[0] -= 2 * kernel.weights[at];
    if (kernel.weights[at] > 0) kernel.radius = i;  // taps that rounded to nothing are not visited
  }
  return kernel;
}

/// Disparity smoothed over the valid pixels; holes stay.
Image<std::int16_t> smoothed(View<const std::int16_t> disparity16, const Kernel& kernel, const Exec& exec) {
  const Size size = disparity16.size();
  const int r = kernel.radius;
  Image<std::int16_t> result(size, exec.pool);
  parallel_for(exec, size.height, kGrain, [&](int first, int last) {
    const auto length = static_cast<std::size_t>(size.width + 2 * r);
    std::vector<int> values(length);   // 24 bits and sign
    std::vector<int> weights(length);  // 8 bits
    int* const value = values.data() + r;
    int* const weight = weights.data() + r;
    for (int y = first; y < last; ++y) {
      std::fill(values.begin(), values.end(), 0);
      std::fill(weights.begin(), weights.end(), 0);
      for (int i = std::max(-r, -y); i <= std::min(r, size.height - 1 - y); ++i) {
        const std::int16_t* const row = disparity16.row(y + i);
        const int w = kernel.weights[static_cast<std::size_t>(std::abs(i))];
        for (int x = 0; x < size.width; ++x) {
          const bool valid = row[x] != kHole16;
          value[x] += valid ? w * row[x] : 0;
          weight[x] += valid ? w : 0;
        }
      }
      const std::int16_t* const centre = disparity16.row(y);
      std::int16_t* const out = result.row(y);
      for (int x = 0; x < size.width; ++x) {
        if (centre[x] == kHole16) {
          out[x] = kHole16;
          continue;
        }
        std::int64_t sum = 0;
        std::int64_t total = 0;
        for (int i = -r; i <= r; ++i) {
          const int w = kernel.weights[static_cast<std::size_t>(std::abs(i))];
          sum += std::int64_t{w} * value[x + i];
          total += std::int64_t{w} * weight[x + i];
        }
        const std::int64_t numerator =
            2 * sum + total;  // ⌊(2·sum + total) / (2·total)⌋ is the mean, halves up
        const std::int64_t quotient = numerator / (2 * total);
        out[x] = static_cast<std::int16_t>(quotient - (numerator % (2 * total) < 0 ? 1 : 0));
      }
    }
  });
  return result;
}

/// The last three rows of a picture that were smoothed, and working memory: what a band of rows needs.
class SmoothedRows {
 public:
  SmoothedRows(const kernels::RowKernels& run, const Kernel& kernel, Size size, int channels)
      : run_(run),
        kernel_(kernel),
        size_(size),
        channels_(channels),
        padded_(slot((size.width + 2 * kernel.radius) * channels)),
        sums_(slot(size.width * channels)) {
    for (auto& row : smooth_) row.resize(sums_.size());
  }

  /// Calls found(y, above, here, below) for the rows first … last − 1, smoothed; what is outside is
  /// replicated. `row_at(y)` gives the samples of a row of the picture.
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

  /// Working memory of one row.
  [[nodiscard]] std::uint32_t* sums() { return sums_.data(); }

 private:
  std::int16_t* smoothed(int y) { return smooth_.at(slot(y % 3)).data(); }

  const kernels::RowKernels& run_;
  const Kernel& kernel_;
  Size size_;
  int channels_;
  std::vector<std::uint16_t> padded_;
  std::vector<std::uint32_t> sums_;
  std::array<std::vector<std::int16_t>, 3> smooth_;
};

Image<std::uint16_t> disparity_gradient(View<const std::int16_t> disparity16, const Exec& exec) {
  const kernels::RowKernels& run = kernels::row_kernels(exec);
  const Size size = disparity16.size();
  Image<std::uint16_t> result(size, exec.pool);
  parallel_for(exec, size.height, kGrain, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      run.disparity_steepness(disparity16.row(std::max(y - 1, 0)), disparity16.row(y),
                              disparity16.row(std::min(y + 1, size.height - 1)), size.width, result.row(y));
    }
  });
  return result;
}

}  // namespace

Image<std::uint16_t> gradient(View<const Gray> image, float smoothing_sigma, const Exec& exec) {
  const Kernel kernel = gaussian(smoothing_sigma);
  const kernels::RowKernels& run = kernels::row_kernels(exec);
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

Image<std::int16_t> quantised(const DisparityMap& disparity, const Exec& exec) {
  const kernels::RowKernels& run = kernels::row_kernels(exec);
  const Size size = disparity.disparity_px.size();
  Image<std::int16_t> result(size, exec.pool);
  parallel_for(exec, size.height, kGrain, [&](int first, int last) {
    for (int y = first; y < last; ++y) run.quantise(disparity.disparity_px.row(y), size.width, result.row(y));
  });
  return result;
}

Image<std::uint16_t> gradient(View<const std::int16_t> disparity16, float smoothing_sigma, const Exec& exec) {
  const Kernel kernel = gaussian(smoothing_sigma);
  if (kernel.radius == 0) return disparity_gradient(disparity16, exec);
  const Image<std::int16_t> smooth = smoothed(disparity16, kernel, exec);
  return disparity_gradient(smooth, exec);
}

Image<std::uint16_t> edge_strength(View<const Gray> gray, View<const Rgb> rgb, float smoothing_sigma,
                                   const Exec& exec) {
  const Kernel kernel = gaussian(smoothing_sigma);
  const kernels::RowKernels& run = kernels::row_kernels(exec);
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
