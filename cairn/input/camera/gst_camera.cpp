// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/input/camera/gst_camera.hpp>

#include <gst/app/gstappsink.h>
#include <gst/gst.h>
#include <gst/video/video.h>

#include <algorithm>
#include <array>
#include <cairn/core/error.hpp>
#include <mutex>
#include <optional>
#include <utility>

#include <cairn/input/camera/without_password.hpp>

namespace cairn::input {
namespace {

using Clock = std::chrono::steady_clock;

/// 8-bit formats in any layout: the source's own is used, so that grey values are exact.
constexpr const char* kCaps =
    "video/x-raw, format={ NV12, I420, YV12, NV21, YUY2, UYVY, YVYU, Y42B, Y444, GRAY8, RGB, BGR, RGBx, "
    "BGRx, "
    "xRGB, xBGR, RGBA, BGRA, ARGB, ABGR }";

template <class T>
struct Unref {
  void operator()(T* object) const { gst_object_unref(object); }
};
template <class T>
using Ref = std::unique_ptr<T, Unref<T>>;

struct UnrefSample {
  void operator()(GstSample* sample) const { gst_sample_unref(sample); }
};

/// Formats an error as one line: the message, and the last line of its details.
std::string words_of(const GError& error, const char* debug) {
  std::string words = error.message != nullptr ? error.message : "unknown error";
  if (debug != nullptr) {
    std::string about = debug;
    while (!about.empty() && about.back() == '\n') about.pop_back();
    if (const std::size_t line = about.rfind('\n'); line != std::string::npos)
      words += " (" + about.substr(line + 1) + ")";
  }
  for (char& c : words) {
    if (c == '\n' || c == '\r') c = ' ';
  }
  if (words.find("not-negotiated") != std::string::npos)
    words += ", expected raw video at the end of the pipeline (add decodebin or a decoder)";
  return without_password(words);
}

void init() {
  static std::once_flag once;
  static std::string trouble;
  std::call_once(once, [] {
    GError* error = nullptr;
    if (gst_init_check(nullptr, nullptr, &error) != 0) return;
    trouble = error != nullptr ? error->message : "unknown error";
    g_clear_error(&error);
  });
  if (!trouble.empty()) throw Error("GStreamer cannot be started: " + trouble);
}

Ref<GstElement> parsed(const std::string& pipeline) {
  GError* error = nullptr;
  const std::string text = pipeline + " ! videoconvert ! appsink name=cairn_sink";
  GstElement* element = gst_parse_launch_full(text.c_str(), nullptr, GST_PARSE_FLAG_FATAL_ERRORS, &error);
  if (error != nullptr || element == nullptr) {
    std::string words = error != nullptr ? words_of(*error, nullptr) : "unknown error";
    if (error != nullptr && error->domain == GST_PARSE_ERROR &&
        error->code == GST_PARSE_ERROR_NO_SUCH_ELEMENT)
      words += ", expected an installed element (gst-inspect-1.0 lists them)";
    g_clear_error(&error);
    if (element != nullptr) gst_object_unref(element);
    throw Error("the pipeline cannot be created: " + words);
  }
  return Ref<GstElement>(element);
}

YuvCoding coding_of(const GstVideoInfo& info) {
  const bool is_full = info.colorimetry.range == GST_VIDEO_COLOR_RANGE_0_255;
  if (info.colorimetry.matrix == GST_VIDEO_COLOR_MATRIX_BT709)
    return is_full ? YuvCoding::bt709_full : YuvCoding::bt709;
  return is_full ? YuvCoding::bt601_full : YuvCoding::bt601;
}

Samples samples_of(const GstVideoFrame& frame, unsigned component) {
  const GstVideoFormatInfo& format = *frame.info.finfo;
  return {static_cast<const std::uint8_t*>(GST_VIDEO_FRAME_COMP_DATA(&frame, component)),
          GST_VIDEO_FRAME_COMP_STRIDE(&frame, component), GST_VIDEO_FRAME_COMP_PSTRIDE(&frame, component),
          static_cast<int>(GST_VIDEO_FORMAT_INFO_W_SUB(&format, component)),
          static_cast<int>(GST_VIDEO_FORMAT_INFO_H_SUB(&format, component))};
}

FrameBytes bytes_of(const GstVideoFrame& frame) {
  FrameBytes bytes;
  bytes.size = {GST_VIDEO_FRAME_WIDTH(&frame), GST_VIDEO_FRAME_HEIGHT(&frame)};
  bytes.first = samples_of(frame, 0);
  if (GST_VIDEO_INFO_IS_GRAY(&frame.info)) return bytes;
  bytes.kind = GST_VIDEO_INFO_IS_RGB(&frame.info) ? FrameBytes::Kind::rgb : FrameBytes::Kind::yuv;
  bytes.second = samples_of(frame, 1);
  bytes.third = samples_of(frame, 2);
  bytes.coding = coding_of(frame.info);
  return bytes;
}

class GstCamera : public Camera {
 public:
  explicit GstCamera(GstRequest request) : request_(std::move(request)), pipeline_(made(request_)) {
    sink_.reset(gst_bin_get_by_name(GST_BIN(pipeline_.get()), "cairn_sink"));
    bus_.reset(gst_element_get_bus(pipeline_.get()));
    GstCaps* caps = gst_caps_from_string(kCaps);
    gst_app_sink_set_caps(sink(), caps);
    gst_caps_unref(caps);
    g_object_set(sink_.get(), "max-buffers", 1U, "drop", TRUE, "enable-last-sample", FALSE, nullptr);
    const Ref<GstPad> pad(gst_element_get_static_pad(sink_.get(), "sink"));
    gst_pad_add_probe(pad.get(), GST_PAD_PROBE_TYPE_BUFFER, &GstCamera::on_buffer, this, nullptr);
    // All pipelines use the monotonic clock.
    const Ref<GstClock> clock(gst_system_clock_obtain());
    gst_pipeline_use_clock(GST_PIPELINE(pipeline_.get()), clock.get());
    start();
  }
  ~GstCamera() override { gst_element_set_state(pipeline_.get(), GST_STATE_NULL); }

