// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "textured.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <vector>

namespace cairn::reference {
namespace {

std::size_t slot(std::int32_t i) {
  return static_cast<std::size_t>(i);
}

template <class T>
T clamped_at(View<const T> image, int x, int y) {
  return image(std::clamp(x, 0, image.width() - 1), std::clamp(y, 0, image.height() - 1));
}

/// (1 6 1; 6 36 6; 1 6 1): 64 times the smoothed grey.
int lightly_smoothed(View<const Gray> image, int x, int y) {
  int sum = 0;
  for (int v = -1; v <= 1; ++v) {
    for (int u = -1; u <= 1; ++u) {
      sum += (u == 0 ? 6 : 1) * (v == 0 ? 6 : 1) * clamped_at(image, x + u, y + v);
    }
  }
  return sum;
}

/// One value of the image, smoothed by g⊗g in 1/16; `value` returns each pixel's.
template <class Value>
int smoothed16(int x, int y, float sigma, Value value) {
  const int reach = sigma > 0 ? std::min(static_cast<int>(std::ceil(3.0 * sigma)), 15) : 0;
  const auto bell = [&](int i) { return i == 0 ? 1.0 : std::exp(-0.5 * i * i / (double{sigma} * sigma)); };
  double total = 0;
  for (int i = -reach; i <= reach; ++i) total += bell(i);
  std::vector<int> weights{256};
  for (int i = 1; i <= reach; ++i) {
    weights.push_back(static_cast<int>(std::lround(256 * bell(i) / total)));
    weights[0] -= 2 * weights.back();
  }
  int sum = 0;
  for (int v = -reach; v <= reach; ++v) {
    for (int u = -reach; u <= reach; ++u) {
      sum += weights[slot(std::abs(u))] * weights[slot(std::abs(v))] * value(x + u, y + v);
    }
  }
  return (sum + 2048) / 4096;
}

}  // namespace

float noise_sigma(View<const Gray> image) {
  std::vector<int> responses;
  for (int y = 1; y + 1 < image.height(); ++y) {
    for (int x = 1; x + 1 < image.width(); ++x) {
      int sum = 0;
      for (int v = -1; v <= 1; ++v) {
        for (int u = -1; u <= 1; ++u) sum += (u == 0 ? -2 : 1) * (v == 0 ? -2 : 1) * image(x + u, y + v);
      }
      responses.push_back(std::abs(sum));
    }
  }
  if (responses.empty()) return 0;
  std::sort(responses.begin(), responses.end());
  const int median = responses[(responses.size() - 1) / 2];
  const auto [first, last] = std::equal_range(responses.begin(), responses.end(), median);
  const double half = static_cast<double>(responses.size()) / 2;
  const double share =
      (half - static_cast<double>(first - responses.begin())) / static_cast<double>(last - first);
  return static_cast<float>((median + share - 0.5) / (6 * 0.6745));
}

Image<float> select_textured(View<const Gray> left, const DisparityMap& disparity,
                             const TexturedConfig& config) {
  const float least = config.noise_factor * reference::noise_sigma(left) + config.gradient_min;
  const auto s = [&](int x, int y) {
    return lightly_smoothed(left, std::clamp(x, 0, left.width() - 1), std::clamp(y, 0, left.height() - 1));
  };
  const auto textured = [&](int x, int y) {
    const int gx = std::abs(s(x + 1, y) - s(x - 1, y));
    const int gy = std::abs(s(x, y + 1) - s(x, y - 1));
    return disparity.reject(x, y) == Reject::none && gx > static_cast<int>(std::floor(least * 128.0F)) &&
           2 * gx > gy;
  };
  const float agreement = config.agreement * 0.001F * static_cast<float>(left.width());
  Image<float> evidence(left.size());
  for (int y = 0; y < left.height(); ++y) {
    for (int x = 0; x < left.width(); ++x) {
      const float d = disparity.disparity_px(x, y);
      int friends = 0;
      for (int v = std::max(y - 2, 0); v <= std::min(y + 2, left.height() - 1); ++v) {
        for (int u = std::max(x - 2, 0); u <= std::min(x + 2, left.width() - 1); ++u) {
          if (u == x && v == y) continue;
          friends += textured(u, v) && std::abs(disparity.disparity_px(u, v) - d) <= agreement ? 1 : 0;
        }
      }
      evidence(x, y) = textured(x, y) && friends >= 3 ? d : std::numeric_limits<float>::quiet_NaN();
    }
  }
  return evidence;
}

Image<std::uint16_t> edge_strength(View<const Gray> gray, View<const Rgb> rgb, float smoothing_sigma) {
  Image<std::uint16_t> strength(gray.size());
  const auto magnitude = [&](int x, int y, const auto& value) {
    const auto s = [&](int u, int v) {
      return smoothed16(std::clamp(u, 0, gray.width() - 1), std::clamp(v, 0, gray.height() - 1),
                        smoothing_sigma, value);
    };
    const int gx = s(x + 1, y) - s(x - 1, y);
    const int gy = s(x, y + 1) - s(x, y - 1);
    return static_cast<int>(std::sqrt(static_cast<float>(gx * gx + gy * gy)) / 8 + 0.5F);
  };
  for (int y = 0; y < gray.height(); ++y) {
    for (int x = 0; x < gray.width(); ++x) {
      int strongest = 0;
      if (rgb.empty()) {
        strongest = magnitude(x, y, [&](int u, int v) { return int{clamped_at(gray, u, v)}; });
      } else {
        for (const auto channel : {&Rgb::r, &Rgb::g, &Rgb::b}) {
          const auto value = [&](int u, int v) { return int{clamped_at(rgb, u, v).*channel}; };
          strongest = std::max(strongest, magnitude(x, y, value));
        }
      }
      strength(x, y) = static_cast<std::uint16_t>(strongest);
    }
  }
  return strength;
}

}  // namespace cairn::reference
