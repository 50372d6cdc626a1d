// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <atomic>
#include <cairn/core/image.hpp>
#include <cairn/input/camera/open_camera.hpp>
#include <cairn/input/camera/stamp_pairer.hpp>
#include <cairn/input/camera/without_password.hpp>
#include <cairn/io/image_files.hpp>
#include <cairn/io/raster.hpp>
#include <cairn/io/raw_calibration.hpp>
#include <cmath>
#include <future>
#include <support/fake_v4l2.hpp>
#include <support/temporary_folder.hpp>

/// V4L2 cameras on a simulated kernel: no such device was available.
namespace cairn::input {
namespace {

using namespace std::chrono_literals;
using support::DeviceEvent;
using support::FakeDevice;
using support::FakeV4l2;
using support::has;
using support::refusal;
using Clock = std::chrono::steady_clock;

constexpr const char* kDevice = "/dev/video0";

std::string bytes_of_noise(std::size_t count, unsigned seed = 1) {
  std::string bytes(count, '\0');
  for (char& byte : bytes) {
    seed = seed * 1664525U + 1013904223U;
    byte = static_cast<char>(seed >> 24U);
  }
  return bytes;
}
int byte(const std::string& bytes, int at) {
  return static_cast<std::uint8_t>(bytes[static_cast<std::size_t>(at)]);
}

DeviceEvent frame(std::uint32_t sequence, std::int64_t stamp_us) {
  DeviceEvent event;
  event.sequence = sequence;
  event.stamp_us = stamp_us;
  return event;
}
DeviceEvent error(int code) {
  DeviceEvent event;
  event.error = code;
  return event;
}
DeviceEvent silence() {
  DeviceEvent event;
  event.is_silence = true;
  return event;
}

/// 8 x 4 pixels of YUYV.
FakeDevice yuyv_device() {
  FakeDevice device;
  device.picture = bytes_of_noise(8 * 4 * 2);
  return device;
}

class V4l2 : public testing::Test {
 protected:
  ~V4l2() override {
    // In any case no device remains open.
    EXPECT_EQ(fake_.open_now, 0);
    EXPECT_EQ(fake_.mapped_now, 0);
    EXPECT_EQ(fake_.streaming_now, 0);
  }
  std::unique_ptr<Camera> open(V4l2Request request = {}) {
    request.device = kDevice;
    return open_v4l2(request, fake_, {});
  }
  std::string refused(const V4l2Request& request = {}) {
    return refusal([&] { (void)open(request); });
  }
  FakeV4l2 fake_;
};

// ---- one device, without threads ----

TEST_F(V4l2, GreyOfYuyvIsEachSecondByteAndColoursAreBt601) {
  fake_.devices[kDevice] = yuyv_device();
  fake_.devices[kDevice].events = {frame(0, 1'500'000)};
  const auto camera = open();
  const auto image = camera->next(10ms);
  ASSERT_TRUE(image);
  EXPECT_EQ(image->stamp.ns, 1'500'000'000);
  ASSERT_EQ(image->left.gray.size(), (Size{4, 4}));
  ASSERT_EQ(image->right.size(), (Size{4, 4}));
  const std::string& bytes = fake_.devices[kDevice].picture;
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 4; ++x) {
      const int at = 16 * y + 2 * x;
      ASSERT_EQ(int{image->left.gray(x, y)}, byte(bytes, at));
      ASSERT_EQ(int{image->right(x, y)}, byte(bytes, at + 8));
      const double luminance = 255.0 / 219 * (byte(bytes, at) - 16);
      const double u = 255.0 / 224 * (byte(bytes, 16 * y + 4 * (x / 2) + 1) - 128);
      const double v = 255.0 / 224 * (byte(bytes, 16 * y + 4 * (x / 2) + 3) - 128);
      const auto near = [](double value, int found) {
        return std::abs(std::clamp(value, 0.0, 255.0) - found) < 1.6;
      };
      const Rgb rgb = image->left.rgb(x, y);
      ASSERT_TRUE(near(luminance + 1.402 * v, rgb.r));
      ASSERT_TRUE(near(luminance - 0.344136 * u - 0.714136 * v, rgb.g));
      ASSERT_TRUE(near(luminance + 1.772 * u, rgb.b));
    }
  }
}

TEST_F(V4l2, RowsMayBePadded) {
  FakeDevice& device = fake_.devices[kDevice];
  device.stride = 20;
  device.picture = bytes_of_noise(20 * 4);
  device.events = {frame(0, 0)};
  const auto image = open()->next(10ms);
  ASSERT_TRUE(image);
  EXPECT_EQ(int{image->left.gray(3, 3)}, byte(device.picture, 3 * 20 + 6));
  EXPECT_EQ(int{image->right(0, 2)}, byte(device.picture, 2 * 20 + 8));
}

TEST_F(V4l2, Y8iHasTheLeftImageInEvenBytesAndTheRightInOdd) {
  FakeDevice& device = fake_.devices[kDevice];
  device.formats = {V4L2_PIX_FMT_GREY, V4L2_PIX_FMT_Y8I};
  device.picture = bytes_of_noise(8 * 4 * 2);
  device.events = {frame(0, 0)};
  const auto image = open()->next(10ms);
  ASSERT_TRUE(image);
  ASSERT_EQ(image->left.gray.size(), (Size{8, 4}));
  EXPECT_TRUE(image->left.rgb.empty());
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 8; ++x) {
      ASSERT_EQ(int{image->left.gray(x, y)}, byte(device.picture, 16 * y + 2 * x));
      ASSERT_EQ(int{image->right(x, y)}, byte(device.picture, 16 * y + 2 * x + 1));
    }
  }
}

