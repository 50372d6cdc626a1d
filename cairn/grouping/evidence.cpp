// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <array>
#include <cairn/core/parallel.hpp>
#include <cairn/grouping/evidence.hpp>
#include <cairn/grouping/evidence_kernels.hpp>
#include <cairn/image/noise_kernels.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace cairn {
namespace {

constexpr int kGrain = 16;  // rows
constexpr int kReach = 2;
constexpr std::size_t kGreatestResponse = 8 * 255;  // to the noise kernel
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

/// The image smoothed by (1 6 1)/8 both ways, in 1/64 grey level: enough to tell an edge from single-pixel
/// noise.
Image<std::int16_t> lightly_smoothed(View<const Gray> image, const kernels::EvidenceKernels& run,
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

/// The disparities of textured pixels, NaN elsewhere. NaN frame it, so that no neighbour needs a bounds
/// check: pixel (x, y) of the picture stands at (x + kReach, y + kReach).
Image<float> textured(View<const Gray> left, const DisparityMap& disparity, float least_gradient,
                      const kernels::EvidenceKernels& run, const Exec& exec) {
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
      run.textured(smooth.row(std::max(y - 1, 0)), smooth.row(y), smooth.row(std::min(y + 1, height - 1)),
                   disparity.reject.row(y), disparity.disparity_px.row(y), width, least, out + kReach);
    }
  });
  return result;
}

/// How many pixels respond how strongly to the noise kernel.
using Responses = std::array<std::int64_t, kGreatestResponse + 1>;

Responses responses(View<const Gray> image, int first_row, int last_row, const Exec& exec) {
  const kernels::NoiseKernels& run = kernels::noise_kernels(exec);
  // Two counters for each response: neighbours often respond alike, and one would wait for the other.
  std::array<Responses, 2> counts{};
  std::vector<std::uint16_t> response(static_cast<std::size_t>(image.width()));
  for (int y = first_row; y < last_row; ++y) {
    run.noise(image.row(y - 1), image.row(y), image.row(y + 1), image.width(), response.data());
    const std::uint16_t* const end = response.data() + image.width() - 1;
    const std::uint16_t* r = response.data() + 1;
    for (; r + 1 < end; r += 2) {
      ++counts[0][r[0]];
      ++counts[1][r[1]];
    }
    if (r < end) ++counts[0][*r];
  }
  for (std::size_t i = 0; i < counts[0].size(); ++i) counts[0][i] += counts[1][i];
  return counts[0];
}

}  // namespace

float noise_sigma(View<const Gray> image, const Exec& exec) {
  if (image.width() < 3 || image.height() < 3) return 0;
  const int rows = image.height() - 2;
  std::vector<Responses> bands(static_cast<std::size_t>(std::min(exec.threads(), rows)));
  const auto count = static_cast<std::int64_t>(bands.size());
  parallel_for(exec, static_cast<int>(count), 1, [&](int first, int last) {
    for (int band = first; band < last; ++band) {
      bands[static_cast<std::size_t>(band)] =
          responses(image, static_cast<int>(1 + rows * band / count),
                    static_cast<int>(1 + rows * (band + 1) / count), exec);
    }
  });
  Responses& histogram = bands.front();
  for (std::size_t band = 1; band < bands.size(); ++band) {
    for (std::size_t i = 0; i < histogram.size(); ++i) histogram[i] += bands[band][i];
  }
  const std::int64_t total = std::int64_t{image.width() - 2} * rows;
  std::int64_t below = 0;
  std::size_t median = 0;
  while (2 * (below + histogram[median]) < total) below += histogram[median++];
  // Whole grey levels are coarse next to the noise of a good camera: the median is interpolated within its
  // level.
  const auto share = (static_cast<double>(total) / 2 - static_cast<double>(below)) /
                     static_cast<double>(std::max<std::int64_t>(histogram[median], 1));
  return static_cast<float>((static_cast<double>(median) + share - 0.5) / (6 * 0.6745));
}

Image<float> find_evidence(View<const Gray> left, const DisparityMap& disparity, const EvidenceConfig& config,
                           const Exec& exec, std::optional<float> noise) {
  const Size size = left.size();
  const kernels::EvidenceKernels& run = kernels::evidence_kernels(exec);
  const float least_gradient =
      config.noise_factor * (noise ? *noise : noise_sigma(left, exec)) + config.gradient_min;
  const Image<float> candidates = textured(left, disparity, least_gradient, run, exec);
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
