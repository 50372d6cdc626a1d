// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/core/parallel.hpp>
#include <cairn/image/gaussian.hpp>
#include <cairn/stereo/gradient.hpp>
#include <cairn/stereo/gradient_kernels.hpp>
#include <cstddef>
#include <cstdlib>
#include <vector>

namespace cairn {
namespace {

constexpr int kGrain = 16;  // rows

/// Disparity smoothed over the valid pixels; holes remain.
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

Image<std::uint16_t> disparity_gradient(View<const std::int16_t> disparity16, const Exec& exec) {
  const kernels::DisparityGradientKernels& run = kernels::disparity_gradient_kernels(exec);
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

Image<std::int16_t> quantised(const DisparityMap& disparity, const Exec& exec) {
  const kernels::DisparityGradientKernels& run = kernels::disparity_gradient_kernels(exec);
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

}  // namespace cairn
