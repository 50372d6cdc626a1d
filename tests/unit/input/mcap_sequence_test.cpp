// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>
#include <cairn/core/error.hpp>
#include <cairn/input/sequence.hpp>
#include <cairn/io/image_files.hpp>

#include "support/recordings.hpp"
#include "support/temporary_folder.hpp"

namespace cairn::input {
namespace {

namespace fs = std::filesystem;
using recordings::CameraFile;
using recordings::dots;
using support::TemporaryFolder;

constexpr Size kSize{40, 30};
const StereoRig kRig{100, 19.5F, 14.5F, 0.12F, 0};

class McapSequence : public testing::Test {
 protected:
  [[nodiscard]] fs::path file() const { return folder_.path() / "run.mcap"; }
  [[nodiscard]] std::unique_ptr<Sequence> open(const SourceOptions& options = {}) const {
    return open_sequence(file().string(), options);
  }
  [[nodiscard]] std::string refusal(const SourceOptions& options = {}) const {
    try {
      (void)open(options);
    } catch (const Error& error) {
      return error.what();
    }
    return "none";
  }
  static ros::CameraInfo info(ros::Side side) { return ros::camera_info_of({}, kRig, kSize, side); }

 private:
  TemporaryFolder folder_;
};

bool shows_dots(View<const Gray> image, unsigned seed) {
  const Image<Gray> expected = dots(kSize, seed);
  if (image.size() != kSize) return false;
  for (int y = 0; y < image.height(); ++y)
    if (!std::equal(image.row(y), image.row(y) + image.width(), expected.row(y))) return false;
  return true;
}

ros::Image message_of_dots(Stamp stamp, unsigned seed) {
  const Image<Gray> image = dots(kSize, seed);
  return ros::image_of(ros::header_of(stamp, "camera"), image.view());
}

TEST_F(McapSequence, TheRigIsThatOfTheImagesAsTheyCome) {
  const auto record = [&](int twice, std::uint32_t binning) {
    CameraFile camera(file());
    StereoRig rig = kRig;
    for (float* value : {&rig.focal_px, &rig.cx_px, &rig.cy_px, &rig.doffs_px})
      *value *= static_cast<float>(twice);
    for (const ros::Side side : {ros::Side::left, ros::Side::right}) {
      const std::string name = side == ros::Side::left ? "/cam/left/" : "/cam/right/";
      camera.add(camera.topic<ros::Image>(name + "image_rect"), {1000}, message_of_dots({1000}, 1));
      ros::CameraInfo full = ros::camera_info_of({}, rig, {kSize.width * twice, kSize.height * twice}, side);
      full.binning_x = full.binning_y = binning;
      camera.add(camera.topic<ros::CameraInfo>(name + "camera_info"), {1000}, full);
    }
  };
  record(2, 2);
  EXPECT_EQ(open()->rig()->focal_px, kRig.focal_px);
  EXPECT_EQ(open()->rig()->baseline_m, kRig.baseline_m);
  record(2, 0);
  EXPECT_NE(refusal().find("the images are " + text(kSize)), std::string::npos) << refusal();
  SourceOptions scales;
  scales.scale_calibration = true;
  EXPECT_EQ(open(scales)->rig()->focal_px, kRig.focal_px);
}

TEST_F(McapSequence, PairsImagesByTheirStamps) {
  {
    CameraFile camera(file());
    const auto left = camera.topic<ros::Image>("/cam/left/image_rect");
    const auto right = camera.topic<ros::Image>("/cam/right/image_rect");
    const auto left_info = camera.topic<ros::CameraInfo>("/cam/left/camera_info");
    const auto right_info = camera.topic<ros::CameraInfo>("/cam/right/camera_info");
    for (int i = 0; i < 10; ++i) {
      const Stamp stamp{1'000'000'000LL + i * 100'000'000LL};
      // The right camera is half a millisecond late, and misses one image; its messages come first.
      if (i != 4) {
        camera.add(right, {stamp.ns + 500'000},
                   message_of_dots({stamp.ns + 500'000}, 100U + static_cast<unsigned>(i)));
      }
      camera.add(left, stamp, message_of_dots(stamp, static_cast<unsigned>(i)));
      camera.add(left_info, stamp, info(ros::Side::left));
      camera.add(right_info, stamp, info(ros::Side::right));
    }
  }
  const auto sequence = open();
  ASSERT_TRUE(sequence->rig());
  EXPECT_EQ(sequence->rig()->baseline_m, kRig.baseline_m);
  EXPECT_EQ(sequence->image_size(), kSize);
  EXPECT_EQ(sequence->size(), 9U);
  std::vector<int> seen;
  while (const auto frame = sequence->next()) {
    const auto i = static_cast<int>((frame->stamp.ns - 1'000'000'000) / 100'000'000);
    seen.push_back(i);
    EXPECT_TRUE(shows_dots(frame->left.gray, static_cast<unsigned>(i)));
    EXPECT_TRUE(shows_dots(frame->right, 100U + static_cast<unsigned>(i)));
    EXPECT_EQ(frame->frame_id, "camera");
  }
  EXPECT_EQ(seen, (std::vector<int>{0, 1, 2, 3, 5, 6, 7, 8, 9}));
  ASSERT_EQ(sequence->remarks().size(), 1U);
  EXPECT_EQ(sequence->remarks()[0].what, "left image without a right one");
  EXPECT_EQ(sequence->remarks()[0].count, 1U);
  EXPECT_EQ(sequence->ended_early(), "");
  SourceOptions strict;
  strict.max_skew_ms = 0.1;
  EXPECT_NE(refusal(strict).find("within 0.1 ms; the first are 0.5 ms apart"), std::string::npos)
      << refusal(strict);
  EXPECT_NE(refusal(strict).find("--max-skew"), std::string::npos) << refusal(strict);
}

TEST_F(McapSequence, ANewRunBeginsWhereTheClockIsSetBack) {
  {
    CameraFile camera(file());
    const auto left = camera.topic<ros::Image>("/cam/left/image_rect");
    const auto right = camera.topic<ros::Image>("/cam/right/image_rect");
    unsigned seed = 0;
    // The third right image of the first run is missing; the second run begins with its left image.
    for (const int ms : {9000, 9100, 9200, 9200, 1000, 1100}) {
      const Stamp stamp{ms * 1'000'000LL};
      camera.add(left, {++seed}, message_of_dots(stamp, seed));
      if (seed != 3) camera.add(right, {seed}, message_of_dots(stamp, 100 + seed));
    }
  }
  const auto sequence = open();
  std::vector<std::int64_t> seen;
  while (const auto frame = sequence->next()) {
    seen.push_back(frame->stamp.ns / 1'000'000);
    EXPECT_EQ(frame->after_gap, false);
  }
  EXPECT_EQ(seen, (std::vector<std::int64_t>{9000, 9100, 9200, 1000, 1100}));
  ASSERT_FALSE(sequence->remarks().empty());
  const SourceRemark& last = sequence->remarks().back();
  EXPECT_EQ(last.what, "clock set back, a new run begins");
  EXPECT_EQ(last.first, "000003 (1 s after 9.2 s)");
}

TEST_F(McapSequence, DeliversTheRequestedNumberOfFrames) {
  {
    CameraFile camera(file());
    const auto left = camera.topic<ros::Image>("/left/image_raw");
    const auto right = camera.topic<ros::Image>("/right/image_raw");
    const auto left_info = camera.topic<ros::CameraInfo>("/left/camera_info");
    const auto right_info = camera.topic<ros::CameraInfo>("/right/camera_info");
    for (int i = 0; i < 10; ++i) {
      camera.add(left, {i * 1000 + 1000}, message_of_dots({i * 1000 + 1000}, static_cast<unsigned>(i)));
      camera.add(right, {i * 1000 + 1000},
                 message_of_dots({i * 1000 + 1000}, 100U + static_cast<unsigned>(i)));
    }
    camera.add(left_info, {0}, info(ros::Side::left));
    camera.add(right_info, {0}, info(ros::Side::right));
  }
  SourceOptions options;
  options.frames = parse_frame_range("2:8:3");
  const auto sequence = open(options);
  EXPECT_EQ(sequence->size(), 2U);
  EXPECT_EQ(sequence->next()->name, "000002");
  EXPECT_EQ(sequence->next()->index, 5U);
  EXPECT_FALSE(sequence->next());
  EXPECT_TRUE(sequence->remarks().empty());
}

TEST_F(McapSequence, ReadsTheUsualEncodings) {
  {
    CameraFile camera(file());
    const auto left = camera.topic<ros::Image>("/l/left/image_color");
    const auto right = camera.topic<ros::Image>("/l/right/image_color");
    ros::Image image;
    image.width = 2;
    image.height = 1;
    const auto add = [&](std::int64_t stamp, const char* encoding, std::uint32_t step, ros::Bytes bytes) {
      image.header = ros::header_of({stamp}, "c");
      image.encoding = encoding;
      image.step = step;
      image.data = std::move(bytes);
      camera.add(left, {stamp}, image);
      camera.add(right, {stamp}, image);
    };
    add(1, "rgb8", 8, {10, 20, 30, 40, 50, 60, 0, 0});  // with row padding
    add(2, "bgr8", 6, {30, 20, 10, 60, 50, 40});
    add(3, "bgra8", 8, {30, 20, 10, 255, 60, 50, 40, 255});
    add(4, "mono8", 2, {7, 9});
    image.is_bigendian = 1;
    add(5, "mono16", 4, {0x0f, 0xff, 0x08, 0x00});  // 12 bits
  }
  const auto sequence = open();
  for (int i = 0; i < 3; ++i) {
    const auto frame = sequence->next();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->left.rgb(0, 0), (Rgb{10, 20, 30}));
    EXPECT_EQ(frame->left.rgb(1, 0), (Rgb{40, 50, 60}));
    EXPECT_EQ(frame->right(0, 0), frame->left.gray(0, 0));
  }
  EXPECT_EQ(sequence->next()->left.gray(1, 0), 9);
  const auto deep = sequence->next();
  EXPECT_EQ(deep->left.gray(0, 0), 255);
  EXPECT_EQ(deep->left.gray(1, 0), 128);
}

TEST_F(McapSequence, ReadsCompressedImages) {
  const Image<Gray> image = dots(kSize, 1);
  Image<Rgb> colours(kSize, Rgb{1, 2, 3}, {});
  {
    CameraFile camera(file());
    const auto left = camera.topic<ros::CompressedImage>("/left/image_rect/compressed");
    const auto right = camera.topic<ros::CompressedImage>("/right/image_rect/compressed");
    const std::string png = io::png_bytes(colours.view());
    for (const auto channel : {left, right}) {
      camera.add(channel, {5},
                 ros::CompressedImage{ros::header_of({5}, "c"), "png", {png.begin(), png.end()}});
    }
    for (const auto channel : {left, right})
      camera.add(channel, {6}, ros::CompressedImage{ros::header_of({6}, "c"), "jpeg", {0xff, 0xd8, 0xff, 0}});
  }
  const auto sequence = open();
  const auto frame = sequence->next();
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->left.rgb(3, 3), (Rgb{1, 2, 3}));
  EXPECT_FALSE(sequence->next());
  ASSERT_EQ(sequence->remarks().size(), 1U);
  EXPECT_TRUE(sequence->remarks()[0].is_unusable);
}

TEST_F(McapSequence, RectifiedColourImagesAreConvertedAfterwards) {
  {
    CameraFile camera(file());
    const auto left = camera.topic<ros::Image>("/stereo/left/image_rect");
    const auto grey = camera.topic<ros::Image>("/stereo/left/image_grey");
    const auto right = camera.topic<ros::Image>("/stereo/right/image_rect");
    const Image<Rgb> colours(kSize, Rgb{10, 20, 30}, {});
    for (int i = 1; i <= 3; ++i) {
      const Stamp stamp{i * 1000};
      camera.add(left, stamp, ros::image_of(ros::header_of(stamp, "c"), colours.view()));
      if (i != 2) camera.add(grey, stamp, message_of_dots(stamp, static_cast<unsigned>(i)));
      camera.add(right, stamp, message_of_dots(stamp, 9));
    }
  }
  const auto sequence = open();
  for (unsigned i = 1; i <= 3; ++i) {
    const auto frame = sequence->next();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->left.rgb(5, 5), (Rgb{10, 20, 30}));
    EXPECT_EQ(shows_dots(frame->left.gray, i), i != 2) << i;
  }
}

TEST_F(McapSequence, ListsTheTopicsIfAmbiguous) {
  {
    CameraFile camera(file());
    for (const char* name : {"/a/left/image_rect", "/a/right/image_rect", "/b/left/image_rect",
                             "/b/right/image_rect", "/b/left/image_raw", "/b/right/image_raw"}) {
      const auto topic = camera.topic<ros::Image>(name);
      camera.add(topic, {1000}, message_of_dots({1000}, topic));
    }
  }
  EXPECT_EQ(refusal(), file().string() +
                           ": has more than one pair, expected --topics with one of them: "
                           "/a/left/image_rect,/a/right/image_rect; /b/left/image_rect,/b/right/image_rect");
  SourceOptions options;
  options.topics = "/b/left/image_rect,/b/right/image_rect";
  EXPECT_TRUE(shows_dots(open(options)->next()->left.gray, 3));
  options.topics = "/b/left/image_rect,/c";
  EXPECT_NE(refusal(options).find("has no image topic /c; its images: /a/left/image_rect"),
            std::string::npos);
}

TEST_F(McapSequence, RawImagesAreMarkedForRectification) {
  ros::CameraInfo left = info(ros::Side::left);
  left.d = {0.1, 0, 0, 0, 0};
  {
    CameraFile camera(file());
    for (const char* side : {"left", "right"}) {
      const std::string name = std::string("/") + side;
      camera.add(camera.topic<ros::Image>(name + "/image_raw"), {1000}, message_of_dots({1000}, 1));
      camera.add(camera.topic<ros::CameraInfo>(name + "/camera_info"), {1000},
                 name == "/left" ? left : info(ros::Side::right));
    }
  }
  EXPECT_NE(
      refusal().find("/left/image_raw are raw images with distortion, expected rectified ones, or --rectify"),
      std::string::npos)
      << refusal();
  SourceOptions options;
  options.rectify = true;
  try {
    const auto sequence = open(options);
    ASSERT_TRUE(sequence->rig());
    EXPECT_NEAR(sequence->rig()->baseline_m, 0.12, 1e-4);
    EXPECT_NE(sequence->rectifier(), nullptr);
  } catch (const Error& error) {  // built without OpenCV's calib3d
    EXPECT_NE(std::string(error.what()).find("calib3d"), std::string::npos) << error.what();
  }
}

TEST_F(McapSequence, OtherRecordingsAreRefusedInOneLine) {
  { CameraFile camera(file()); }
  EXPECT_NE(refusal().find("has no topics of left and right images"), std::string::npos) << refusal();
  {
    CameraFile camera(file());
    for (const char* name : {"/left/image", "/right/image"}) {
      ros::Image image = message_of_dots({1}, 1);
      image.encoding = "yuv410";
      camera.add(camera.topic<ros::Image>(name), {1}, image);
    }
  }
  EXPECT_NE(refusal().find("has the encoding yuv410, expected grey (mono8"), std::string::npos) << refusal();
  {
    CameraFile camera(file());
    for (const char* name : {"/left/image", "/right/image"}) {
      ros::Image image = message_of_dots({1}, 1);
      image.height = 1'000'000;
      camera.add(camera.topic<ros::Image>(name), {1}, image);
    }
  }
  EXPECT_NE(refusal().find("claims 40x1000000 pixels"), std::string::npos) << refusal();
}

TEST_F(McapSequence, AFolderOfRos2BagIsARecording) {
  const fs::path folder = file().parent_path();
  {
    CameraFile camera(file());
    for (const char* name : {"/left/image", "/right/image"})
      camera.add(camera.topic<ros::Image>(name), {1}, message_of_dots({1}, 1));
  }
  const auto refusal_of_folder = [&] {
    try {
      (void)open_sequence(folder.string(), {});
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string("none");
  };
  EXPECT_NE(refusal_of_folder(), "none");  // an arbitrary other folder
  recordings::write(folder / "metadata.yaml", "rosbag2_bagfile_information:\n");
  EXPECT_EQ(open_sequence(folder.string(), {})->name(), "run.mcap");
  fs::copy_file(file(), folder / "run_1.mcap");
  EXPECT_EQ(refusal_of_folder(), folder.string() + ": is a recording in 2 parts, expected one of them: " +
                                     (folder / "run.mcap").string());
  fs::remove(file());
  fs::rename(folder / "run_1.mcap", folder / "run.db3");
  EXPECT_NE(refusal_of_folder().find("is not in MCAP"), std::string::npos);
}

TEST_F(McapSequence, ATruncatedRecordingReportsSoAtItsEnd) {
  {
    CameraFile camera(file(), {.chunk_bytes = 3000, .sync = false});
    const auto left = camera.topic<ros::Image>("/left/image");
    const auto right = camera.topic<ros::Image>("/right/image");
    for (int i = 0; i < 20; ++i) {
      camera.add(left, {1000 + i}, message_of_dots({1000 + i}, static_cast<unsigned>(i)));
      camera.add(right, {1000 + i}, message_of_dots({1000 + i}, 100U + static_cast<unsigned>(i)));
    }
  }
  fs::resize_file(file(), fs::file_size(file()) / 2);
  const auto sequence = open();
  int frames = 0;
  while (sequence->next()) ++frames;
  EXPECT_GT(frames, 5);
  EXPECT_LT(frames, 15);
  EXPECT_NE(sequence->ended_early().find("is truncated"), std::string::npos);
}

TEST_F(McapSequence, OfARecordingWithoutOneCompleteChunkIsRefused) {
  {
    CameraFile camera(file(), {.sync = false});
    const auto left = camera.topic<ros::Image>("/left/image");
    camera.add(left, {1000}, message_of_dots({1000}, 1));
  }
  fs::resize_file(file(), 200);
  try {
    (void)open();
    FAIL() << "nothing can be read";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("is truncated before the end of its first chunk"),
              std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace cairn::input