TEST_F(V4l2, GreyIsHalvedTopAndBottom) {
  FakeDevice& device = fake_.devices[kDevice];
  device.formats = {V4L2_PIX_FMT_GREY};
  device.picture = bytes_of_noise(8 * 4);
  device.events = {frame(0, 0)};
  V4l2Request request;
  request.layout = Layout::top_bottom;
  const auto image = open(request)->next(10ms);
  ASSERT_TRUE(image);
  ASSERT_EQ(image->left.gray.size(), (Size{8, 2}));
  EXPECT_EQ(int{image->left.gray(5, 1)}, byte(device.picture, 13));
  EXPECT_EQ(int{image->right(5, 1)}, byte(device.picture, 29));
}

TEST_F(V4l2, MjpgIsDecodedAndADamagedOneIsDropped) {
  Image<Rgb> picture({16, 8});
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 16; ++x)
      picture(x, y) = {static_cast<std::uint8_t>(15 * x), static_cast<std::uint8_t>(30 * y), 99};
  }
  const std::string jpeg =
      io::encode_jpeg({picture.size(), 3, 1, &picture.row(0)->r, picture.view().stride() * 3});
  const support::TemporaryFolder folder;
  const io::LoadedImage truth = io::load_picture(folder.with("frame.jpg", jpeg));
  FakeDevice& device = fake_.devices[kDevice];
  device.formats = {V4L2_PIX_FMT_MJPEG};
  device.width = 16;
  device.height = 8;
  device.picture = jpeg;
  device.events = {frame(0, 0), frame(1, 1), frame(2, 2)};
  device.events[1].bytes = jpeg.substr(0, jpeg.size() / 3);
  const auto camera = open();
  const auto image = camera->next(10ms);
  ASSERT_TRUE(image);
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 8; ++x) {
      ASSERT_EQ(image->left.rgb(x, y), truth.rgb(x, y));
      ASSERT_EQ(image->left.gray(x, y), truth.gray(x, y));
      ASSERT_EQ(image->right(x, y), truth.gray(x + 8, y));
    }
  }
  EXPECT_FALSE(camera->next(10ms));
  const auto after = camera->next(10ms);
  ASSERT_TRUE(after);
  EXPECT_EQ(after->dropped, 1U);
}

TEST_F(V4l2, GapsInTheSequenceAreCountedAlsoWhereItWrapsAround) {
  fake_.devices[kDevice] = yuyv_device();
  fake_.devices[kDevice].events = {frame(0xFFFFFFFD, 1), frame(0xFFFFFFFE, 2), frame(1, 3), frame(2, 4),
                                   frame(0, 5)};
  const auto camera = open();
  std::vector<std::uint64_t> dropped;
  while (const auto image = camera->next(1ms)) dropped.push_back(image->dropped);
  EXPECT_EQ(dropped, (std::vector<std::uint64_t>{0, 0, 2, 0, 0}));
}

