// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>
#include <cairn/core/error.hpp>
#include <cairn/ros/messages.hpp>
#include <random>

namespace cairn::ros {
namespace {

CameraInfo some_info() {
  CameraInfo info;
  info.header = {{12, 34}, "left"};
  info.height = 480;
  info.width = 640;
  info.distortion_model = "plumb_bob";
  info.d = {0.1, -0.2, 0, 0, 0.5};
  info.k = {500, 0, 320, 0, 500, 240, 0, 0, 1};
  info.r = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  info.p = {500, 0, 320, -50, 0, 500, 240, 0, 0, 0, 1, 0};
  info.roi.do_rectify = true;
  return info;
}

Detection3DArray some_detections() {
  Detection3DArray array;
  array.header = {{1, 2}, "camera"};
  for (int i = 0; i < 2; ++i) {
    Detection3D found;
    found.header = array.header;
    found.id = std::to_string(7 + i);
    found.bbox.center.position = {0.5, 0.25, 2.0 + i};
    found.bbox.size = {1, 2, 3};
    ObjectHypothesisWithPose result;
    result.hypothesis = {"object", 0.75};
    result.pose.pose = found.bbox.center;
    result.pose.covariance[35] = 9;
    found.results.push_back(result);
    array.detections.push_back(found);
  }
  return array;
}

PointCloud2 some_cloud() {
  PointCloud2 cloud;
  cloud.fields = {{"x", 0, PointField::kFloat32, 1}, {"object", 4, PointField::kUint32, 1}};
  cloud.height = 1;
  cloud.width = 2;
  cloud.point_step = 8;
  cloud.row_step = 16;
  cloud.data = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16};
  cloud.is_dense = true;
  return cloud;
}

OccupancyGrid some_grid() {
  OccupancyGrid grid;
  grid.info.resolution = 0.05F;
  grid.info.width = 2;
  grid.info.height = 2;
  grid.data = {-1, 0, 100, -1};
  return grid;
}

DisparityImage some_disparity() {
  DisparityImage disparity;
  disparity.image.encoding = "32FC1";
  disparity.image.data = {0, 0, 128, 63};
  disparity.f = 500;
  disparity.t = 0.1F;
  disparity.max_disparity = 63;
  return disparity;
}

TFMessage some_transforms() {
  TFMessage message;
  message.transforms.push_back({{{5, 6}, "map"}, "camera", {{1, 2, 3}, {0, 0, 0.6, 0.8}}});
  return message;
}

template <class Visit>
void for_each_message(Visit visit) {
  visit(Time{-1, 999'999'999});
  visit(Header{{3, 4}, "frame"});
  visit(String{"words"});
  visit(Image{{{1, 2}, "left"}, 1, 3, "mono8", 0, 3, {7, 8, 9}});
  visit(CompressedImage{{{1, 2}, "left"}, "jpeg", {255, 216}});
  visit(some_info());
  visit(some_detections());
  visit(some_cloud());
  visit(some_grid());
  visit(some_disparity());
  visit(some_transforms());
}

TEST(RosMessages, BytesEqualThoseCountedByHand) {
  const Bytes header{0, 1, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 4, 0, 0, 0, 'c', 'a', 'm', 0};
  EXPECT_EQ(encode(Header{{1, 2}, "cam"}), header);
  const Bytes text{0, 1, 0, 0, 1, 0, 0, 0, 0};
  EXPECT_EQ(encode(String{""}), text);
  // Three pixels, after which the count is aligned to the next multiple of four.
  const Bytes image{0, 1, 0, 0, 1, 0, 0,   0,   2,   0,   0,   0, 2, 0, 0, 0, 'l', 0, 0, 0, 1, 0, 0, 0, 3, 0,
                    0, 0, 6, 0, 0, 0, 'm', 'o', 'n', 'o', '8', 0, 0, 0, 3, 0, 0,   0, 3, 0, 0, 0, 7, 8, 9};
  EXPECT_EQ(encode(Image{{{1, 2}, "l"}, 1, 3, "mono8", 0, 3, {7, 8, 9}}), image);
}

TEST(RosMessages, DoublesAreAlignedToEightAfterTheHeader) {
  const Bytes bytes = encode(ObjectHypothesis{"object", 0.5});
  ASSERT_EQ(bytes.size(), 4U + 16 + 8);  // 4 + 7 of text, then padding to 16
  EXPECT_EQ(bytes[4 + 16 + 6], 0xe0);    // 0.5 is 0x3fe0000000000000
  EXPECT_EQ(bytes[4 + 16 + 7], 0x3f);
}

TEST(RosMessages, RoundTrip) {
  for_each_message([](const auto& message) {
    using M = std::remove_cvref_t<decltype(message)>;
    const Bytes bytes = encode(message);
    EXPECT_EQ(encode(decode<M>(bytes)), bytes) << M::kType;
  });
  const auto info = decode<CameraInfo>(encode(some_info()));
  EXPECT_EQ(info.p, some_info().p);
  EXPECT_EQ(info.d, some_info().d);
  EXPECT_TRUE(info.roi.do_rectify);
  EXPECT_EQ(decode<OccupancyGrid>(encode(some_grid())).data, some_grid().data);
  EXPECT_EQ(decode<Detection3DArray>(encode(some_detections())).detections[1].id, "8");
}

TEST(RosMessages, RefuseTruncatedBytes) {
  for_each_message([](const auto& message) {
    using M = std::remove_cvref_t<decltype(message)>;
    const Bytes bytes = encode(message);
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      const Bytes cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
      EXPECT_THROW(decode<M>(cut), Error) << M::kType << " of " << size;
    }
  });
}

