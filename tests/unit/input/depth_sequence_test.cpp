// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/core/error.hpp>
#include <cairn/input/ros_depth.hpp>
#include <cairn/input/sequence.hpp>
#include <cairn/input/stamped_images.hpp>
#include <cairn/io/disparity_files.hpp>
#include <cairn/io/raster.hpp>
#include <cairn/stereo/disparity_map.hpp>
#include <cmath>
#include <cstring>
#include <limits>

#include "support/recordings.hpp"
#include "support/temporary_folder.hpp"

/// Depth images and disparities instead of a right image: from folders and recordings.
namespace cairn::input {
namespace {

namespace fs = std::filesystem;
using recordings::CameraFile;
using support::has;
using support::refusal;
using support::TemporaryFolder;

constexpr Size kSize{24, 16};
const std::string kOneCamera = "fx=20\nfy=20\ncx=12\ncy=8\nwidth=24\nheight=16\n";
const StereoRig kAssumed{20, 12, 8, io::kDepthBaseline_m, 0};

/// 1 m at the left border, 1 mm more in each column; the first row is unknown.
Image<std::uint16_t> millimetres(unsigned scale = 1) {
  Image<std::uint16_t> depth(kSize, 0, {});
  for (int y = 1; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x)
      depth(x, y) = static_cast<std::uint16_t>((1000U + static_cast<unsigned>(x)) * scale);
  return depth;
}

void expect_depths(View<const float> disparity_px, const std::optional<StereoRig>& rig, float tolerance = 0) {
  ASSERT_TRUE(rig);
  ASSERT_EQ(disparity_px.size(), kSize);
  for (int x = 0; x < kSize.width; ++x) {
    EXPECT_TRUE(std::isnan(disparity_px(x, 0)));
    const auto point = rig->point_in_camera_m(12, 8, disparity_px(x, 3));
    ASSERT_TRUE(point);
    EXPECT_NEAR(point->z, 1.0F + 1e-3F * static_cast<float>(x), 1e-5F + tolerance);
  }
}

std::vector<SequenceFrame> frames_of(const std::string& source, const SourceOptions& options = {}) {
  const auto sequence = open_sequence(source, options);
  std::vector<SequenceFrame> frames;
  while (auto frame = sequence->next()) frames.push_back(std::move(*frame));
  return frames;
}

class DepthFolder : public testing::Test {
 protected:
  [[nodiscard]] fs::path at(const std::string& name) const {
    fs::create_directories((folder_.path() / name).parent_path());
    return folder_.path() / name;
  }
  [[nodiscard]] std::string source() const { return folder_.path().string(); }
  void image(const std::string& name, unsigned seed = 1) const {
    const Image<Gray> picture = recordings::dots(kSize, seed);
    io::save_png(at(name), picture.view());
  }
  void depth(const std::string& name, unsigned scale = 1) const {
    const Image<std::uint16_t> values = millimetres(scale);
    io::save_png(at(name), values.view());
  }
  void text(const std::string& name, const std::string& content) const {
    recordings::write(at(name), content);
  }

