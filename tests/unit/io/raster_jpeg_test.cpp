// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/core/image.hpp>
#include <cairn/io/raster.hpp>
#include <cstdlib>
#include <random>
#include <string>
#include <support/temporary_folder.hpp>

namespace cairn::io {
namespace {

/// Noise, which JPEG hardly compresses.
Image<Gray> noise(Size size) {
  std::mt19937 random(5);
  Image<Gray> image(size);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) image(x, y) = static_cast<Gray>(random() % 256);
  }
  return image;
}

PixelRows rows_of(const Image<Gray>& image) {
  return {image.size(), 1, 1, image.row(0), static_cast<std::ptrdiff_t>(image.view().stride())};
}

TEST(EncodeJpeg, FilesBeyondTheFirstBufferAreComplete) {
  const Image<Gray> image = noise({900, 700});
  const std::string file = encode_jpeg(rows_of(image));
  EXPECT_GT(file.size(), 300'000U);
  const Raster raster = decode_jpeg(file);
  EXPECT_EQ(raster.size, image.size());
  double sum = 0;
  for (int y = 0; y < 700; ++y) {
    for (int x = 0; x < 900; ++x)
      sum += std::abs(int{image(x, y)} - int{raster.bytes[static_cast<std::size_t>(900 * y + x)]});
  }
  EXPECT_LT(sum / (900 * 700), 20);
}

TEST(DecodeJpeg, AShortFileClaimingAHugeSizeIsRefusedBeforeAllocation) {
  std::string file = encode_jpeg(rows_of(noise({16, 16})));
  const std::size_t frame = file.find("\xff\xc0");
  ASSERT_NE(frame, std::string::npos);
  file.replace(frame + 5, 4, "\x3e\x80\x3e\x80");
  EXPECT_TRUE(
      support::has(support::refusal([&] { (void)decode_jpeg(file); }), {"16000x16000", "cannot hold"}));
  file.replace(frame + 5, 4, "\xea\x60\xea\x60");
  EXPECT_TRUE(support::has(support::refusal([&] { (void)decode_jpeg(file); }), {"60000x60000"}));
}

}  // namespace
}  // namespace cairn::io