TEST_F(V4l2, ShortAndDamagedFramesAreCountedAndNotDelivered) {
  fake_.devices[kDevice] = yuyv_device();
  auto& events = fake_.devices[kDevice].events;
  events = {frame(0, 1), frame(1, 2), frame(2, 3), frame(3, 4), frame(4, 5)};
  events[1].bytes = bytes_of_noise(63);
  events[2].bytes = "";
  events[3].flags |= V4L2_BUF_FLAG_ERROR;
  const auto camera = open();
  EXPECT_TRUE(camera->next(1ms));
  for (int i = 0; i < 3; ++i) EXPECT_FALSE(camera->next(1ms));
  const auto image = camera->next(1ms);
  ASSERT_TRUE(image);
  EXPECT_EQ(image->dropped, 3U);
}

TEST_F(V4l2, FramesWithEioAreCountedAndManyAreADisconnection) {
  fake_.devices[kDevice] = yuyv_device();
  auto& events = fake_.devices[kDevice].events;
  events = {error(EIO), error(EIO), frame(2, 1)};
  events.insert(events.end(), 8, error(EIO));
  const auto camera = open();
  EXPECT_FALSE(camera->next(1ms));
  EXPECT_FALSE(camera->next(1ms));
  EXPECT_EQ(camera->next(1ms)->dropped, 2U);
  for (int i = 0; i < 7; ++i) EXPECT_FALSE(camera->next(1ms));
  EXPECT_TRUE(has(refusal([&] { (void)camera->next(1ms); }), {"EIO"}));
}

TEST_F(V4l2, ReportsThatItWasUnplugged) {
  fake_.devices[kDevice] = yuyv_device();
  fake_.devices[kDevice].events = {error(ENODEV)};
  const auto camera = open();
  EXPECT_TRUE(has(refusal([&] { (void)camera->next(1ms); }), {"unplugged"}));
}

TEST_F(V4l2, StampsOfAnotherClockAreIgnored) {
  fake_.devices[kDevice] = yuyv_device();
  fake_.devices[kDevice].events = {frame(0, 5)};
  fake_.devices[kDevice].events[0].flags = V4L2_BUF_FLAG_TIMESTAMP_UNKNOWN;
  const auto image = open()->next(1ms);
  ASSERT_TRUE(image);
  EXPECT_EQ(image->stamp.ns, std::chrono::nanoseconds(image->arrived.time_since_epoch()).count());
}

TEST_F(V4l2, UnavailableModesAreRefusedInOneLine) {
  EXPECT_TRUE(has(refused(), {"no such device"}));
  FakeDevice& device = fake_.devices[kDevice];
  device = yuyv_device();
  device.open_errors = {EACCES, EBUSY, EMFILE};
  EXPECT_TRUE(has(refused(), {"group video"}));
  EXPECT_TRUE(has(refused(), {"another program"}));
  EXPECT_TRUE(has(refused(), {"cannot be opened"}));

  device.capabilities = V4L2_CAP_STREAMING | V4L2_CAP_META_CAPTURE;
  EXPECT_TRUE(has(refused(), {"captures no images"}));
  device.capabilities = V4L2_CAP_STREAMING | V4L2_CAP_VIDEO_CAPTURE_MPLANE;
  EXPECT_TRUE(has(refused(), {"several planes", "gst:"}));
  device.capabilities = V4L2_CAP_VIDEO_CAPTURE;
  EXPECT_TRUE(has(refused(), {"cannot stream"}));
  device.capabilities |= V4L2_CAP_STREAMING;

  V4l2Request request;
  request.format = "MJPG";
  EXPECT_TRUE(has(refused(request), {"YUYV", "expected MJPG"}));
  device.formats = {V4L2_PIX_FMT_SRGGB10, V4L2_PIX_FMT_H264};
  EXPECT_TRUE(has(refused(), {"RG10, H264", "expected GREY"}));
  device.formats = {V4L2_PIX_FMT_YUYV};

  request = {};
  request.size = {16, 8};
  device.gives_size = {{16, 4}};
  EXPECT_TRUE(has(refused(request), {"gives 16x4", "expected 16x8"}));
  device.gives_size = {{6, 4}};
  EXPECT_TRUE(has(refused(), {"is 6x4", "multiple of 4", "side by side"}));
  device.gives_size = {};

  for (const auto& [call, words] :
       std::map<unsigned long, const char*>{{VIDIOC_S_FMT, "refuses the format YUYV"},
                                            {VIDIOC_REQBUFS, "no buffers"},
                                            {VIDIOC_QUERYBUF, "buffers"},
                                            {VIDIOC_QBUF, "accepts no buffer"},
                                            {VIDIOC_STREAMON, "cannot start"}}) {
    device.refuses = {{call, EINVAL}};
    EXPECT_TRUE(has(refused(), {words}));
  }
  device.refuses = {{VIDIOC_STREAMON, ENOSPC}};
  EXPECT_TRUE(has(refused(), {"USB bandwidth", "MJPG"}));
  device.refuses = {{VIDIOC_S_FMT, EBUSY}};
  EXPECT_TRUE(has(refused(), {"another program"}));
  device.refuses = {};
  device.buffers = 1;
  EXPECT_TRUE(has(refused(), {"gives 1 buffers"}));
}

