// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <array>
#include <cairn/core/parallel.hpp>
#include <cairn/disparity/row_kernels.hpp>
#include <cairn/regions/gradient.hpp>
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

/// Repeats the first and the last of the `width` values `radius` times around them; row[0] is the first
/// value.
template <class T>
void replicate_ends(T* row, int width, int radius) {
  std::fill_n(row - radius, radius, row[0]);
  std::fill_n(row + width, radius, row[width - 1]);
}

/// Grey in 1/16 levels, smoothed.
Image<std::int16_t> smoothed(View<const Gray> image, const Kernel& kernel, const Exec& exec) {
  const Size size = image.size();
  const int r = kernel.radius;
  Image<std::int16_t> result(size, exec.pool);
  parallel_for(exec, size.height, kGrain, [&](int first, int last) {
    std::vector<std::uint16_t> padded(static_cast<std::size_t>(size.width + 2 * r));  // 8.8 bits
    std::vector<std::uint32_t> sum(static_cast<std::size_t>(size.width));             // 8.16 bits
    std::uint16_t* const column = padded.data() + r;
    for (int y = first; y < last; ++y) {
      const Gray* const centre = image.row(y);
      for (int x = 0; x < size.width; ++x)
        column[x] = static_cast<std::uint16_t>(centre[x] * kernel.weights[0]);
      for (int i = 1; i <= r; ++i) {
        const Gray* const up = image.row(std::max(y - i, 0));
        const Gray* const down = image.row(std::min(y + i, size.height - 1));
        const auto w = static_cast<std::uint16_t>(kernel.weights[static_cast<std::size_t>(i)]);
        for (int x = 0; x < size.width; ++x)
          column[x] = static_cast<std::uint16_t>(column[x] + w * (up[x] + down[x]));
      }
      replicate_ends(column, size.width, r);

      std::uint32_t* const s = sum.data();
      const auto centre_weight = static_cast<std::uint32_t>(kernel.weights[0]);
      for (int x = 0; x < size.width; ++x) s[x] = column[x] * centre_weight;
      for (int i = 1; i <= r; ++i) {
        const auto w = static_cast<std::uint32_t>(kernel.weights[static_cast<std::size_t>(i)]);
        const std::uint16_t* const left = column - i;
        const std::uint16_t* const right = column + i;
        for (int x = 0; x < size.width; ++x) s[x] += w * (std::uint32_t{left[x]} + right[x]);
      }
      std::int16_t* const out = result.row(y);
      for (int x = 0; x < size.width; ++x) out[x] = static_cast<std::int16_t>((s[x] + (1U << 11U)) >> 12U);
    }
  });
  return result;
}

std::uint16_t grey_magnitude(int gx, int gy) {
  constexpr int kCap =
      256 * 16;  // beyond it the root rounds to 255 anyhow, and below it floats hold the sum exactly
  const int square = std::min(gx * gx + gy * gy, kCap * kCap);
  const int root = static_cast<int>(std::sqrt(static_cast<float>(square)) * (1.0F / 16) + 0.5F);
  return static_cast<std::uint16_t>(std::min(root, 255));
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

std::uint16_t disparity_magnitude(int centre, int up, int left, int right, int down) {
  const auto known = [centre](int neighbour) { return neighbour == kHole16 ? centre : neighbour; };
  const int gx = std::clamp(known(right) - known(left), -kSteepest16, kSteepest16);
  const int gy = std::clamp(known(down) - known(up), -kSteepest16, kSteepest16);
  const int square = std::min(gx * gx + gy * gy, kSteepest16 * kSteepest16);
  const int root = static_cast<int>(std::sqrt(static_cast<float>(square)) + 0.5F);
  return static_cast<std::uint16_t>(centre == kHole16 ? kHoleGradient : root);
}

/// Rows of `values`, each pixel with its four neighbours, those outside the image replaced by the pixel
/// itself.
template <class Magnitude>
Image<std::uint16_t> over_neighbours(View<const std::int16_t> values, const Exec& exec, Magnitude magnitude) {
  const Size size = values.size();
  Image<std::uint16_t> result(size, exec.pool);
  parallel_for(exec, size.height, kGrain, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      const std::int16_t* const row = values.row(y);
      const std::int16_t* const up = values.row(std::max(y - 1, 0));
      const std::int16_t* const down = values.row(std::min(y + 1, size.height - 1));
      std::uint16_t* const out = result.row(y);
      const int end = size.width - 1;
      out[0] = magnitude(row[0], up[0], row[0], row[std::min(1, end)], down[0]);
      for (int x = 1; x < end; ++x) out[x] = magnitude(row[x], up[x], row[x - 1], row[x + 1], down[x]);
      if (end > 0) out[end] = magnitude(row[end], up[end], row[end - 1], row[end], down[end]);
    }
  });
  return result;
}

