// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn_ros/conversions.hpp>

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

TEST(RosImages, RowsMayBeLongerThanTheImage) {
  const Picture picture = picture_from(image("mono8", 2, 3, {1, 2, 0, 3, 4, 0}));
  EXPECT_EQ(picture.gray.size(), (cairn::Size{2, 2}));
  EXPECT_EQ(picture.gray(1, 1), 4);
  EXPECT_TRUE(picture.rgb.empty());
}

TEST(RosImages, ChannelsAreInTheDeclaredOrder) {
  EXPECT_EQ(picture_from(image("rgb8", 1, 3, {10, 20, 30})).rgb(0, 0), (cairn::Rgb{10, 20, 30}));
  const Picture picture = picture_from(image("bgr8", 1, 3, {10, 20, 30}));
  EXPECT_EQ(picture.rgb(0, 0), (cairn::Rgb{30, 20, 10}));
  EXPECT_EQ(picture.gray(0, 0), (77 * 30 + 150 * 20 + 29 * 10 + 128) >> 8);
}

TEST(RosImages, RefusesInvalidImages) {
  EXPECT_THROW(picture_from(image("16UC1", 1, 2, {1, 2})), cairn::Error);
  EXPECT_THROW(picture_from(image("mono8", 3, 2, {1, 2})), cairn::Error);
  Image cut = image("mono8", 2, 2, {1, 2, 3, 4});
  cut.data.pop_back();
  EXPECT_THROW(picture_from(cut), cairn::Error);
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