TEST_F(V4l2, AnUnavailableRateIsNoted) {
  fake_.devices[kDevice] = yuyv_device();
  V4l2Request request;
  request.fps = 30;
  EXPECT_TRUE(open(request)->notes().empty());
  fake_.devices[kDevice].gives_fps = 25;
  EXPECT_EQ(open(request)->notes(), std::vector<std::string>{"fps: found 25, expected 30"});
  fake_.devices[kDevice].refuses = {{VIDIOC_S_PARM, ENOTTY}};
  EXPECT_EQ(open(request)->notes().size(), 1U);
}

// ---- names ----

TEST(V4l2Names, AreReadWithEveryKey) {
  const auto one = parse_v4l2("v4l2:/dev/video3,w=2560,h=720,fps=29.97,format=MJPG,layout=top_bottom", {});
  ASSERT_EQ(one.size(), 1U);
  EXPECT_EQ(one[0].device, "/dev/video3");
  EXPECT_EQ(one[0].size, (Size{2560, 720}));
  EXPECT_EQ(one[0].fps, 29.97);
  EXPECT_EQ(one[0].format, "MJPG");
  EXPECT_EQ(one[0].layout, Layout::top_bottom);
  const auto two = parse_v4l2("v4l2:/dev/video0,/dev/v4l/by-id/usb-right,fps=15", {});
  ASSERT_EQ(two.size(), 2U);
  EXPECT_EQ(two[1].device, "/dev/v4l/by-id/usb-right");
  EXPECT_EQ(two[1].layout, Layout::one);
  EXPECT_TRUE(two[0].with_colour);
  EXPECT_FALSE(two[1].with_colour);
}

TEST(V4l2Names, RefuseInvalidOnes) {
  const auto refused = [](const std::string& source, const char* layout = "") {
    SourceOptions options;
    options.layout = layout;
    return refusal([&] { (void)parse_v4l2(source, options); });
  };
  EXPECT_TRUE(has(refused("v4l2:"), {"expected a second device or w="}));
  EXPECT_TRUE(has(refused("v4l2:w=3,h=2"), {"0 devices"}));
  EXPECT_TRUE(has(refused("v4l2:/a,/b,/c"), {"3 devices"}));
  EXPECT_TRUE(has(refused("v4l2:/a,/a"), {"same device twice"}));
  EXPECT_TRUE(has(refused("v4l2:/a,w=0,h=3"), {"w: found '0'"}));
  EXPECT_TRUE(has(refused("v4l2:/a,w=640"), {"one of w= and h="}));
  EXPECT_TRUE(has(refused("v4l2:/a,fps=fast"), {"fps: found 'fast'"}));
  EXPECT_TRUE(has(refused("v4l2:/a,format=RGB"), {"format: found 'RGB'", "Y8I"}));
  EXPECT_TRUE(has(refused("v4l2:/a,layout=round"), {"layout: found round"}));
  EXPECT_TRUE(has(refused("v4l2:/a,layout=top_bottom", "side_by_side"), {"--layout side_by_side"}));
  EXPECT_TRUE(has(refused("v4l2:/a,/b", "side_by_side"), {"two devices"}));
  EXPECT_TRUE(has(refused("v4l2:/a,/b,format=Y8I"), {"Y8I", "two devices"}));
  EXPECT_TRUE(has(refused("v4l2:/a,iso=3"), {"found 'iso=3'"}));
}

