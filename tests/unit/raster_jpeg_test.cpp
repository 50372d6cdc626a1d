// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/core/error.hpp>
#include <cairn/core/image.hpp>
#include <cstdlib>
#include <io/raster.hpp>
#include <new>
#include <random>
#include <string>
#include <support/noise.hpp>

namespace {

/// Which allocation of this thread from now on fails; below 0: none.
thread_local int failing = -1;

void* allocated(std::size_t size) {
  if (failing >= 0 && failing-- == 0) throw std::bad_alloc();
  if (void* memory = std::malloc(size == 0 ? 1 : size)) return memory;
  throw std::bad_alloc();
}

}  // namespace

void* operator new(std::size_t size) {
  return allocated(size);
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}

namespace cairn::io {
namespace {

/// Noise, which JPEG hardly makes smaller.
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

TEST(EncodeJpeg, FilesBeyondTheFirstBufferAreWhole) {
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

TEST(EncodeJpeg, AMissingBufferIsRefusedWhicheverItIs) {
  const Image<Gray> image = noise({900, 700});
  const PixelRows rows = rows_of(image);
  int refused = 0;
  for (int n = 0; n < 12; ++n) {
    failing = n;
    std::string says;
    try {
      const std::string file = encode_jpeg(rows);
      failing = -1;
      EXPECT_EQ(decode_jpeg(file).size, image.size());
    } catch (const Error& error) {
      failing = -1;
      says = error.what();
      ++refused;
    } catch (const std::bad_alloc&) {
      failing = -1;
      ++refused;
    }
    EXPECT_TRUE(says.empty() || says.starts_with("cannot be encoded as JPEG: ")) << says;
  }
  EXPECT_GE(refused, 3);  // the first buffer and the larger ones that follow it
}

}  // namespace
}  // namespace cairn::io