  std::optional<CameraImage> next(std::chrono::milliseconds timeout) override {
    const std::unique_ptr<GstSample, UnrefSample> sample(
        gst_app_sink_try_pull_sample(sink(), static_cast<GstClockTime>(timeout.count()) * GST_MSECOND));
    if (!sample) {
      throw_error();
      has_ended_ = gst_app_sink_is_eos(sink()) != 0;
      if (has_ended_ && request_.must_not_end) throw Error("was ended by the other side");
      return std::nullopt;
    }
    CameraImage image = image_of(*sample);
    image.arrived = Clock::now();
    GstBuffer* buffer = gst_sample_get_buffer(sample.get());
    image.stamp = stamp_of(*sample, *buffer, image.arrived);
    image.dropped = dropped_before(*buffer);
    return image;
  }
  [[nodiscard]] bool has_ended() const override { return has_ended_; }

 private:
  static Ref<GstElement> made(const GstRequest& request) {
    init();
    Ref<GstElement> pipeline = parsed(request.pipeline);
    if (!request.location.empty()) {
      const Ref<GstElement> source(gst_bin_get_by_name(GST_BIN(pipeline.get()), "cairn_source"));
      g_object_set(source.get(), "location", request.location.c_str(), nullptr);
    }
    return pipeline;
  }

  static GstPadProbeReturn on_buffer(GstPad*, GstPadProbeInfo* info, gpointer self) {
    static_cast<GstCamera*>(self)->number(GST_PAD_PROBE_INFO_BUFFER(info));
    return GST_PAD_PROBE_OK;
  }
  /// On the pipeline's thread: counts buffers, to find those replaced in the sink.
  void number(const GstBuffer* buffer) {
    const std::lock_guard lock(mutex_);
    ++came_;
    numbered_[came_ % numbered_.size()] = {buffer, came_};
  }
  std::uint64_t number_of(const GstBuffer* buffer) {
    const std::lock_guard lock(mutex_);
    std::uint64_t found = 0;
    // The newest one, since buffers are reused.
    for (const auto& [known, number] : numbered_) {
      if (known == buffer) found = std::max(found, number);
    }
    return found;
  }

  [[nodiscard]] GstAppSink* sink() const { return GST_APP_SINK(sink_.get()); }

  void start() {
    const GstStateChangeReturn paused = gst_element_set_state(pipeline_.get(), GST_STATE_PAUSED);
    // Cameras deliver at their own rate, files at the pace of their stamps.
    g_object_set(sink_.get(), "sync", paused == GST_STATE_CHANGE_NO_PREROLL ? FALSE : TRUE, nullptr);
    if (paused == GST_STATE_CHANGE_FAILURE ||
        gst_element_set_state(pipeline_.get(), GST_STATE_PLAYING) == GST_STATE_CHANGE_FAILURE) {
      // The pipeline's destructor alone does not stop it.
      std::string words = error_words();
      gst_element_set_state(pipeline_.get(), GST_STATE_NULL);
      throw Error("the pipeline cannot be started" + (words.empty() ? "" : ": " + words));
    }
  }

