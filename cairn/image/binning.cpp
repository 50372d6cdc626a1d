// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/image/binning.hpp>

#include <algorithm>
#include <cairn/core/ids.hpp>
#include <cmath>
#include <limits>
#include <vector>

namespace cairn {
namespace {

Size binned_size(Size size, int factor) {
  return {size.width / factor, size.height / factor};
}

/// Of `channels` interleaved bytes per pixel. `row(y)` and `out(y)`: the bytes of a row.
template <class Row, class OutRow>
void average(Size size, int factor, int channels, const Row& row, const OutRow& out) {
  const int width = size.width * channels;  // of the result
  const auto pixels = static_cast<std::uint32_t>(factor * factor);
  std::vector<std::uint32_t> sums(slot(width * factor));  // of columns
  for (int y = 0; y < size.height; ++y) {
    std::fill(sums.begin(), sums.end(), 0);
    for (int v = 0; v < factor; ++v) {
      const std::uint8_t* const from = row(y * factor + v);
      for (std::size_t x = 0; x < sums.size(); ++x) sums[x] += from[x];
    }
    std::uint8_t* const to = out(y);
    for (int x = 0; x < size.width; ++x) {
      for (int c = 0; c < channels; ++c) {
        std::uint32_t sum = pixels / 2;
        for (int u = 0; u < factor; ++u) sum += sums[slot((x * factor + u) * channels + c)];
        to[x * channels + c] = static_cast<std::uint8_t>(sum / pixels);
      }
    }
  }
}

}  // namespace

Image<Gray> binned(View<const Gray> image, int factor, const Pool& pool) {
  Image<Gray> result(binned_size(image.size(), factor), pool);
  average(
      result.size(), factor, 1, [&](int y) { return image.row(y); }, [&](int y) { return result.row(y); });
  return result;
}

Image<Rgb> binned(View<const Rgb> image, int factor, const Pool& pool) {
  static_assert(sizeof(Rgb) == 3);
  Image<Rgb> result(binned_size(image.size(), factor), pool);
  average(
      result.size(), factor, 3, [&](int y) { return &image.row(y)->r; },
      [&](int y) { return &result.row(y)->r; });
  return result;
}

Image<float> binned_disparity(View<const float> disparity_px, int factor, const Pool& pool) {
  Image<float> result(binned_size(disparity_px.size(), factor), pool);
  std::vector<float> known;
  for (int y = 0; y < result.height(); ++y) {
    for (int x = 0; x < result.width(); ++x) {
      known.clear();
      for (int v = 0; v < factor; ++v) {
        for (int u = 0; u < factor; ++u) {
          const float d = disparity_px(x * factor + u, y * factor + v);
          if (!std::isnan(d)) known.push_back(d);
        }
      }
      result(x, y) = std::numeric_limits<float>::quiet_NaN();
      if (known.empty()) continue;
      const auto middle = known.begin() + static_cast<std::ptrdiff_t>((known.size() - 1) / 2);
      std::nth_element(known.begin(), middle, known.end());
      result(x, y) = *middle / static_cast<float>(factor);
    }
  }
  return result;
}

}  // namespace cairn