// ---- as sequences ----

CameraTimes quick() {
  return {1s, 200ms, 10ms, 40ms};
}

class V4l2Sequence : public V4l2 {
 protected:
  std::unique_ptr<Sequence> sequence(const std::string& source, const SourceOptions& options = {},
                                     CameraTimes times = quick()) {
    return open_v4l2_sequence(source, options, Pool::make(), fake_, times);
  }
  std::unique_ptr<Sequence> sequence(const SourceOptions& options = {}, CameraTimes times = quick()) {
    return sequence(std::string("v4l2:") + kDevice, options, times);
  }
  /// Endless frames, 2 ms apart.
  FakeDevice& steady(const char* path = kDevice) {
    fake_.devices[path] = yuyv_device();
    fake_.devices[path].events = {frame(0, 1'000'000)};
    fake_.devices[path].pace_ms = 2;
    fake_.devices[path].repeats = true;
    return fake_.devices[path];
  }
};

TEST_F(V4l2Sequence, DeliversFramesWithStampsAndNames) {
  steady();
  SourceOptions options;
  options.frames = parse_frame_range("3:9:2");
  const auto source = sequence(options);
  EXPECT_EQ(source->name(), "video0");
  EXPECT_EQ(source->image_size(), (Size{4, 4}));
  EXPECT_EQ(source->size(), 3U);
  EXPECT_FALSE(source->rig());
  Stamp before;
  for (const std::size_t index : {3U, 5U, 7U}) {
    const auto pair = source->next();
    ASSERT_TRUE(pair);
    EXPECT_EQ(pair->index, index);
    EXPECT_EQ(pair->name, "00000" + std::to_string(index));
    EXPECT_GT(pair->stamp, before);
    EXPECT_TRUE(pair->arrived);
    EXPECT_FALSE(pair->after_gap);
    before = pair->stamp;
  }
  EXPECT_FALSE(source->next());
  const SourceStatus status = source->status();
  EXPECT_TRUE(status.is_live);
  EXPECT_TRUE(status.is_connected);
  EXPECT_EQ(status.clock, "system");
}

TEST_F(V4l2Sequence, UnreadFramesAreReplacedAndCounted) {
  steady();
  const auto source = sequence();
  (void)source->next();
  std::this_thread::sleep_for(60ms);
  const auto pair = source->next();
  ASSERT_TRUE(pair);
  // The newest at once: it is not as old as the pause.
  EXPECT_LT(Clock::now() - *pair->arrived, 40ms);
  EXPECT_GT(source->status().dropped, 3U);
  ASSERT_EQ(source->remarks().size(), 1U);
  EXPECT_TRUE(has(source->remarks()[0].what, {"dropped unread"}));
}

