// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <array>
#include <cairn/core/parallel.hpp>
#include <cairn/image/noise.hpp>
#include <cairn/image/noise_kernels.hpp>
#include <cstdint>
#include <vector>

namespace cairn {
namespace {

constexpr std::size_t kMaxResponse = 8 * 255;  // of the noise kernel

/// Histogram of the noise kernel's responses.
using Responses = std::array<std::int64_t, kMaxResponse + 1>;

Responses responses(View<const Gray> image, int first_row, int last_row, const Exec& exec) {
  const kernels::NoiseKernels& run = kernels::noise_kernels(exec);
  // Two histograms in turn: neighbours often have the same response, and one counter would stall on itself.
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
  // Integer responses are coarse compared with the noise of a good camera, so the median is interpolated
  // within its bin.
  const auto share = (static_cast<double>(total) / 2 - static_cast<double>(below)) /
                     static_cast<double>(std::max<std::int64_t>(histogram[median], 1));
  return static_cast<float>((static_cast<double>(median) + share - 0.5) / (6 * 0.6745));
}

}  // namespace cairn
