// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <array>
#include <cairn/core/parallel.hpp>
#include <cairn/disparity/evidence.hpp>
#include <cmath>
#include <cstdlib>
#include <limits>

namespace cairn {
namespace {

constexpr int kGrain = 16;  // rows
constexpr int kFriends = 3;
constexpr int kReach = 2;

/// The image smoothed by (1 6 1)/8 both ways, in 1/64 grey level: enough to tell an edge from single-pixel
/// noise.
Image<std::int16_t> lightly_smoothed(View<const Gray> image, const Exec& exec) {
  const int width = image.width();
  const int height = image.height();
  Image<std::int16_t> result(image.size(), exec.pool);
  parallel_for(exec, height, kGrain, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      const Gray* const up = image.row(std::max(y - 1, 0));
      const Gray* const here = image.row(y);
      const Gray* const down = image.row(std::min(y + 1, height - 1));
      std::int16_t* const out = result.row(y);
      const auto column = [&](int x) { return up[x] + 6 * here[x] + down[x]; };
      for (int x = 0; x < width; ++x) {
        out[x] = static_cast<std::int16_t>(column(std::max(x - 1, 0)) + 6 * column(x) +
                                           column(std::min(x + 1, width - 1)));
      }
    }
  });
  return result;
}

Image<std::uint8_t> textured(View<const Gray> left, const DisparityMap& disparity, float least_gradient,
                             const Exec& exec) {
  const Image<std::int16_t> smooth = lightly_smoothed(left, exec);
  const int width = left.width();
  const int height = left.height();
  const int least =
      static_cast<int>(std::floor(least_gradient * 128.0F));  // of s(x+1) − s(x−1), in 1/64 level
  Image<std::uint8_t> result(left.size(), exec.pool);
  parallel_for(exec, height, kGrain, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      const std::int16_t* const up = smooth.row(std::max(y - 1, 0));
      const std::int16_t* const here = smooth.row(y);
      const std::int16_t* const down = smooth.row(std::min(y + 1, height - 1));
      const Reject* const reject = disparity.reject.row(y);
      std::uint8_t* const out = result.row(y);
      for (int x = 0; x < width; ++x) {
        const int gx = std::abs(here[std::min(x + 1, width - 1)] - here[std::max(x - 1, 0)]);
        const int gy = std::abs(down[x] - up[x]);
        out[x] = reject[x] == Reject::none && gx > least && 2 * gx > gy ? 255 : 0;
      }
    }
  });
  return result;
}

}  // namespace

float noise_sigma(View<const Gray> image) {
  if (image.width() < 3 || image.height() < 3) return 0;
  std::array<std::int64_t, 16 * 255 / 2 + 2> histogram{};
  std::int64_t total = 0;
  for (int y = 1; y + 1 < image.height(); ++y) {
    const Gray* const up = image.row(y - 1);
    const Gray* const here = image.row(y);
    const Gray* const down = image.row(y + 1);
    for (int x = 1; x + 1 < image.width(); ++x) {
      const int corners = up[x - 1] + up[x + 1] + down[x - 1] + down[x + 1];
      const int sides = up[x] + down[x] + here[x - 1] + here[x + 1];
      const auto response = static_cast<std::size_t>(std::abs(corners - 2 * sides + 4 * here[x]));
      ++histogram[std::min(response, histogram.size() - 1)];
      ++total;
    }
  }
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
                           const Exec& exec) {
  const Size size = left.size();
  const Image<std::uint8_t> candidates =
      textured(left, disparity, config.noise_factor * noise_sigma(left) + config.gradient_min, exec);
  const float agreement = config.agreement * 0.001F * static_cast<float>(size.width);
  Image<float> evidence(size, std::numeric_limits<float>::quiet_NaN(), exec.pool);
  parallel_for(exec, size.height, kGrain, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      for (int x = 0; x < size.width; ++x) {
        if (candidates(x, y) == 0) continue;
        const float d = disparity.disparity_px(x, y);
        int friends = -1;  // the pixel itself is met too
        for (int v = std::max(y - kReach, 0); v <= std::min(y + kReach, size.height - 1); ++v) {
          const std::uint8_t* const candidate = candidates.row(v);
          const float* const other = disparity.disparity_px.row(v);
          for (int u = std::max(x - kReach, 0); u <= std::min(x + kReach, size.width - 1); ++u) {
            friends += static_cast<int>(candidate[u] != 0 && std::abs(other[u] - d) <= agreement);
          }
        }
        if (friends >= kFriends) evidence(x, y) = d;
      }
    }
  });
  return evidence;
}

}  // namespace cairn