 private:
  TemporaryFolder folder_;
};

TEST_F(DepthFolder, AFrameHasADepthImageInsteadOfARightOne) {
  text("calib.txt", kOneCamera);
  for (const std::string name : {"0", "1"}) {
    image(name + "/left.png", name == "0" ? 1 : 2);
    depth(name + "/depth.png");
  }
  const auto sequence = open_sequence(source(), {});
  ASSERT_TRUE(sequence->rig());
  EXPECT_EQ(sequence->rig()->baseline_m, io::kDepthBaseline_m);
  const auto frames = frames_of(source());
  ASSERT_EQ(frames.size(), 2U);
  EXPECT_TRUE(frames[1].right.empty());
  expect_depths(frames[1].disparity_px, kAssumed);
  EXPECT_TRUE(has(refusal([&] { (void)pair_of(frames[0]); }), {"expected a pair"}));
}

TEST_F(DepthFolder, TheBaselineOfTheCalibrationSetsTheUnitOfDisparitiesAndNoPosition) {
  text("calib.txt", kOneCamera + "baseline=0.05\ndoffs=1.5\n");
  image("0/rgb.png");
  depth("0/depth.png");
  const StereoRig rig{20, 12, 8, 0.05F, 1.5F};
  const auto frames = frames_of(source());
  expect_depths(frames.at(0).disparity_px, rig);
}

TEST_F(DepthFolder, OfTumIsPairedByItsStamps) {
  text("calib.txt", kOneCamera);
  text("rgb.txt", "# timestamp filename\n");
  image("rgb/1305031102.175304.png", 1);
  image("rgb/1305031102.211214.png", 2);
  image("rgb/1305031103.000000.png", 3);
  depth("depth/1305031102.160407.png", 5);
  depth("depth/1305031102.226738.png", 5);
  const auto sequence = open_sequence(source(), {});
  const auto first = sequence->next();
  const auto second = sequence->next();
  ASSERT_TRUE(first && second);
  EXPECT_FALSE(sequence->next());
  expect_depths(first->disparity_px, kAssumed);
  EXPECT_EQ(first->stamp.ns, 1305031102175304000);
  EXPECT_EQ(second->stamp.ns, 1305031102211214000);
  ASSERT_EQ(sequence->remarks().size(), 2U) << "and both depths are equal";
  EXPECT_EQ(sequence->remarks().back().what, "depth image repeated from the frame before, the left one new");
  EXPECT_EQ(sequence->remarks().front().what, "image without a map");
}

TEST_F(DepthFolder, UnitsCanBeGiven) {
  text("calib.txt", kOneCamera);
  image("color/a.png");
  depth("depth/a.png", 10);
  SourceOptions options;
  options.maps.depth_units_per_m = 10'000;
  expect_depths(frames_of(source(), options).at(0).disparity_px, kAssumed);
  options.maps.depth_units_per_m = 0.1;
  EXPECT_TRUE(has(refusal([&] { frames_of(source(), options); }), {"--depth-units: found 0.1"}));
}

TEST_F(DepthFolder, AFolderOfMapsIsUsedInsteadOfMatching) {
  text("calib.txt", kOneCamera + "baseline=0.15\n");
  image("0/left.png");
  image("0/right.png", 2);
  Image<float> map(kSize);
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x)
      map(x, y) = y == 0 ? std::nanf("") : 3.0F / (1.0F + 1e-3F * static_cast<float>(x));
  io::save_disparity(at("maps/0.pfm"), map);
  SourceOptions options;
  options.maps.disparity = at("maps").string();
  fs::rename(at("maps"), fs::path(source() + "_maps"));
  options.maps.disparity = source() + "_maps";
  const auto frames = frames_of(source(), options);
  fs::remove_all(source() + "_maps");
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_FALSE(frames[0].right.empty()) << "it checks the map";
  expect_depths(frames[0].disparity_px, kAssumed);
  EXPECT_TRUE(frames_of(source()).at(0).disparity_px.empty());
}

TEST_F(DepthFolder, WhatDoesNotFitIsRefusedInOneLine) {
  image("0/left.png");
  depth("0/depth.png");
  EXPECT_TRUE(has(refusal([&] { frames_of(source()); }), {"needs the focal length"}));
  text("calib.txt", kOneCamera);
  SourceOptions options;
  options.maps.depth = at("0/depth.png").string();
  options.maps.disparity = "x";
  EXPECT_TRUE(
      has(refusal([&] { frames_of(source(), options); }), {"--depth-image: found --disparity as well"}));
  options.maps = {};
  options.maps.disparity = at("nothing").string();
  EXPECT_TRUE(
      has(refusal([&] { frames_of("run.mp4", options); }), {"--disparity: is for a folder of frames"}));
  options.maps = {};
  options.rectify = true;
  options.calib = at("calib.txt").string();
  EXPECT_TRUE(has(refusal([&] { frames_of(source(), options); }), {"belongs to a rectified image"}));
  const Image<std::uint16_t> small({12, 8}, 0, {});
  io::save_png(at("0/depth.png"), small.view());
  EXPECT_TRUE(
      has(refusal([&] { frames_of(source()); }), {"the depth image is 12x8, the left image is 24x16"}));
  const Image<Gray> shallow(kSize, 0, {});
  io::save_png(at("0/depth.png"), shallow.view());
  EXPECT_TRUE(has(refusal([&] { frames_of(source()); }), {"has 8 bits, expected the 16 of a depth image"}));
}

// ---- recordings ----

class DepthRecording : public testing::Test {
 protected:
  [[nodiscard]] fs::path file() const { return folder_.path() / "run.mcap"; }
  /// One image with its camera_info, and what `add` adds.
  template <class Add>
  void record(const std::string& image, const std::string& encoding, const Add& add) const {
    CameraFile camera(file());
    const std::string folder = image.substr(0, image.rfind('/'));
    const Image<Gray> dots = recordings::dots(kSize, 1);
    ros::Image picture = ros::image_of(ros::header_of(kStamp, "camera"), dots.view());
    if (!encoding.empty()) picture.encoding = encoding;
    ros::CameraInfo info;
    info.width = 24;
    info.height = 16;
    info.k = {20, 0, 12, 0, 20, 8, 0, 0, 1};  // P is left empty by some drivers
    camera.add(camera.topic<ros::Image>(image), kStamp, picture);
    camera.add(camera.topic<ros::CameraInfo>(folder + "/camera_info"), kStamp, info);
    add(camera);
  }
  static ros::Image depth_16() {
    ros::Image message;
    message.header = ros::header_of(kStamp, "camera");
    const Image<std::uint16_t> depth = millimetres();
    message.width = 24;
    message.height = 16;
    message.encoding = "16UC1";
    message.step = 2 * 24 + 6;  // rows may be longer than the image
    message.data.assign(std::size_t{message.step} * 16, 0);
    for (int y = 0; y < 16; ++y)
      std::memcpy(message.data.data() + static_cast<std::size_t>(y) * message.step, depth.row(y), 48);
    return message;
  }
  static Image<float> metres() {
    Image<float> depth(kSize);
    for (int y = 0; y < 16; ++y)
      for (int x = 0; x < 24; ++x)
        depth(x, y) = y == 0 ? std::nanf("") : 1.0F + 1e-3F * static_cast<float>(x);
    return depth;
  }
  static constexpr Stamp kStamp{1'000'000'000};

 private:
  TemporaryFolder folder_;
};

TEST_F(DepthRecording, DepthsInMillimetresBelongToTheirImage) {
  record("/camera/color/image_raw", "", [](CameraFile& camera) {
    camera.add(camera.topic<ros::Image>("/camera/aligned_depth_to_color/image_raw"), kStamp, depth_16());
  });
  const auto frames = frames_of(file().string());
  ASSERT_EQ(frames.size(), 1U);
  expect_depths(frames[0].disparity_px, kAssumed);
  EXPECT_TRUE(frames[0].right.empty());
}

TEST_F(DepthRecording, DepthsInMetresBigEndianToo) {
  record("/zed/rgb/image_rect_color", "", [](CameraFile& camera) {
    const Image<float> depth = metres();
    ros::Image message = ros::image_of(ros::header_of(kStamp, "camera"), depth.view());
    message.is_bigendian = 1;
    for (std::size_t i = 0; i < message.data.size(); i += 4)
      std::reverse(message.data.begin() + static_cast<std::ptrdiff_t>(i),
                   message.data.begin() + static_cast<std::ptrdiff_t>(i) + 4);
    camera.add(camera.topic<ros::Image>("/zed/depth/depth_registered"), kStamp, message);
  });
  expect_depths(frames_of(file().string()).at(0).disparity_px, kAssumed);
}

TEST_F(DepthRecording, ATopicWithAnotherNameIsDepthByItsEncoding) {
  record("/oak/rgb/image_rect", "", [](CameraFile& camera) {
    camera.add(camera.topic<ros::Image>("/oak/stereo/image_raw"), kStamp, depth_16());
  });
  SourceOptions options;
  options.topics = "/oak/rgb/image_rect,/oak/stereo/image_raw";
  expect_depths(frames_of(file().string(), options).at(0).disparity_px, kAssumed);
}

TEST_F(DepthRecording, CompressedDepthIsUnpacked) {
  const auto packed = [](bool is_inverse) {
    ros::CompressedImage message;
    message.header = ros::header_of(kStamp, "camera");
    message.format = is_inverse ? "32FC1; compressedDepth png" : "16UC1; compressedDepth";
    Image<std::uint16_t> values = millimetres();
    const float a = 30'000;
    const float b = -10;
    for (int y = 1; y < 16 && is_inverse; ++y)
      for (int x = 0; x < 24; ++x)
        values(x, y) = static_cast<std::uint16_t>(std::lround(a / metres()(x, y) + b));
    message.data.assign(12, 0);
    std::memcpy(message.data.data() + 4, &a, 4);
    std::memcpy(message.data.data() + 8, &b, 4);
    const std::string png = io::encode_png(
        {kSize, 1, 2, reinterpret_cast<const std::uint8_t*>(values.row(0)), values.view().stride() * 2});
    message.data.insert(message.data.end(), png.begin(), png.end());
    return message;
  };
  for (const bool is_inverse : {false, true}) {
    record("/camera/color/image_raw", "", [&](CameraFile& camera) {
      camera.add(
          camera.topic<ros::CompressedImage>("/camera/aligned_depth_to_color/image_raw/compressedDepth"),
          kStamp, packed(is_inverse));
    });
    expect_depths(frames_of(file().string()).at(0).disparity_px, kAssumed, is_inverse ? 5e-5F : 0);
  }
}

TEST_F(DepthRecording, ADisparityImageKnowsItsRig) {
  record("/stereo/left/image_rect", "", [](CameraFile& camera) {
    ros::DisparityImage message;
    message.header = ros::header_of(kStamp, "camera");
    message.f = 20;
    message.t = 0.07F;
    message.min_disparity = 0;
    Image<float> disparity_px(kSize);
    for (int y = 0; y < 16; ++y)
      for (int x = 0; x < 24; ++x)
        disparity_px(x, y) = y == 0 ? -1.0F : 1.4F / (1.0F + 1e-3F * static_cast<float>(x));
    message.image = ros::image_of(message.header, View<const float>(disparity_px));
    camera.add(camera.topic<ros::DisparityImage>("/stereo/disparity"), kStamp, message);
  });
  const auto sequence = open_sequence(file().string(), {});
  ASSERT_TRUE(sequence->rig());
  EXPECT_EQ(sequence->rig()->baseline_m, 0.07F);
  EXPECT_EQ(sequence->rig()->cx_px, 12);
  const auto frame = sequence->next();
  ASSERT_TRUE(frame);
  expect_depths(frame->disparity_px, sequence->rig());
}

/// A camera with a right image that checks the depth: three frames, the right images as told.
class CheckedRecording : public DepthRecording {
 protected:
  static constexpr std::int64_t kPeriod_ns = 100'000'000;
  static Image<Gray> right_image(int frame) {
    return recordings::dots(kSize, 100 + static_cast<unsigned>(frame));
  }
  void record_three(bool has_right_info, const std::vector<int>& right_frames) const {
    CameraFile camera(file());
    const auto left = camera.topic<ros::Image>("/left/image_rect");
    const auto right = camera.topic<ros::Image>("/right/image_rect");
    const auto depth = camera.topic<ros::Image>("/left/depth");
    const StereoRig rig{20, 12, 8, 0.07F, 0};
    for (int i = 0; i < 3; ++i) {
      const Stamp stamp{kStamp.ns + i * kPeriod_ns};
      const ros::Header header = ros::header_of(stamp, "camera");
      const Image<Gray> picture = recordings::dots(kSize, 1 + static_cast<unsigned>(i));
      camera.add(left, stamp, ros::image_of(header, picture.view()));
      ros::Image message = depth_16();
      message.header = header;
      camera.add(depth, stamp, message);
      camera.add(camera.topic<ros::CameraInfo>("/left/camera_info"), stamp,
                 ros::camera_info_of(header, rig, kSize, ros::Side::left));
      if (has_right_info) {
        camera.add(camera.topic<ros::CameraInfo>("/right/camera_info"), stamp,
                   ros::camera_info_of(header, rig, kSize, ros::Side::right));
      }
      // Later than its depth, as a recorder may write it.
      if (std::ranges::count(right_frames, i) == 0) continue;
      const Image<Gray> other = right_image(i);
      camera.add(right, stamp, ros::image_of(ros::header_of({stamp.ns + 2'000'000}, "right"), other.view()));
    }
  }
  [[nodiscard]] SourceOptions three() const {
    SourceOptions options;
    options.topics = "/left/image_rect,/right/image_rect,/left/depth";
    return options;
  }
};

TEST_F(CheckedRecording, HasTheRightImageOfEachFrameAndTheBaseline) {
  record_three(true, {0, 1, 2});
  const auto frames = frames_of(file().string(), three());
  ASSERT_EQ(frames.size(), 3U);
  for (int i = 0; i < 3; ++i) {
    const auto& frame = frames[static_cast<std::size_t>(i)];
    expect_depths(frame.disparity_px, StereoRig{20, 12, 8, 0.07F, 0});
    ASSERT_EQ(frame.right.size(), kSize);
    const Image<Gray> expected = right_image(i);
    for (int y = 0; y < kSize.height; ++y)
      EXPECT_TRUE(std::equal(expected.row(y), expected.row(y) + kSize.width, frame.right.row(y)))
          << i << " " << y;
  }
}

TEST_F(CheckedRecording, AFrameWithoutItsRightImageSaysSo) {
  record_three(true, {0, 2});
  const auto sequence = open_sequence(file().string(), three());
  std::vector<bool> has_right;
  while (const auto frame = sequence->next()) has_right.push_back(!frame->right.empty());
  EXPECT_EQ(has_right, (std::vector<bool>{true, false, true}));
  const auto remarks = sequence->remarks();
  const auto said = std::ranges::find(remarks, unchecked_on("/right/image_rect"), &SourceRemark::what);
  ASSERT_NE(said, remarks.end());
  EXPECT_EQ(said->count, 1U);
  EXPECT_EQ(said->first, "000001");
}

TEST_F(CheckedRecording, ARightImageOfAnotherFrameChecksNothing) {
  record_three(true, {0, 2});
  SourceOptions options = three();
  options.max_skew_ms = 150;  // more than a period
  const auto frames = frames_of(file().string(), options);
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_TRUE(frames[1].right.empty());
  EXPECT_FALSE(frames[2].right.empty());
}

TEST_F(CheckedRecording, ACalibrationMayHaveTheBaseline) {
  record_three(false, {0, 1, 2});
  SourceOptions options = three();
  const fs::path calib = file().parent_path() / "calib.txt";
  recordings::write(calib, kOneCamera + "baseline=0.09\n");
  options.calib = calib.string();
  const auto sequence = open_sequence(file().string(), options);
  ASSERT_TRUE(sequence->rig());
  EXPECT_EQ(sequence->rig()->baseline_m, 0.09F);
  EXPECT_FALSE(sequence->next()->right.empty());
}

TEST(StampedImagesTest, AreTakenByTheNearestStamp) {
  const auto image = [](std::uint8_t value) {
    io::Raster raster;
    raster.size = {1, 1};
    raster.bytes = {value};
    return raster;
  };
  const auto ms = [](std::int64_t value) { return Stamp{value * 1'000'000}; };
  StampedImages images(20, 3);
  EXPECT_FALSE(images.reaches(ms(0)));
  images.push(ms(1000), image(1));
  images.push(ms(1010), image(2));
  images.push(ms(1005), image(9));  // out of order
  EXPECT_TRUE(images.reaches(ms(1010)));
  EXPECT_FALSE(images.reaches(ms(1011)));
  const auto taken = images.take(ms(1012));
  ASSERT_TRUE(taken);
  EXPECT_EQ(taken->bytes[0], 2);
  EXPECT_FALSE(images.take(ms(1040)));  // nothing within 20 ms
  images.push(ms(1050), image(3));
  EXPECT_FALSE(images.take(ms(1052)) && images.take(ms(1053))) << "each once";
  for (std::uint8_t i = 0; i < 5; ++i) images.push(ms(2000 + 10 * i), image(i));
  EXPECT_FALSE(images.take(ms(1990))) << "only the last three wait";
  images.push(ms(100), image(7));  // the clock was set back
  EXPECT_FALSE(images.reaches(ms(110)));
  const auto after = images.take(ms(101));
  ASSERT_TRUE(after);
  EXPECT_EQ(after->bytes[0], 7);
}

TEST_F(CheckedRecording, RefusesWhatCannotBeChecked) {
  record_three(false, {0, 1, 2});
  EXPECT_TRUE(has(refusal([&] { frames_of(file().string(), three()); }),
                  {"has no baseline", "camera_info of both cameras, or --calib FILE"}));
  SourceOptions options = three();
  options.topics = "/left/image_rect,/left/depth,/right/image_rect";
  EXPECT_TRUE(has(refusal([&] { frames_of(file().string(), options); }),
                  {"frame that cannot be read", "/right/image_rect", "mono8, expected depths"}));
  for (const char* topics : {"/left/image_rect", "a,b,c,d", "a,,c", "a,b,a"}) {
    options.topics = topics;
    EXPECT_TRUE(has(refusal([&] { frames_of(file().string(), options); }),
                    {topics, "expected LEFT,RIGHT, IMAGE,DEPTH or LEFT,RIGHT,DEPTH"}));
  }
}

TEST_F(DepthRecording, DepthOfAnotherSizeIsRefused) {
  record("/camera/color/image_raw", "", [](CameraFile& camera) {
    ros::Image message = depth_16();
    message.height = 8;
    camera.add(camera.topic<ros::Image>("/camera/aligned_depth_to_color/image_raw"), kStamp, message);
  });
  EXPECT_TRUE(has(refusal([&] { frames_of(file().string()); }), {"is 24x8, its image 24x16"}));
}

TEST(RosDepths, RefuseImpossibleMessages) {
  ros::Image picture;
  picture.encoding = "mono8";
  EXPECT_TRUE(has(refusal([&] { (void)depth_of(picture, {}); }), {"has the encoding mono8"}));
  picture.encoding = "16UC1";
  picture.width = picture.height = 4;
  picture.step = 8;
  picture.data.resize(31);
  EXPECT_TRUE(has(refusal([&] { (void)depth_of(picture, {}); }), {"has 31 bytes"}));
  ros::CompressedImage packed;
  packed.format = "16UC1; compressedDepth";
  packed.data.resize(3);
  EXPECT_TRUE(has(refusal([&] { (void)depth_of(packed, {}); }), {"has 3 bytes of depth"}));
  EXPECT_TRUE(has(refusal([&] {
                    (void)disparity_of({Image<float>({2, 2}), {}}, {2, 2}, {}, {});
                  }),
                  {"needs the focal length"}));
}

TEST(DepthImages, BecomeDisparitiesOfTheirRig) {
  const StereoRig rig{100, 8, 8, 0.2F, 3};
  Image<float> depth({4, 2});
  const float inf = std::numeric_limits<float>::infinity();
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 4; ++x)
      depth(x, y) = std::array{0.0F, -1.0F, inf, 2.0F}.at(static_cast<std::size_t>(x));
  depth(0, 1) = 1e-4F;  // nearer than disparities go
  const Image<float> disparity_px = disparity_of_depth(depth, rig);
  for (int x = 0; x < 3; ++x) EXPECT_TRUE(std::isnan(disparity_px(x, 0))) << x;
  EXPECT_TRUE(std::isnan(disparity_px(0, 1)));
  EXPECT_FLOAT_EQ(disparity_px(3, 1), 7);
  EXPECT_FLOAT_EQ(rig.point_in_camera_m(0, 0, disparity_px(3, 1))->z, 2);
}

}  // namespace
}  // namespace cairn::input
