// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/core/image.hpp>
#include <cairn/input/sequence.hpp>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <opencv2/core.hpp>
#include <opencv2/videoio.hpp>
#include <opencv2/videoio/registry.hpp>
#include <string>
#include <support/temporary_folder.hpp>
#include <vector>

namespace cairn::input {
namespace {

namespace fs = std::filesystem;
using support::has;
using support::refusal;
using support::TemporaryFolder;

/// Frames of noise, as lossless FFV1 in Matroska.
class Video : public testing::Test {
 protected:
  void SetUp() override {
    if (!cv::videoio_registry::hasBackend(cv::CAP_FFMPEG)) GTEST_SKIP() << "OpenCV was built without FFmpeg";
    ::setenv("OPENCV_FFMPEG_LOGLEVEL", "-8", 0);
  }
  static std::vector<cv::Mat> noise(int count, cv::Size size, bool colour) {
    cv::RNG random(7);
    std::vector<cv::Mat> frames;
    for (int i = 0; i < count; ++i) {
      cv::Mat frame(size, colour ? CV_8UC3 : CV_8UC1);
      random.fill(frame, cv::RNG::UNIFORM, 0, 256);
      frames.push_back(frame);
    }
    return frames;
  }
  [[nodiscard]] std::string write(const char* name, const std::vector<cv::Mat>& frames,
                                  double rate_hz = 10) const {
    const std::string path = (folder_.path() / name).string();
    cv::VideoWriter writer(path, cv::CAP_FFMPEG, cv::VideoWriter::fourcc('F', 'F', 'V', '1'), rate_hz,
                           frames.front().size(), frames.front().channels() == 3);
    if (!writer.isOpened()) return {};
    for (const cv::Mat& frame : frames) writer.write(frame);
    return path;
  }
  TemporaryFolder folder_;
};

SourceOptions laid_out(const char* layout) {
  SourceOptions options;
  options.layout = layout;
  return options;
}

TEST_F(Video, SideBySideGivesIdenticalPixelsAndStamps) {
  const auto written = noise(5, {48, 16}, true);
  const std::string path = write("v.mkv", written);
  if (path.empty()) GTEST_SKIP() << "no encoder for FFV1";
  const auto sequence = open_sequence(path, laid_out("side_by_side"));
  EXPECT_EQ(sequence->size(), 5U);
  EXPECT_EQ(sequence->image_size(), (Size{24, 16}));
  std::size_t count = 0;
  while (const auto frame = sequence->next()) {
    EXPECT_EQ(frame->stamp.ns, static_cast<std::int64_t>(count) * 100'000'000);
    const cv::Mat& truth = written[count++];
    for (int y = 0; y < 16; ++y) {
      for (int x = 0; x < 24; ++x) {
        const auto& left = truth.at<cv::Vec3b>(y, x);
        ASSERT_EQ(frame->left.rgb(x, y), (Rgb{left[2], left[1], left[0]}));
        const auto& right = truth.at<cv::Vec3b>(y, x + 24);
        ASSERT_EQ(int{frame->right(x, y)}, (77 * right[2] + 150 * right[1] + 29 * right[0] + 128) >> 8);
      }
    }
  }
  EXPECT_EQ(count, 5U);
  EXPECT_EQ(sequence->ended_early(), "");
  EXPECT_TRUE(sequence->remarks().empty());
}

TEST_F(Video, OfGreyIsGreyAndTopBottomIsHalved) {
  const auto written = noise(3, {32, 24}, false);
  const std::string path = write("v.mkv", written);
  if (path.empty()) GTEST_SKIP() << "no encoder for FFV1";
  SourceOptions options = laid_out("top_bottom");
  options.frames = parse_frame_range("1:");
  options.rate_hz = 4;
  const auto sequence = open_sequence(path, options);
  const auto frame = sequence->next();
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->name, "000001");
  EXPECT_EQ(frame->stamp.ns, 250'000'000);
  EXPECT_TRUE(frame->left.rgb.empty());
  for (int y = 0; y < 12; ++y) {
    for (int x = 0; x < 32; ++x) {
      ASSERT_EQ(int{frame->left.gray(x, y)}, int{written[1].at<std::uint8_t>(y, x)});
      ASSERT_EQ(int{frame->right(x, y)}, int{written[1].at<std::uint8_t>(y + 12, x)});
    }
  }
}

TEST_F(Video, TruncatedEndsEarlyWithAMessage) {
  const std::string path = write("v.mkv", noise(12, {64, 24}, true));
  if (path.empty()) GTEST_SKIP() << "no encoder for FFV1";
  const std::string whole = support::bytes_of(path);
  const fs::path cut = folder_.with("cut.mkv", std::string_view(whole).substr(0, whole.size() / 2));
  const auto sequence = open_sequence(cut.string(), laid_out("side_by_side"));
  std::size_t count = 0;
  while (sequence->next()) ++count;
  EXPECT_GT(count, 2U);
  EXPECT_LT(count, 10U);
  EXPECT_TRUE(has(sequence->ended_early(), {"cut.mkv", "is truncated", "1.20 s"}));
}

/// Sets the times, in ms, of the frames of a Matroska file with one cluster and 10 frames per second.
std::string timed(std::string bytes, const std::vector<int>& ms) {
  std::size_t at = 0;
  for (std::size_t i = 0; i < ms.size(); ++i) {
    // A SimpleBlock: 0xA3, its size in two bytes, track 1, its time in the cluster.
    const auto track_and_time = [](int time) {
      return std::string{'\x81', static_cast<char>(time / 256), static_cast<char>(time % 256)};
    };
    const std::string written = track_and_time(static_cast<int>(i) * 100);
    do {
      at = bytes.find('\xA3', at + 1);
      if (at == std::string::npos) return {};
    } while (bytes.compare(at + 3, written.size(), written) != 0);
    bytes.replace(at + 3, written.size(), track_and_time(ms[i]));
  }
  return bytes;
}

TEST_F(Video, OfVariableRateKeepsItsStamps) {
  const auto written = noise(5, {48, 16}, true);
  const std::string path = write("v.mkv", written);
  if (path.empty()) GTEST_SKIP() << "no encoder for FFV1";
  const std::vector<int> ms{0, 30, 310, 330, 900};
  const std::string bytes = timed(support::bytes_of(path), ms);
  ASSERT_FALSE(bytes.empty()) << "another layout of the file";
  const auto sequence = open_sequence(folder_.with("variable.mkv", bytes).string(), laid_out("side_by_side"));
  std::size_t count = 0;
  while (const auto frame = sequence->next()) {
    ASSERT_LT(count, ms.size());
    EXPECT_EQ(frame->stamp.ns, ms[count] * std::int64_t{1'000'000});
    const auto& left = written[count++].at<cv::Vec3b>(5, 3);
    EXPECT_EQ(frame->left.rgb(3, 5), (Rgb{left[2], left[1], left[0]}));
  }
  EXPECT_EQ(count, ms.size());
}

TEST_F(Video, OfEachCameraArePairedByStamps) {
  const auto frames = noise(6, {32, 16}, false);
  const std::string left = write("l.mkv", frames, 10);
  const std::string right = write("r.mkv", {frames[0], frames[1], frames[2], frames[3]}, 5);
  if (left.empty()) GTEST_SKIP() << "no encoder for FFV1";
  // At 0, 200 and 400 ms.
  const auto sequence = open_sequence(left + "," + right, {});
  std::vector<std::int64_t> stamps;
  while (const auto frame = sequence->next()) {
    stamps.push_back(frame->stamp.ns);
    EXPECT_EQ(int{frame->left.gray(3, 5)}, int{frames[(stamps.size() - 1) * 2].at<std::uint8_t>(5, 3)});
    EXPECT_EQ(int{frame->right(3, 5)}, int{frames[stamps.size() - 1].at<std::uint8_t>(5, 3)});
  }
  EXPECT_EQ(stamps, (std::vector<std::int64_t>{0, 200'000'000, 400'000'000}));
  ASSERT_EQ(sequence->remarks().size(), 2U);
  EXPECT_EQ(sequence->remarks()[0].what, "left image without a right one");
  EXPECT_EQ(sequence->remarks()[0].count, 3U);
  EXPECT_EQ(sequence->remarks()[1].count, 1U);
}

TEST_F(Video, RefusesInvalidInput) {
  const auto refused = [](const std::string& source, const SourceOptions& options) {
    return refusal([&] { (void)open_sequence(source, options); });
  };
  const std::string text = folder_.with("text.mp4", "no video at all\n").string();
  EXPECT_TRUE(has(refused(text, {}), {"text.mp4", "--layout", "LEFT,RIGHT"}));
  EXPECT_TRUE(has(refused(text, laid_out("side_by_side")), {"text.mp4", "cannot be opened as a video"}));
  EXPECT_TRUE(has(refused(text + "," + text, {}), {"text.mp4", "cannot be opened as a video"}));
  const std::string small = write("small.mkv", noise(2, {30, 16}, true));
  if (small.empty()) GTEST_SKIP() << "no encoder for FFV1";
  SourceOptions late = laid_out("top_bottom");
  late.frames = parse_frame_range("9:");
  EXPECT_TRUE(has(refused(small, late), {"small.mkv", "--frames"}));
  // A codec that is not installed.
  std::string bytes = [&] {
    std::ifstream file(small, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(file), {});
  }();
  ASSERT_NE(bytes.find("FFV1"), std::string::npos);
  for (std::size_t at = 0; (at = bytes.find("FFV1", at)) != std::string::npos;) bytes.replace(at, 4, "ZZZZ");
  const std::string unknown = folder_.with("unknown.mkv", bytes).string();
  EXPECT_TRUE(has(refused(unknown, laid_out("top_bottom")), {"unknown.mkv", "cannot be opened as a video"}));
  const std::string wide = write("wide.mkv", noise(2, {32, 16}, true));
  EXPECT_TRUE(has(refused(small + "," + wide, {}), {"wide.mkv", "32x16", "30x16"}));
}

}  // namespace
}  // namespace cairn::input
