// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <algorithm>
#include <cairn/core/image.hpp>
#include <cmath>
#include <random>

namespace cairn::support {

/// Gaussian noise that is identical for every standard library.
class Noise {
 public:
  explicit Noise(std::uint32_t seed) : random_(seed) {}
  /// In the open interval (0, 1).
  double uniform() { return (static_cast<double>(random_()) + 0.5) / 4294967296.0; }
  double gaussian(double sigma) {  // Box-Muller
    const double radius = std::sqrt(-2 * std::log(uniform()));
    return sigma * radius * std::cos(6.283185307179586 * uniform());
  }

 private:
  std::mt19937 random_;
};

/// An image from a brightness function, with noise, rounded and clipped.
template <class Brightness>
Image<Gray> picture(Size size, double noise_sigma, std::uint32_t seed, Brightness brightness) {
  Noise noise(seed);
  Image<Gray> image(size);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const double value = brightness(x, y) + (noise_sigma > 0 ? noise.gaussian(noise_sigma) : 0.0);
      image(x, y) = static_cast<Gray>(std::clamp(std::lround(value), 0L, 255L));
    }
  }
  return image;
}

}  // namespace cairn::support
