// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/input/ros_pictures.hpp>
#include <cairn_ros/conversions.hpp>
#include <cmath>

#include "support/samples.hpp"

/// The conversions in ros2, with plain structs instead of those of rclcpp: cairn's own,
/// whose members have the same names.
namespace cairn_ros {
namespace {

using namespace cairn::ros;

/// Every member has a distinct value, and every list two entries.
class Filler {
 public:
  void operator()(std::string_view /*name*/, auto& value) { fill(value); }

 private:
  template <class T>
  requires std::is_arithmetic_v<T>
  void fill(T& value) { value = static_cast<T>(++next_ % 100 + 1); }
  void fill(bool& value) { value = true; }
  void fill(std::string& text) { text = "text " + std::to_string(++next_); }
  template <class T>
  void fill(std::vector<T>& list) {
    list.resize(2);
    for (T& value : list) fill(value);
  }
  template <class T, std::size_t N>
  void fill(std::array<T, N>& list) {
    for (T& value : list) fill(value);
  }
  void fill(Message auto& message) { message.each(message, *this); }
  int next_ = 0;
};

template <class M>
class RosConversions : public testing::Test {};
using Copied = testing::Types<Header, Image, DisparityImage, PointCloud2, Detection3DArray, TransformStamped>;
TYPED_TEST_SUITE(RosConversions, Copied);

TYPED_TEST(RosConversions, CopyEveryMember) {
  TypeParam message;
  Filler filler;
  TypeParam::each(message, filler);
  EXPECT_EQ(encode(as<TypeParam>(message)), encode(message));
}

Image image(const std::string& encoding, std::uint32_t width, std::uint32_t step, Bytes data) {
  Image message;
  message.encoding = encoding;
  message.width = width;
  message.height = static_cast<std::uint32_t>(data.size() / step);
  message.step = step;
  message.data = std::move(data);
  return message;
}

cairn::io::LoadedPair pictures(const Image& message) {
  const Image copy = image_from(message);
  return cairn::input::pictures_of(copy, "left", copy, "right", 8, {});
}

TEST(RosImages, AreThoseOfRecordings) {
  const auto grey = pictures(image("mono8", 2, 3, {1, 2, 0, 3, 4, 0})).left;
  EXPECT_EQ(grey.gray.size(), (cairn::Size{2, 2}));
  EXPECT_EQ(grey.gray(1, 1), 4);
  EXPECT_TRUE(grey.rgb.empty());
  EXPECT_EQ(pictures(image("bgr8", 1, 3, {10, 20, 30})).left.rgb(0, 0), (cairn::Rgb{30, 20, 10}));
  Image deep = image("mono16", 1, 2, {0x12, 0xff});
  deep.is_bigendian = 1;
  EXPECT_EQ(pictures(deep).left.gray(0, 0), 0x12FF >> 5);
  EXPECT_THROW(pictures(image("32FC1", 1, 4, {1, 2, 3, 4})), cairn::Error);
}

/// Colours of a sample, smoothed a little as by a lens: a demosaic cannot know single pixels.
cairn::Image<cairn::Rgb> colours_of_sample() {
  const auto sharp = cairn::samples::load("four_in_a_row").images.left.rgb;
  cairn::Image<cairn::Rgb> smooth(sharp.size());
  for (int y = 0; y < sharp.height(); ++y) {
    for (int x = 0; x < sharp.width(); ++x) {
      std::array<int, 4> sum{};
      for (int v = std::max(0, y - 2); v < std::min(sharp.height(), y + 3); ++v) {
        for (int u = std::max(0, x - 2); u < std::min(sharp.width(), x + 3); ++u) {
          const cairn::Rgb one = sharp(u, v);
          sum = {sum[0] + one.r, sum[1] + one.g, sum[2] + one.b, sum[3] + 1};
        }
      }
      const auto mean = [&](int i) { return static_cast<std::uint8_t>(sum[i] / sum[3]); };
      smooth(x, y) = {mean(0), mean(1), mean(2)};
    }
  }
  return smooth;
}

struct ColourError {
  double mean = 0;
  int most = 0;
};
/// Over all channels, without the border of two pixels that a demosaic extrapolates.
ColourError error_of(const cairn::Image<cairn::Rgb>& found, const cairn::Image<cairn::Rgb>& truth) {
  ColourError error;
  if (found.size() != truth.size()) return {1e9, 255};
  for (int y = 2; y < truth.height() - 2; ++y) {
    for (int x = 2; x < truth.width() - 2; ++x) {
      const cairn::Rgb a = found(x, y);
      const cairn::Rgb b = truth(x, y);
      for (const int difference : {std::abs(a.r - b.r), std::abs(a.g - b.g), std::abs(a.b - b.b)}) {
        error.mean += difference;
        error.most = std::max(error.most, difference);
      }
    }
  }
  error.mean /= 3.0 * (truth.width() - 4) * (truth.height() - 4);
  return error;
}

TEST(RosImages, MosaicsOfAllPatternsGiveTheColoursBack) {
  const auto truth = colours_of_sample();
  for (const std::string pattern : {"rggb", "bggr", "gbrg", "grbg"}) {
    for (const int bytes : {1, 2}) {
      Bytes data;
      for (int y = 0; y < truth.height(); ++y) {
        for (int x = 0; x < truth.width(); ++x) {
          const char colour = pattern[static_cast<std::size_t>(2 * (y % 2) + x % 2)];
          const cairn::Rgb at = truth(x, y);
          const std::uint8_t value = colour == 'r' ? at.r : colour == 'g' ? at.g : at.b;
          if (bytes == 2) data.push_back(0);  // little-endian, the high byte last
          data.push_back(value);
        }
      }
      const auto width = static_cast<std::uint32_t>(truth.width());
      const std::string encoding = "bayer_" + pattern + std::to_string(8 * bytes);
      const auto found =
          pictures(image(encoding, width, width * static_cast<std::uint32_t>(bytes), data)).left;
      const ColourError error = error_of(found.rgb, truth);
      EXPECT_LT(error.mean, 1) << encoding;
      EXPECT_LT(error.most, 40) << encoding;
    }
  }
}

TEST(RosImages, YuvGivesTheColoursBack) {
  // Colours that are equal in blocks of four, in the luminances of BT.601.
  const cairn::Size size{32, 16};
  cairn::Image<cairn::Rgb> truth(size);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      truth(x, y) = {static_cast<std::uint8_t>(8 * (x / 2 * 2) % 256), static_cast<std::uint8_t>(y / 2 * 30),
                     static_cast<std::uint8_t>(255 - 7 * (x / 2 * 2))};
  const auto rounded = [](double value) { return static_cast<std::uint8_t>(std::lround(value)); };
  const auto luminance = [&](cairn::Rgb c) { return rounded(16 + .257 * c.r + .504 * c.g + .098 * c.b); };
  const auto u_of = [&](cairn::Rgb c) { return rounded(128 - .148 * c.r - .291 * c.g + .439 * c.b); };
  const auto v_of = [&](cairn::Rgb c) { return rounded(128 + .439 * c.r - .368 * c.g - .071 * c.b); };
  Bytes uyvy;
  Bytes yuyv;
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; x += 2) {
      const auto l = luminance(truth(x, y));
      const auto u = u_of(truth(x, y));
      const auto v = v_of(truth(x, y));
      uyvy.insert(uyvy.end(), {u, l, v, l});
      yuyv.insert(yuyv.end(), {l, u, l, v});
    }
  }
  Bytes nv12;
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) nv12.push_back(luminance(truth(x, y)));
  Bytes nv21 = nv12;
  Bytes i420 = nv12;
  Bytes last_plane;
  for (int y = 0; y < size.height; y += 2) {
    for (int x = 0; x < size.width; x += 2) {
      const auto u = u_of(truth(x, y));
      const auto v = v_of(truth(x, y));
      nv12.insert(nv12.end(), {u, v});
      nv21.insert(nv21.end(), {v, u});
      i420.push_back(u);
      last_plane.push_back(v);
    }
  }
  i420.insert(i420.end(), last_plane.begin(), last_plane.end());
  const auto width = static_cast<std::uint32_t>(size.width);
  const auto expect = [&](const char* encoding, std::uint32_t step, const Bytes& data) {
    Image message = image(encoding, width, step, data);
    message.height = static_cast<std::uint32_t>(size.height);
    EXPECT_LE(error_of(pictures(message).left.rgb, truth).most, 3) << encoding;
    message.data.pop_back();
    EXPECT_THROW(pictures(message), cairn::Error) << encoding;
    message.height -= 1;
    EXPECT_THROW(pictures(message), cairn::Error) << encoding;
  };
  expect("yuv422", 2 * width, uyvy);
  expect("uyvy", 2 * width, uyvy);
  expect("yuv422_yuy2", 2 * width, yuyv);
  expect("yuyv", 2 * width, yuyv);
  expect("nv12", width, nv12);
  expect("nv21", width, nv21);
  expect("i420", width, i420);
}

TEST(RosImages, CameraInfoKeepsTheRig) {
  CameraInfo info;
  info.width = 640;
  info.p[3] = -30;
  EXPECT_EQ(camera_info_from(info).p, info.p);
  EXPECT_EQ(camera_info_from(info).width, 640U);
  EXPECT_EQ(stamp_from(Header{{1, 5}, ""}).ns, 1'000'000'005);
}

}  // namespace
}  // namespace cairn_ros
