// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/pipeline/segment.hpp>

#include "support/noise.hpp"

namespace cairn {
namespace {

/// The share of pixels that the preset `paper` rejects as untextured, in a uniform image with noise.
double share_without_texture(double noise_sigma, const Config& config) {
  const Size size{80, 60};
  const auto plain = [](int, int) { return 128.0; };
  const Image<Gray> left = support::picture(size, noise_sigma, 1, plain);
  const Image<Gray> right = support::picture(size, noise_sigma, 2, plain);
  const StereoResult scene = estimate_disparity(StereoPair::from(left, right), {}, config, {});
  int count = 0;
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x)
      count += has(scene.disparity.reject(x, y), Reject::no_texture) ? 1 : 0;
  }
  return count / static_cast<double>(size.area());
}

TEST(PaperPreset, RefusesAPlainImageWithCameraNoise) {
  Config config = Config::paper();
  config.match.num_disparities = 16;
  EXPECT_GT(share_without_texture(0.9, config), 0.9);
  config.texture.threshold = 1;  // refuses only noise-free uniform areas
  EXPECT_LT(share_without_texture(0.9, config), 0.1);
}

TEST(PaperPreset, IsThePublishedMethod) {
  const Config config = Config::paper();
  EXPECT_EQ(config.match.method, MatchMethod::window);
  EXPECT_EQ(config.pipeline.method, Method::paper);
  EXPECT_EQ(config.objects.min_confidence, 0.0F);
  EXPECT_EQ(config.speckle.size, -1);
  EXPECT_EQ(config.epipolar_correction.max_rows, -1);
}

}  // namespace
}  // namespace cairn