std::int16_t quantised(float disparity_px) {
  // Truncation and a correction instead of std::floor, which is a call per pixel before SSE4.1. 32767/16 is
  // no limit in practice (kMaxDisparity); the clamp only keeps the conversion defined.
  const float sixteenths = std::clamp(disparity_px * 16.0F, -32767.0F, 32767.0F);
  const int truncated = static_cast<int>(sixteenths);
  const float rest = sixteenths - static_cast<float>(truncated);
  return static_cast<std::int16_t>(truncated + (rest >= 0.5F ? 1 : 0) - (rest < -0.5F ? 1 : 0));
}

}  // namespace

Image<std::uint16_t> gradient(View<const Gray> image, float smoothing_sigma, const Exec& exec) {
  const Image<std::int16_t> smooth = smoothed(image, gaussian(smoothing_sigma), exec);
  return over_neighbours(smooth, exec, [](int, int up, int left, int right, int down) {
    return grey_magnitude(right - left, down - up);
  });
}

Image<std::int16_t> quantised(const DisparityMap& disparity, const Exec& exec) {
  const Size size = disparity.disparity_px.size();
  Image<std::int16_t> result(size, exec.pool);
  parallel_for(exec, size.height, kGrain, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      const float* const in = disparity.disparity_px.row(y);
      std::int16_t* const out = result.row(y);
      for (int x = 0; x < size.width; ++x) {
        const bool valid = in[x] == in[x];  // a hole is NaN
        out[x] = valid ? quantised(valid ? in[x] : 0.0F) : kHole16;
      }
    }
  });
  return result;
}

Image<std::uint16_t> gradient(View<const std::int16_t> disparity16, float smoothing_sigma, const Exec& exec) {
  const Kernel kernel = gaussian(smoothing_sigma);
  if (kernel.radius == 0) return over_neighbours(disparity16, exec, disparity_magnitude);
  const Image<std::int16_t> smooth = smoothed(disparity16, kernel, exec);
  return over_neighbours(smooth, exec, disparity_magnitude);
}

namespace {

/// What edge_strength() needs for a band of rows: the last three rows, smoothed, and working memory.
class EdgeBand {
 public:
  EdgeBand(const kernels::RowKernels& run, const Kernel& kernel, int width, int channels)
      : run_(run),
        kernel_(kernel),
        width_(width),
        channels_(channels),
        padded_(static_cast<std::size_t>((width + 2 * kernel.radius) * channels)),
        sums_(static_cast<std::size_t>(width * channels)) {
    for (auto& row : smooth_) row.resize(sums_.size());
  }

  /// Writes the rows first … last − 1. `row_at(y)` gives the samples of a row of the picture, `height` of
  /// them.
  template <class RowAt>
  void run(RowAt row_at, int height, int first, int last, View<std::uint16_t> strength) {
    const auto smooth_row = [&](int y) {
      std::array<const std::uint8_t*, 2 * kMaxRadius + 1> rows{};
      for (int i = 0; i <= 2 * kernel_.radius; ++i)
        rows.at(static_cast<std::size_t>(i)) = row_at(std::clamp(y + i - kernel_.radius, 0, height - 1));
      run_.smooth(rows.data(), width_, channels_, {kernel_.weights.data(), kernel_.radius}, padded_.data(),
                  sums_.data(), smoothed_row(y));
    };
    for (int y = std::max(first - 1, 0); y <= first; ++y) smooth_row(y);
    for (int y = first; y < last; ++y) {
      if (y + 1 < height) smooth_row(y + 1);
      run_.edges(smoothed_row(std::max(y - 1, 0)), smoothed_row(y), smoothed_row(std::min(y + 1, height - 1)),
                 width_, channels_, sums_.data(), strength.row(y));
    }
  }

 private:
  std::int16_t* smoothed_row(int y) { return smooth_.at(static_cast<std::size_t>(y % 3)).data(); }

  const kernels::RowKernels& run_;
  const Kernel& kernel_;
  int width_;
  int channels_;
  std::vector<std::uint16_t> padded_;
  std::vector<std::uint32_t> sums_;
  std::array<std::vector<std::int16_t>, 3> smooth_;
};

}  // namespace

Image<std::uint16_t> edge_strength(View<const Gray> gray, View<const Rgb> rgb, float smoothing_sigma,
                                   const Exec& exec) {
  const Kernel kernel = gaussian(smoothing_sigma);
  const kernels::RowKernels& run = kernels::row_kernels(exec);
  Image<std::uint16_t> strength(gray.size(), exec.pool);
  const int height = gray.height();
  parallel_for(exec, height, kGrain, [&](int first, int last) {
    EdgeBand band(run, kernel, gray.width(), rgb.empty() ? 1 : 3);
    if (rgb.empty()) {
      band.run([&](int y) { return gray.row(y); }, height, first, last, strength);
    } else {
      band.run([&](int y) { return reinterpret_cast<const std::uint8_t*>(rgb.row(y)); }, height, first, last,
               strength);
    }
  });
  return strength;
}

}  // namespace cairn
