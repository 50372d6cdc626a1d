// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <array>
#include <cairn/core/parallel.hpp>
#include <cairn/regions/textured.hpp>
#include <cairn/regions/textured_kernels.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace cairn {
namespace {

constexpr int kGrain = 16;  // rows
constexpr int kReach = 2;
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

/// The image smoothed by (1 6 1)/8 both ways, in 1/64 grey level: enough to tell an edge from single-pixel
/// noise.
Image<std::int16_t> lightly_smoothed(View<const Gray> image, const kernels::TexturedKernels& run,
                                     const Exec& exec) {
  const int height = image.height();
  Image<std::int16_t> result(image.size(), exec.pool);
  parallel_for(exec, height, kGrain, [&](int first, int last) {
    std::vector<std::int16_t> column(static_cast<std::size_t>(image.width()) + 2);
    for (int y = first; y < last; ++y) {
      run.smooth_lightly(image.row(std::max(y - 1, 0)), image.row(y), image.row(std::min(y + 1, height - 1)),
                         image.width(), column.data(), result.row(y));
    }
  });
  return result;
}

/// The disparities of textured pixels, NaN elsewhere, with a frame of NaN so that neighbours need no bounds
/// check: pixel (x, y) of the image is at (x + kReach, y + kReach).
Image<float> textured(View<const Gray> left, const DisparityMap& disparity, float least_gradient,
                      const kernels::TexturedKernels& run, const Exec& exec) {
  const Image<std::int16_t> smooth = lightly_smoothed(left, run, exec);
  const int width = left.width();
  const int height = left.height();
  const int least =
      static_cast<int>(std::floor(least_gradient * 128.0F));  // of s(x+1) − s(x−1), in 1/64 level
  Image<float> result({width + 2 * kReach, height + 2 * kReach}, exec.pool);
  parallel_for(exec, height + 2 * kReach, kGrain, [&](int first, int last) {
    for (int v = first; v < last; ++v) {
      const int y = v - kReach;
      float* const out = result.row(v);
      std::fill_n(out, result.width(), kNaN);
      if (y < 0 || y >= height) continue;
      run.textured({smooth.row(std::max(y - 1, 0)), smooth.row(y), smooth.row(std::min(y + 1, height - 1))},
                   disparity.reject.row(y), disparity.disparity_px.row(y), width, least, out + kReach);
    }
  });
  return result;
}

}  // namespace

Image<float> select_textured(const LeftImage& left, const DisparityMap& disparity,
                             const TexturedConfig& config, const Exec& exec) {
  const Size size = left.gray.size();
  const kernels::TexturedKernels& run = kernels::textured_kernels(exec);
  const float least_gradient = config.noise_factor * left.noise_sigma + config.gradient_min;
  const Image<float> candidates = textured(left.gray, disparity, least_gradient, run, exec);
  const float agreement = config.agreement * 0.001F * static_cast<float>(size.width);
  Image<float> evidence(size, exec.pool);
  parallel_for(exec, size.height, kGrain, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      std::array<const float*, 2 * kReach + 1> rows{};
      for (int i = 0; i <= 2 * kReach; ++i)
        rows.at(static_cast<std::size_t>(i)) = candidates.row(y + i) + kReach;
      run.agreed(rows.data(), size.width, agreement, evidence.row(y));
    }
  });
  return evidence;
}

}  // namespace cairn
