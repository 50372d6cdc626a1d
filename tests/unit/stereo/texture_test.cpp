// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>
#include <cairn/stereo/texture.hpp>

#include "support/grids.hpp"

namespace cairn {
namespace {

using grids::random_image;

int count_rejected(const Image<Gray>& image, const TextureConfig& config) {
  const auto verdict = reject_textureless(image, config, {});
  int count = 0;
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) count += verdict(x, y) == Reject::no_texture ? 1 : 0;
  }
  return count;
}

template <class Value>
Image<Gray> picture(Size size, Value value) {
  Image<Gray> image(size);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) image(x, y) = static_cast<Gray>(value(x, y));
  }
  return image;
}

TEST(Texture, RejectsAPlainSurface) {
  const auto plain = picture({20, 15}, [](int, int) { return 77; });
  EXPECT_EQ(count_rejected(plain, {9, 4.0F}), 20 * 15);
}
TEST(Texture, KeepsRandomDots) {
  EXPECT_EQ(count_rejected(random_image<Gray>({20, 15}, 0, 255, 1), {9, 4.0F}), 0);
}

TEST(Texture, RejectsStripesSinceOneShiftAlongThemChangesNothing) {
  // This distinguishes the Moravec operator from plain contrast.
  EXPECT_EQ(count_rejected(picture({20, 20}, [](int x, int) { return x % 4 < 2 ? 0 : 200; }), {5, 4.0F}),
            400);
  EXPECT_EQ(count_rejected(picture({20, 20}, [](int, int y) { return y % 4 < 2 ? 0 : 200; }), {5, 4.0F}),
            400);
  EXPECT_EQ(
      count_rejected(picture({20, 20}, [](int x, int y) { return (x + y) % 4 < 2 ? 0 : 200; }), {5, 4.0F}),
      400);
  EXPECT_EQ(count_rejected(picture({20, 20}, [](int x, int y) { return (20 + x - y) % 4 < 2 ? 0 : 200; }),
                           {5, 4.0F}),
            400);
}

TEST(Texture, ComparesTheMeanSquaredDifferenceExactly) {
  const auto image = picture({60, 60}, [](int x, int y) { return (x + 2 * y * y + y) % 3 + 10; });
  const auto at = [&](float threshold) { return reject_textureless(image, {3, threshold}, {})(30, 30); };
  double least = 1e9;
  for (const auto [dx, dy] : {Point{1, 0}, Point{0, 1}, Point{1, 1}, Point{1, -1}}) {
    double sum = 0;
    for (int y = 29; y <= 31; ++y) {
      for (int x = 29; x <= 31; ++x)
        sum += (image(x, y) - image(x + dx, y + dy)) * (image(x, y) - image(x + dx, y + dy));
    }
    least = std::min(least, sum / 9);
  }
  ASSERT_GT(least, 0);
  EXPECT_EQ(at(static_cast<float>(least * 0.999)), Reject::none);
  EXPECT_EQ(at(static_cast<float>(least * 1.001)), Reject::no_texture);
}

TEST(Texture, AnImageOfOnePixelIsPlain) {
  EXPECT_EQ(count_rejected(picture({1, 1}, [](int, int) { return 5; }), {3, 0.0F}), 1);
}
TEST(Texture, ThresholdZeroKeepsEverythingElse) {
  EXPECT_EQ(count_rejected(picture({2, 1}, [](int, int) { return 5; }), {31, 0.0F}), 0);
}
TEST(Texture, MinusOneSwitchesItOff) {
  EXPECT_EQ(count_rejected(picture({9, 9}, [](int, int) { return 5; }), {3, -1.0F}), 0);
}

}  // namespace
}  // namespace cairn