  /// The error that the pipeline has reported meanwhile; empty without one.
  [[nodiscard]] std::string error_words() const {
    GstMessage* message = gst_bus_pop_filtered(bus_.get(), GST_MESSAGE_ERROR);
    if (message == nullptr) return {};
    GError* error = nullptr;
    gchar* debug = nullptr;
    gst_message_parse_error(message, &error, &debug);
    std::string words = words_of(*error, debug);
    g_clear_error(&error);
    g_free(debug);
    gst_message_unref(message);
    return words;
  }
  void throw_error() const {
    if (std::string words = error_words(); !words.empty()) throw Error("the pipeline fails: " + words);
  }

  [[nodiscard]] CameraImage image_of(GstSample& sample) const {
    GstVideoInfo info;
    GstVideoFrame frame;
    GstCaps* caps = gst_sample_get_caps(&sample);
    if (caps == nullptr || gst_video_info_from_caps(&info, caps) == 0 ||
        gst_video_frame_map(&frame, &info, gst_sample_get_buffer(&sample), GST_MAP_READ) == 0)
      throw Error("the pipeline delivered an image that cannot be read");
    struct Unmap {
      GstVideoFrame& frame;
      ~Unmap() { gst_video_frame_unmap(&frame); }
    } const unmap{frame};
    CameraImage image;
    const FrameBytes bytes = bytes_of(frame);
    if (request_.layout == Layout::one) {
      image.left = picture_of(bytes, request_.with_colour, request_.pool);
      return image;
    }
    const TwoFrames halves = halves_of(bytes, request_.layout);
    image.left = picture_of(halves.left, request_.with_colour, request_.pool);
    image.right = picture_of(halves.right, false, request_.pool).gray;
    return image;
  }

  [[nodiscard]] Stamp stamp_of(GstSample& sample, const GstBuffer& buffer, Clock::time_point arrived) const {
    if (GST_BUFFER_PTS_IS_VALID(&buffer)) {
      const GstClockTime running = gst_segment_to_running_time(gst_sample_get_segment(&sample),
                                                               GST_FORMAT_TIME, GST_BUFFER_PTS(&buffer));
      const GstClockTime base = gst_element_get_base_time(pipeline_.get());
      if (GST_CLOCK_TIME_IS_VALID(running) && GST_CLOCK_TIME_IS_VALID(base))
        return {static_cast<std::int64_t>(base + running)};
    }
    return {std::chrono::duration_cast<std::chrono::nanoseconds>(arrived.time_since_epoch()).count()};
  }

  /// Frames replaced in the sink and, if the source numbers its buffers, those that never arrived.
  std::uint64_t dropped_before(const GstBuffer& buffer) {
    std::uint64_t dropped = 0;
    if (const std::uint64_t number = number_of(&buffer); number > 0) {
      if (number > taken_ + 1) dropped = number - taken_ - 1;  // including those before the first
      taken_ = number;
    }
    const std::uint64_t offset = GST_BUFFER_OFFSET(&buffer);
    if (offset == GST_BUFFER_OFFSET_NONE || GST_BUFFER_OFFSET_END(&buffer) != offset + 1) return dropped;
    if (offset_ && offset > *offset_ + 1) dropped = std::max(dropped, offset - *offset_ - 1);
    offset_ = offset;
    return dropped;
  }

  GstRequest request_;
  std::mutex mutex_;        // guards the next two
  std::uint64_t came_ = 0;  // buffers that arrived at the sink
  std::array<std::pair<const GstBuffer*, std::uint64_t>, 8> numbered_{};
  Ref<GstElement> pipeline_;
  Ref<GstElement> sink_;
  Ref<GstBus> bus_;
  bool has_ended_ = false;
  std::uint64_t taken_ = 0;
  std::optional<std::uint64_t> offset_;
};

}  // namespace

}  // namespace cairn::input

cairn::input::Camera* cairn_open_gst(const cairn::input::GstRequest& request) {
  return std::make_unique<cairn::input::GstCamera>(request).release();
}
