// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/core/image.hpp>
#include <cairn/input/sequence.hpp>
#include <cairn/io/image_files.hpp>
#include <future>
#include <support/gst_pipelines.hpp>
#include <support/temporary_folder.hpp>

/// Cameras by GStreamer, with real pipelines.
namespace cairn::input {
namespace {

using namespace std::chrono_literals;
using support::has;
using support::refusal;
using Clock = std::chrono::steady_clock;

class Pipelines : public testing::Test {
 protected:
  void SetUp() override {
    if (!support::has_elements({"videotestsrc", "pngdec", "compositor", "videoconvert", "imagefreeze"}))
      GTEST_SKIP() << "install gstreamer1.0-plugins-base gstreamer1.0-plugins-good";
  }
  static SourceOptions soon() {
    SourceOptions options;
    options.open_timeout_s = 20;
    return options;
  }
  static std::string refused(const std::string& source, const SourceOptions& options = soon()) {
    return refusal([&] { (void)open_sequence(source, options); });
  }
  /// left.png and right.png, random.
  void save_pair(Size size, bool colour) const {
    unsigned seed = 5;
    const auto next = [&] {
      seed = seed * 1664525U + 1013904223U;
      return static_cast<std::uint8_t>(seed >> 24U);
    };
    for (const char* name : {"left.png", "right.png"}) {
      Image<Gray> gray(size);
      Image<Rgb> rgb(size);
      for (int y = 0; y < size.height; ++y) {
        for (int x = 0; x < size.width; ++x) {
          gray(x, y) = next();
          rgb(x, y) = {next(), next(), next()};
        }
      }
      if (colour) {
        io::save_png(folder_.path() / name, rgb.view());
      } else {
        io::save_png(folder_.path() / name, gray.view());
      }
    }
  }
  [[nodiscard]] std::string file(const char* name) const { return (folder_.path() / name).string(); }
  support::TemporaryFolder folder_;
};

int differing(View<const Gray> a, View<const Gray> b) {
  EXPECT_EQ(a.size(), b.size());
  int count = 0;
  for (int y = 0; y < a.height(); ++y) {
    for (int x = 0; x < a.width(); ++x) count += a(x, y) != b(x, y) ? 1 : 0;
  }
  return count;
}

TEST_F(Pipelines, GiveTheGreyLevelsOfTheirFiles) {
  for (const bool colour : {false, true}) {
    save_pair({160, 120}, colour);
    const std::string half = " ! pngdec ! imagefreeze num-buffers=3";
    const auto source = open_sequence("gst:filesrc location=" + file("left.png") + half +
                                          " ! c.sink_0 filesrc location=" + file("right.png") + half +
                                          " ! c.sink_1 compositor name=c sink_1::xpos=160",
                                      soon());
    EXPECT_EQ(source->name(), "gst");
    EXPECT_EQ(source->image_size(), (Size{160, 120}));
    const auto pair = source->next();
    ASSERT_TRUE(pair);
    const io::LoadedImage left = io::load_picture(file("left.png"));
    const io::LoadedImage right = io::load_picture(file("right.png"));
    EXPECT_EQ(differing(pair->left.gray.view(), left.gray.view()), 0) << colour;
    EXPECT_EQ(differing(pair->right.view(), right.gray.view()), 0) << colour;
  }
}

TEST_F(Pipelines, AreReadInTheirNativeFormat) {
  // The same image in every format, as far as grey is concerned: white, grey, black.
  for (const char* form : {"GRAY8", "NV12", "I420", "YV12", "NV21", "YUY2", "UYVY", "YVYU", "Y42B", "Y444",
                           "RGB",   "BGR",  "RGBx", "BGRx", "xRGB", "xBGR", "RGBA", "BGRA", "ARGB", "ABGR"}) {
    const auto source = open_sequence(
        std::string("gst:videotestsrc num-buffers=2 pattern=solid-color foreground-color=0xffff0000 ! "
                    "video/x-raw,width=64,height=32,framerate=30/1,format=") +
            form,
        soon());
    const auto pair = source->next();
    ASSERT_TRUE(pair) << form;
    ASSERT_EQ(pair->left.gray.size(), (Size{32, 32})) << form;
    const int grey = pair->left.gray(16, 16);
    const bool is_rgb = std::string_view(form).find("RGB") != std::string_view::npos ||
                        std::string_view(form).find("BGR") != std::string_view::npos;
    // Red: 77 of 256 parts, 81 in luminance.
    EXPECT_NEAR(grey, is_rgb ? 77 : 81, 1) << form;
    EXPECT_EQ(int{pair->right(16, 16)}, grey) << form;
    if (std::string_view(form) == "GRAY8") {
      EXPECT_TRUE(pair->left.rgb.empty());
      continue;
    }
    const Rgb rgb = pair->left.rgb(16, 16);
    EXPECT_GE(rgb.r, 252) << form;
    EXPECT_LE(rgb.g, 3) << form;
    EXPECT_LE(rgb.b, 3) << form;
  }
}

TEST_F(Pipelines, EndWithAMessageAndHaveIncreasingStamps) {
  const auto source = open_sequence(
      "gst:videotestsrc is-live=true num-buffers=12 pattern=snow ! "
      "video/x-raw,format=GRAY8,width=64,height=64,framerate=60/1",
      [] {
        SourceOptions options = soon();
        options.layout = "top_bottom";
        return options;
      }());
  EXPECT_EQ(source->image_size(), (Size{64, 32}));
  EXPECT_TRUE(source->status().is_live);
  EXPECT_EQ(source->status().clock, "system");
  std::size_t count = 0;
  Stamp before;
  while (const auto pair = source->next()) {
    EXPECT_GT(pair->stamp, before);
    // Since 1970, as in ROS.
    const auto now = std::chrono::system_clock::now().time_since_epoch();
    const double age =
        std::chrono::duration<double>(now).count() - static_cast<double>(pair->stamp.ns) * 1e-9;
    EXPECT_GT(age, -0.001);
    EXPECT_LT(age, 1);
    before = pair->stamp;
    ++count;
  }
  EXPECT_EQ(count + source->status().dropped, 12U);
  EXPECT_EQ(source->ended_early(), "");
  EXPECT_TRUE(has(source->remarks().back().what, {"the pipeline ended: after"}));
}

TEST_F(Pipelines, OfFilesPlayAtThePaceOfTheirStamps) {
  const auto began = Clock::now();
  const auto source = open_sequence(
      "gst:videotestsrc num-buffers=10 ! video/x-raw,format=GRAY8,width=64,height=32,framerate=20/1", soon());
  std::size_t count = 0;
  while (source->next()) ++count;
  EXPECT_EQ(count + source->status().dropped, 10U);
  EXPECT_GE(Clock::now() - began, 400ms);
}

TEST_F(Pipelines, CountMissingFramesByTheSourcesNumbers) {
  if (!support::has_elements({"identity"})) GTEST_SKIP() << "install gstreamer1.0-plugins-base";
  const auto source = open_sequence(
      "gst:videotestsrc is-live=true num-buffers=40 ! "
      "video/x-raw,format=GRAY8,width=64,height=32,framerate=100/1 ! identity drop-probability=0.5",
      soon());
  std::size_t count = 0;
  while (source->next()) ++count;
  // Missing frames at the end may go unnoticed without a later one.
  EXPECT_LE(count + source->status().dropped, 40U);
  EXPECT_GE(count + source->status().dropped, 33U);
  EXPECT_GT(source->status().dropped, 5U);
}

TEST_F(Pipelines, PairTwoByStamps) {
  const char* half =
      "videotestsrc is-live=true pattern=snow ! video/x-raw,format=YUY2,width=64,height=32,framerate=30/1";
  SourceOptions options = soon();
  options.max_skew_ms = 17;
  const auto source = open_sequence(std::string("gst:") + half + " !! " + half, options);
  EXPECT_EQ(source->image_size(), (Size{64, 32}));
  for (int i = 0; i < 5; ++i) {
    const auto pair = source->next();
    ASSERT_TRUE(pair);
    EXPECT_EQ(pair->right.size(), (Size{64, 32}));
  }
  source->stop();
  (void)source->next();
  bool is_remarked = false;
  for (const SourceRemark& remark : source->remarks())
    is_remarked = is_remarked || remark.what.starts_with("the two cameras are not synchronised: ");
  EXPECT_TRUE(is_remarked);
  options.layout = "side_by_side";
  EXPECT_TRUE(has(refused(std::string("gst:") + half + " !! " + half, options), {"--layout", "found two"}));
}

TEST_F(Pipelines, RefuseInvalidOnesInOneLine) {
  EXPECT_TRUE(has(refused("gst:"), {"empty pipeline"}));
  EXPECT_TRUE(has(refused("gst:a !! b !! c"), {"3 pipelines"}));
  EXPECT_TRUE(has(refused("gst:videotestsrc ! !"), {"cannot be created", "syntax error"}));
  EXPECT_TRUE(
      has(refused("gst:no_such_camera_src"), {"no element \"no_such_camera_src\"", "gst-inspect-1.0"}));
  EXPECT_TRUE(has(refused("gst:videotestsrc ! fakesink"), {"cannot be created", "could not link"}));
  EXPECT_TRUE(has(refused("gst:videotestsrc nonsense=3"), {"cannot be created", "nonsense"}));
  EXPECT_TRUE(has(refused("gst:filesrc location=/no/such/file ! decodebin"), {"/no/such/file"}));
  save_pair({16, 16}, false);
  EXPECT_TRUE(has(refused("gst:filesrc location=" + file("left.png")), {"not-negotiated", "decodebin"}));
  EXPECT_TRUE(has(refused("gst:videotestsrc num-buffers=0"), {"ended before its first frame"}));
  EXPECT_TRUE(has(refused("gst:videotestsrc ! video/x-raw,format=GRAY8,width=63,height=32"),
                  {"is 63x32", "multiple of 2"}));
  SourceOptions brief;
  brief.open_timeout_s = 0.3;
  EXPECT_TRUE(has(refused("gst:appsrc", brief), {"no frame within 0.3 s"}));
  EXPECT_TRUE(has(refused("http://10.0.0.1/cam"), {"souphttpsrc"}));
}

TEST_F(Pipelines, CanBeStoppedFromAnotherThread) {
  const auto source = open_sequence(
      "gst:videotestsrc is-live=true ! video/x-raw,format=GRAY8,width=64,height=32,framerate=1/5", soon());
  ASSERT_TRUE(source->next());
  auto waiting = std::async(std::launch::async, [&] { return source->next().has_value(); });
  std::this_thread::sleep_for(50ms);
  const auto stopped = Clock::now();
  source->stop();
  EXPECT_FALSE(waiting.get());
  EXPECT_LT(Clock::now() - stopped, 200ms);
}

TEST_F(Pipelines, AreReopenedAfterAFailure) {
  if (!support::has_elements({"identity"})) GTEST_SKIP() << "install gstreamer1.0-plugins-base";
  const auto source = open_sequence(
      "gst:videotestsrc is-live=true ! video/x-raw,format=GRAY8,width=64,height=32,framerate=100/1 ! "
      "identity error-after=10",
      soon());
  bool has_come_back = false;
  for (int i = 0; i < 60 && !has_come_back; ++i) {
    const auto pair = source->next();
    ASSERT_TRUE(pair);
    has_come_back = pair->after_gap;
  }
  EXPECT_TRUE(has_come_back);
  EXPECT_EQ(source->status().reconnects, 1U);
}

}  // namespace
}  // namespace cairn::input