TEST(RosMessages, DamagedBytesAreReadOrRefused) {
  std::mt19937 random(1);
  for_each_message([&](const auto& message) {
    using M = std::remove_cvref_t<decltype(message)>;
    const Bytes bytes = encode(message);
    for (int i = 0; i < 2000; ++i) {
      Bytes damaged = bytes;
      for (int n = 0; n < 3; ++n) damaged[random() % damaged.size()] = static_cast<std::uint8_t>(random());
      try {
        decode<M>(damaged);
      } catch (const Error&) {
      }
    }
  });
}

TEST(RosMessages, CountsBeyondTheDataAllocateNothing) {
  Bytes bytes = encode(some_cloud());
  for (std::size_t i = 4; i + 4 <= bytes.size(); i += 4) {
    Bytes damaged = bytes;
    std::fill_n(damaged.begin() + static_cast<std::ptrdiff_t>(i), 4, std::uint8_t{255});
    try {
      decode<PointCloud2>(damaged);
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("sensor_msgs/msg/PointCloud2"), std::string::npos);
    }
  }
}

TEST(RosMessages, OtherEncodingsAreRefusedWithAMessage) {
  try {
    decode<String>(Bytes{0, 0, 0, 0, 0, 0, 0, 1, 0});
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(),
                 "std_msgs/msg/String: found encoding 0.0, expected a whole message in little-endian CDR");
  }
  EXPECT_THROW(decode<String>(Bytes{0, 1, 0, 0, 1, 0, 0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8}), Error);
}

TEST(RosMessages, DefinitionsNameEachMessageOnce) {
  EXPECT_EQ(schema_of<Header>(), "builtin_interfaces/Time stamp\nstring frame_id\n" + std::string(80, '=') +
                                     "\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n");
  const std::string text = schema_of<Detection3DArray>();
  EXPECT_EQ(text.find("std_msgs/Header header\nvision_msgs/Detection3D[] detections\n"), 0U);
  EXPECT_NE(text.find("float64[36] covariance\n"), std::string::npos);
  const std::size_t first = text.find("MSG: std_msgs/Header\n");
  EXPECT_NE(first, std::string::npos);
  EXPECT_EQ(text.find("MSG: std_msgs/Header\n", first + 1), std::string::npos);
}

TEST(RosMessages, StampsRoundTrip) {
  for (const std::int64_t ns : {0LL, 1LL, -1LL, 1'700'000'000'123'456'789LL, -5'000'000'000LL})
    EXPECT_EQ(stamp_of(time_of({ns})).ns, ns);
  EXPECT_EQ(time_of({-1}).sec, -1);
  EXPECT_EQ(time_of({-1}).nanosec, 999'999'999U);
  EXPECT_THROW(time_of({std::int64_t{3'000'000'000} * 1'000'000'000}), Error);
}

}  // namespace
}  // namespace cairn::ros