TEST_F(V4l2Sequence, ReconnectsAfterBeingUnpluggedWithAGap) {
  FakeDevice& device = steady();
  device.events = {frame(0, 1000), frame(1, 2000), error(ENODEV), frame(0, 900'000)};
  device.open_errors = {0, ENOENT, ENOENT};  // present at first
  const auto source = sequence();
  std::optional<SequenceFrame> pair = source->next();
  ASSERT_TRUE(pair);
  const Stamp first = pair->stamp;
  for (int i = 0; i < 100 && !pair->after_gap; ++i) {
    pair = source->next();
    ASSERT_TRUE(pair);
  }
  ASSERT_TRUE(pair->after_gap);
  EXPECT_GE(pair->stamp.ns - first.ns, 898'000'000);
  EXPECT_EQ(source->status().reconnects, 1U);
  EXPECT_TRUE(source->status().is_connected);
  EXPECT_EQ(source->status().trouble, "");
  EXPECT_EQ(fake_.opened, 2);
  EXPECT_FALSE(source->next()->after_gap);
  bool is_remarked = false;
  for (const SourceRemark& remark : source->remarks())
    is_remarked = is_remarked || remark.what == "was lost and came back: once";
  EXPECT_TRUE(is_remarked);
}

TEST_F(V4l2Sequence, ReportsWhyItIsNotConnected) {
  FakeDevice& device = steady();
  device.repeats = false;
  device.events = {frame(0, 1000), error(ENODEV)};
  device.open_errors = {0};
  device.open_errors.insert(device.open_errors.end(), 1000, ENOENT);
  const auto source = sequence();
  ASSERT_TRUE(source->next());
  SourceStatus status;
  for (int i = 0; i < 200 && !has(status.trouble, {"no such device"}); ++i) {
    std::this_thread::sleep_for(5ms);
    status = source->status();
  }
  EXPECT_FALSE(status.is_connected);
  EXPECT_TRUE(has(status.trouble, {"no such device"}));
  EXPECT_EQ(status.reconnects, 0U);
}

TEST_F(V4l2Sequence, SilenceIsADisconnection) {
  FakeDevice& device = steady();
  device.events = {frame(0, 1000)};
  device.events.insert(device.events.end(), 6, silence());  // of 50 ms each
  device.events.push_back(frame(0, 700'000));
  const auto source = sequence();
  ASSERT_TRUE(source->next());
  const auto pair = source->next();
  ASSERT_TRUE(pair);
  EXPECT_TRUE(pair->after_gap);
  EXPECT_EQ(source->status().reconnects, 1U);
  EXPECT_GE(fake_.opened, 2);
}

TEST_F(V4l2Sequence, WaitsIfItReturnsInAnotherSize) {
  FakeDevice& device = steady();
  device.events = {frame(0, 1000), error(ENODEV), frame(0, 2000)};
  device.shrinks = true;
  const auto source = sequence();
  ASSERT_TRUE(source->next());
  SourceStatus status;
  for (int i = 0; i < 200 && !has(status.trouble, {"gives 2x4"}); ++i) {
    std::this_thread::sleep_for(5ms);
    status = source->status();
  }
  EXPECT_TRUE(has(status.trouble, {"gives 2x4", "expected 4x4 as before"}));
  EXPECT_FALSE(status.is_connected);
}

TEST_F(V4l2Sequence, WithoutAFrameIsNotOpened) {
  fake_.devices[kDevice] = yuyv_device();
  SourceOptions options;
  options.open_timeout_s = 0.1;
  const auto began = Clock::now();
  EXPECT_TRUE(has(refusal([&] { (void)sequence(options); }),
                  {"v4l2:/dev/video0", "no frame within 0.1 s", "--open-timeout"}));
  EXPECT_LT(Clock::now() - began, 1s);
  options.open_timeout_s = 0;
  EXPECT_TRUE(has(refusal([&] { (void)open_sequence("v4l2:/dev/video0", options); }), {"--open-timeout"}));
  EXPECT_TRUE(
      has(refusal([&] { (void)sequence("v4l2:/dev/video7"); }), {"v4l2:/dev/video7", "no such device"}));
  options = {};
  options.rate_hz = 10;
  EXPECT_TRUE(has(refusal([&] { (void)sequence(options); }), {"--rate"}));
}

TEST_F(V4l2Sequence, CanBeStoppedFromAnotherThreadWhileWaiting) {
  for (const bool is_lost : {false, true}) {
    FakeDevice& device = steady();
    device.repeats = false;
    device.events = {frame(0, 1000)};
    if (is_lost) device.events.push_back(error(ENODEV));
    const auto source = sequence({}, {10s, 10s, 10s, 10s});
    ASSERT_TRUE(source->next());
    auto waiting = std::async(std::launch::async, [&] { return source->next().has_value(); });
    std::this_thread::sleep_for(100ms);
    const auto stopped = Clock::now();
    source->stop();
    EXPECT_FALSE(waiting.get());
    EXPECT_LT(Clock::now() - stopped, 200ms);
    EXPECT_FALSE(source->next());
  }
}

TEST_F(V4l2Sequence, UsesTheGivenCalibrationAndRectifiesRawImages) {
  const support::TemporaryFolder folder;
  io::RawCalibration raw{{32, 24}, {}, {}, {}, {}};
  raw.left.matrix = {40, 0, 16, 0, 40, 12, 0, 0, 1};
  raw.right.matrix = {41, 0, 15, 0, 41, 12.5, 0, 0, 1};
  raw.left.distortion = {-0.1, 0.01, 0, 0};
  raw.right.distortion = {-0.12, 0.02, 0, 0};
  raw.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  raw.translation_m = {-0.08, 0, 0};
  io::save_raw_calibration(folder.path() / "calib.yaml", raw, {});
  FakeDevice& device = steady();
  device.formats = {V4L2_PIX_FMT_GREY};
  device.width = 64;
  device.height = 24;
  device.picture = bytes_of_noise(64 * 24);
  SourceOptions options;
  options.rectify = true;
  EXPECT_TRUE(has(refusal([&] { (void)sequence(options); }), {"--rectify", "--calib"}));
  options.calib = (folder.path() / "calib.yaml").string();
  const auto source = sequence(options);
  ASSERT_TRUE(source->rig());
  ASSERT_TRUE(source->rectifier());
  const auto found = source->next();
  ASSERT_TRUE(found);

  // The same images as files.
  Image<Gray> left({32, 24});
  Image<Gray> right({32, 24});
  for (int y = 0; y < 24; ++y) {
    for (int x = 0; x < 32; ++x) {
      left(x, y) = static_cast<Gray>(byte(device.picture, 64 * y + x));
      right(x, y) = static_cast<Gray>(byte(device.picture, 64 * y + x + 32));
    }
  }
  std::filesystem::create_directories(folder.path() / "files/000");
  io::save_png(folder.path() / "files/000/left.png", left.view());
  io::save_png(folder.path() / "files/000/right.png", right.view());
  const auto truth = open_sequence((folder.path() / "files").string(), options)->next();
  ASSERT_TRUE(truth);
  for (int y = 0; y < 24; ++y) {
    for (int x = 0; x < 32; ++x) {
      ASSERT_EQ(found->left.gray(x, y), truth->left.gray(x, y));
      ASSERT_EQ(found->right(x, y), truth->right(x, y));
    }
  }
  options.rectify = false;
  options.calib =
      folder.with("calib.txt", "fx=40\nfy=40\ncx=16\ncy=12\nbaseline=0.1\nwidth=99\nheight=24\n").string();
  EXPECT_TRUE(has(refusal([&] { (void)sequence(options); }), {"calib.txt", "99"}));
}

// ---- two devices ----

class TwoDevices : public V4l2Sequence {
 protected:
  static constexpr const char* kBoth = "v4l2:/dev/video0,/dev/video2";
};

TEST_F(TwoDevices, ArePairedByStampsAndTheRestIsCounted) {
  FakeDevice& left = steady("/dev/video0");
  FakeDevice& right = steady("/dev/video2");
  right.picture = bytes_of_noise(8 * 4 * 2, 9);
  // The right one is 1 ms late, misses the third frame, and has an extra one.
  left.events = {frame(0, 100'000), frame(1, 133'000), frame(2, 166'000), frame(3, 200'000)};
  right.events = {frame(0, 101'000), frame(1, 134'000), frame(2, 150'000), frame(3, 201'000)};
  left.repeats = right.repeats = false;
  left.pace_ms = right.pace_ms = 60;  // so that no pair is skipped
  const auto source = sequence(kBoth, {}, {10s, 10s, 10s, 10s});
  EXPECT_EQ(source->name(), "video0,video2");
  std::vector<std::int64_t> stamps;
  for (int i = 0; i < 3; ++i) {
    const auto pair = source->next();
    ASSERT_TRUE(pair);
    stamps.push_back(pair->stamp.ns);
    EXPECT_EQ(int{pair->left.gray(3, 2)}, byte(left.picture, 2 * 16 + 6));
    EXPECT_EQ(int{pair->right(3, 2)}, byte(right.picture, 2 * 16 + 6));
  }
  const auto steady_zero =
      std::chrono::system_clock::now().time_since_epoch() - Clock::now().time_since_epoch();
  EXPECT_NEAR(static_cast<double>(stamps[0] - std::chrono::nanoseconds(steady_zero).count()) * 1e-6, 100, 50);
  EXPECT_EQ(stamps[1] - stamps[0], 33'000'000);
  EXPECT_EQ(stamps[2] - stamps[0], 100'000'000);
  EXPECT_EQ(source->status().unpaired, 2U);
  std::string all;
  for (const SourceRemark& remark : source->remarks()) all += remark.what + "\n";
  EXPECT_TRUE(has(all, {"left image without a right one", "right image without a left one",
                        "the two cameras are not synchronised: right images are 1.0 to 1.0 ms later",
                        "wrong disparities"}));
}

TEST_F(TwoDevices, ReportTheTimeDifferenceIfNeverSynchronous) {
  steady("/dev/video0");
  FakeDevice& right = steady("/dev/video2");
  right.events = {frame(0, 12'000'000)};
  SourceOptions options;
  options.open_timeout_s = 0.2;
  const std::string words = refusal([&] { (void)sequence(kBoth, options); });
  EXPECT_TRUE(has(words, {"no pair within 0.2 s", "apart", "--max-skew"}));
  right.events = {silence()};
  EXPECT_TRUE(has(refusal([&] { (void)sequence(kBoth, options); }), {"no frame of the right camera"}));
  fake_.devices.erase("/dev/video2");
  EXPECT_TRUE(has(refusal([&] { (void)sequence(kBoth, options); }), {"the right camera: no such device"}));
}

TEST_F(TwoDevices, OfDifferentSizesAreRefused) {
  steady("/dev/video0");
  steady("/dev/video2").height = 2;
  EXPECT_TRUE(has(refusal([&] { (void)sequence(kBoth); }), {"right camera gives 8x2", "expected 8x4"}));
}

CameraImage image_at(double ms) {
  CameraImage image;
  image.stamp = {std::llround(ms * 1e6)};
  return image;
}

TEST(StampPairer, PairsTheNearestAndEstimatesTheDrift) {
  StampPairer pairer(6);
  constexpr double kDrift = 40e-6;
  int pairs = 0;
  for (int i = 0; i < 3000; ++i) {
    const double left = i * 33.3;
    const double right = 1 + left * (1 + kDrift) + 0.3 * std::sin(i * 12.9898);
    EXPECT_FALSE(pairer.push(0, image_at(left)));
    const auto pair = pairer.push(1, image_at(right));
    if (pair) ++pairs;
  }
  EXPECT_EQ(pairs, 3000);
  EXPECT_NEAR(pairer.skew().drift_ppm, 40, 1.5);
  EXPECT_NEAR(pairer.skew().drift_over_s, 99.9, 0.1);
  EXPECT_NEAR(pairer.skew().least_ms, 0.7, 0.1);
  EXPECT_NEAR(pairer.skew().most_ms, 5, 0.5);
}

TEST(StampPairer, SkipsFramesTooFarApart) {
  StampPairer pairer(2);
  EXPECT_FALSE(pairer.push(0, image_at(0)));
  EXPECT_FALSE(pairer.push(1, image_at(7)));
  EXPECT_EQ(pairer.unpaired(0), 1U);
  EXPECT_EQ(pairer.nearest_unpaired_ms(), 7);
  EXPECT_TRUE(pairer.push(0, image_at(8)));
  // One side alone does not fill the memory.
  for (int i = 0; i < 100; ++i) EXPECT_FALSE(pairer.push(0, image_at(100 + i)));
  EXPECT_EQ(pairer.unpaired(0), 93U);
  // The next waiting image is nearer.
  const auto pair = pairer.push(1, image_at(197.4));
  ASSERT_TRUE(pair);
  EXPECT_EQ(pair->left.stamp.ns, 197'000'000);
}

TEST(CameraNames, HaveNoPasswordInMessages) {
  EXPECT_EQ(without_password("rtsp://me:secret@10.0.0.1/a"), "rtsp://***@10.0.0.1/a");
  EXPECT_EQ(without_password("gst:rtspsrc location=rtsp://a:b@h ! x !! rtspsrc location=rtsp://c@d/e"),
            "gst:rtspsrc location=rtsp://***@h ! x !! rtspsrc location=rtsp://***@d/e");
  EXPECT_EQ(without_password("rtsp://h/a@b"), "rtsp://h/a@b");
  EXPECT_EQ(without_password("gst:rtspsrc location=rtsp://h/a user-id=me user-pw=\"a b\" ! x !! y user-pw=z"),
            "gst:rtspsrc location=rtsp://h/a user-id=*** user-pw=*** ! x !! y user-pw=***");
}

}  // namespace
}  // namespace cairn::input
