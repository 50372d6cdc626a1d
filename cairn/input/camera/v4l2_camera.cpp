// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/input/camera/v4l2_camera.hpp>

#include <linux/videodev2.h>

#include <algorithm>
#include <array>
#include <cairn/core/error.hpp>
#include <cairn/io/raster.hpp>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

namespace cairn::input {
namespace {

using Clock = std::chrono::steady_clock;

// For older kernel headers.
#ifndef V4L2_PIX_FMT_Y8I
#define V4L2_PIX_FMT_Y8I v4l2_fourcc('Y', '8', 'I', ' ')
#endif

struct Format {
  std::string_view name;
  std::uint32_t code;
  int bytes_each;  // per pixel; 0 = compressed
};
/// Formats by preference if none is requested: both images in one first, then the cheapest.
constexpr std::array kFormats = {Format{"Y8I", V4L2_PIX_FMT_Y8I, 2}, Format{"GREY", V4L2_PIX_FMT_GREY, 1},
                                 Format{"YUYV", V4L2_PIX_FMT_YUYV, 2}, Format{"MJPG", V4L2_PIX_FMT_MJPEG, 0}};
constexpr std::uint32_t kBuffers = 4;
/// The kernel reports damaged frames with EIO; this many in a row are a failure.
constexpr int kMaxErrors = 8;

std::string name_of(std::uint32_t code) {
  std::string name;
  for (int shift = 0; shift < 32; shift += 8) name += static_cast<char>((code >> shift) & 0x7F);
  while (!name.empty() && name.back() == ' ') name.pop_back();
  return name;
}

std::string reason() {
  return std::strerror(errno);
}

/// An open device; closing it releases everything.
class Device {
 public:
  Device(const std::string& path, V4l2Ops& ops) : ops_(ops), fd_(ops.open(path.c_str())) {
    if (fd_ >= 0) return;
    switch (errno) {
      case ENOENT:
      case ENODEV:
      case ENXIO:
        throw Error("no such device, expected a camera (v4l2-ctl --list-devices lists them)");
      case EACCES:
      case EPERM:
        throw Error("permission denied, expected a user of the group video");
      case EBUSY:
        throw Error("is used by another program");
      default:
        throw Error("cannot be opened: " + reason());
    }
  }
  ~Device() {
    if (is_streaming_) {
      int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
      (void)control(VIDIOC_STREAMOFF, type);
    }
    for (const auto& buffer : buffers_) (void)ops_.unmap(buffer.data(), buffer.size());
    (void)ops_.close(fd_);
  }
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  template <class Argument>
  [[nodiscard]] bool control(unsigned long request, Argument& argument) {
    return ops_.ioctl(fd_, request, &argument) >= 0;
  }
  [[nodiscard]] int wait(std::chrono::milliseconds timeout) {
    return ops_.poll(fd_, static_cast<int>(timeout.count()));
  }
  [[nodiscard]] bool give_back(std::uint32_t index) {
    v4l2_buffer buffer = empty_buffer();
    buffer.index = index;
    return control(VIDIOC_QBUF, buffer);
  }
  [[nodiscard]] std::span<const std::uint8_t> bytes(std::uint32_t index) const { return buffers_[index]; }
  [[nodiscard]] std::size_t buffers() const { return buffers_.size(); }

  void begin_stream() {
    v4l2_requestbuffers request{};
    request.count = kBuffers;
    request.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    request.memory = V4L2_MEMORY_MMAP;
    if (!control(VIDIOC_REQBUFS, request)) {
      throw Error(errno == EBUSY ? "is used by another program"
                                 : "provides no buffers in shared memory: " + reason());
    }
    if (request.count < 2)
      throw Error("gives " + std::to_string(request.count) + " buffers, expected 2 or more");
    for (std::uint32_t i = 0; i < request.count; ++i) map(i);
    for (std::uint32_t i = 0; i < request.count; ++i) {
      if (!give_back(i)) throw Error("accepts no buffer: " + reason());
    }
    int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    if (!control(VIDIOC_STREAMON, type)) {
      throw Error(errno == ENOSPC
                      ? "cannot start: not enough USB bandwidth, expected a smaller size, a lower rate, "
                        "format=MJPG or another port"
                      : "cannot start: " + reason());
    }
    is_streaming_ = true;
  }

  static v4l2_buffer empty_buffer() {
    v4l2_buffer buffer{};
    buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    buffer.memory = V4L2_MEMORY_MMAP;
    return buffer;
  }

 private:
  void map(std::uint32_t index) {
    v4l2_buffer buffer = empty_buffer();
    buffer.index = index;
    if (!control(VIDIOC_QUERYBUF, buffer)) throw Error("does not report its buffers: " + reason());
    void* start = ops_.map(fd_, buffer.length, buffer.m.offset);
    if (start == nullptr) throw Error("does not share its memory: " + reason());
    buffers_.push_back({static_cast<std::uint8_t*>(start), buffer.length});
  }

  V4l2Ops& ops_;
  int fd_;
  std::vector<std::span<std::uint8_t>> buffers_;
  bool is_streaming_ = false;
};

class V4l2Camera : public Camera {
 public:
  V4l2Camera(V4l2Request request, V4l2Ops& ops, Pool pool)
      : request_(std::move(request)), pool_(std::move(pool)), device_(request_.device, ops) {
    check_capabilities();
    choose_format();
    set_size();
    set_rate();
    device_.begin_stream();
  }

  std::optional<CameraImage> next(std::chrono::milliseconds timeout) override {
    if (device_.wait(timeout) <= 0) return std::nullopt;  // also after a signal
    v4l2_buffer buffer = Device::empty_buffer();
    if (!device_.control(VIDIOC_DQBUF, buffer)) return failed();
    const auto arrived = Clock::now();
    count_gap(buffer.sequence);
    std::optional<CameraImage> image;
    if (buffer.index < device_.buffers() && (buffer.flags & V4L2_BUF_FLAG_ERROR) == 0) {
      image =
          image_of(device_.bytes(buffer.index)
                       .first(std::min<std::size_t>(buffer.bytesused, device_.bytes(buffer.index).size())));
    }
    if (!device_.give_back(buffer.index)) throw Error("does not take a buffer back: " + reason());
    if (!image) {
      ++dropped_;
      return std::nullopt;
    }
    errors_ = 0;
    image->arrived = arrived;
    image->stamp = stamp_of(buffer, arrived);
    image->dropped = std::exchange(dropped_, 0);
    return image;
  }

  [[nodiscard]] std::vector<std::string> notes() const override { return notes_; }

 private:
  // ---- negotiating the format ----

  void check_capabilities() {
    v4l2_capability can{};
    if (!device_.control(VIDIOC_QUERYCAP, can)) throw Error("is not a V4L2 camera: " + reason());
    const std::uint32_t has =
        (can.capabilities & V4L2_CAP_DEVICE_CAPS) != 0 ? can.device_caps : can.capabilities;
    if ((has & V4L2_CAP_VIDEO_CAPTURE) == 0) {
      throw Error((has & V4L2_CAP_VIDEO_CAPTURE_MPLANE) != 0
                      ? "has images in several planes, expected one plane (gst:'v4l2src device=...' or "
                        "gst:'libcamerasrc' may read it)"
                      : "captures no images (a camera often has a second device for metadata)");
    }
    if ((has & V4L2_CAP_STREAMING) == 0) throw Error("cannot stream, expected a camera that can");
  }

  void choose_format() {
    std::vector<std::uint32_t> offered;
    v4l2_fmtdesc description{};
    description.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    for (; device_.control(VIDIOC_ENUM_FMT, description); ++description.index)
      offered.push_back(description.pixelformat);
    for (const Format& format : kFormats) {
      if (format.code == V4L2_PIX_FMT_Y8I && request_.layout == Layout::one) continue;
      const bool is_wanted = request_.format.empty() || request_.format == format.name;
      if (is_wanted && std::find(offered.begin(), offered.end(), format.code) != offered.end()) {
        format_ = &format;
        return;
      }
    }
    std::string names;
    for (const std::uint32_t code : offered) names += (names.empty() ? "" : ", ") + name_of(code);
    throw Error("has the formats " + (names.empty() ? "none" : names) + ", expected " +
                (request_.format.empty()
                     ? "GREY, Y8I, YUYV or MJPG (gst:'v4l2src device=...' may read others)"
                     : request_.format));
  }

  void set_size() {
    v4l2_format format{};
    format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    if (!device_.control(VIDIOC_G_FMT, format)) throw Error("does not report its format: " + reason());
    v4l2_pix_format& pixels = format.fmt.pix;
    const bool has_size = request_.size.area() > 0;
    if (has_size) {
      pixels.width = static_cast<std::uint32_t>(request_.size.width);
      pixels.height = static_cast<std::uint32_t>(request_.size.height);
    }
    pixels.pixelformat = format_->code;
    pixels.field = V4L2_FIELD_ANY;
    pixels.bytesperline = 0;
    pixels.sizeimage = 0;
    if (!device_.control(VIDIOC_S_FMT, format)) {
      throw Error(errno == EBUSY ? "is used by another program"
                                 : "refuses the format " + std::string(format_->name) + ": " + reason());
    }
    if (pixels.pixelformat != format_->code) {
      throw Error("gives the format " + name_of(pixels.pixelformat) + ", expected " +
                  std::string(format_->name));
    }
    if (pixels.width == 0 || pixels.height == 0 || pixels.width > io::kMaxPixelsPerSide ||
        pixels.height > io::kMaxPixelsPerSide) {
      throw Error("gives " + std::to_string(pixels.width) + "x" + std::to_string(pixels.height) +
                  ", expected sides of 1 ... " + std::to_string(io::kMaxPixelsPerSide));
    }
    if (format_->code == V4L2_PIX_FMT_YUYV && pixels.width % 2 != 0) {
      throw Error("gives YUYV " + std::to_string(pixels.width) + " px wide, expected an even width");
    }
    size_ = {static_cast<int>(pixels.width), static_cast<int>(pixels.height)};
    if (has_size && size_ != request_.size) {
      throw Error("gives " + text(size_) + ", expected " + text(request_.size) +
                  " (v4l2-ctl --list-formats-ext lists the formats)");
    }
    const auto least = static_cast<std::uint32_t>(size_.width * format_->bytes_each);
    stride_ = std::max(pixels.bytesperline, least);
    const bool is_full = pixels.quantization == V4L2_QUANTIZATION_FULL_RANGE;
    coding_ = is_full ? YuvCoding::bt601_full : YuvCoding::bt601;
    check_halves();
  }

  void check_halves() const {
    if (request_.layout == Layout::one || format_->code == V4L2_PIX_FMT_Y8I) return;
    // Fails early if the image cannot be halved.
    (void)halves_of(format_->code == V4L2_PIX_FMT_YUYV ? yuyv_bytes(size_, nullptr, 0, coding_)
                                                       : grey_bytes(size_, nullptr, 0),
                    request_.layout);
  }

  void set_rate() {
    if (request_.fps <= 0) return;
    v4l2_streamparm rate{};
    rate.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    v4l2_fract& period = rate.parm.capture.timeperframe;
    period = {1000, static_cast<std::uint32_t>(std::lround(1000 * request_.fps))};
    if (!device_.control(VIDIOC_S_PARM, rate) || period.numerator == 0 || period.denominator == 0) {
      notes_.push_back("fps: the frame rate of the camera cannot be set");
      return;
    }
    const double fps = static_cast<double>(period.denominator) / static_cast<double>(period.numerator);
    if (std::abs(fps - request_.fps) > 0.01 * request_.fps) {
      std::array<char, 80> words{};
      std::snprintf(words.data(), words.size(), "fps: found %.4g, expected %.4g", fps, request_.fps);
      notes_.emplace_back(words.data());
    }
  }

  // ---- frames ----

  std::optional<CameraImage> failed() {
    switch (errno) {
      case EAGAIN:
      case EINTR:
        return std::nullopt;
      case EIO:
        ++dropped_;
        if (++errors_ < kMaxErrors) return std::nullopt;
        throw Error("returns only errors (EIO): cable, power or USB bus");
      case ENODEV:
      case ENXIO:
        throw Error("was unplugged");
      default:
        throw Error("delivers no frame: " + reason());
    }
  }

  void count_gap(std::uint32_t sequence) {
    // Wraps around like the kernel's counter; a counter that restarts is no gap.
    if (has_sequence_) {
      const auto step = static_cast<std::int32_t>(sequence - sequence_);
      if (step > 1) dropped_ += static_cast<std::uint64_t>(step) - 1;
    }
    sequence_ = sequence;
    has_sequence_ = true;
  }

  /// nullopt if it is too short or damaged.
  std::optional<CameraImage> image_of(std::span<const std::uint8_t> bytes) {
    if (format_->bytes_each == 0) return image_of_jpeg(bytes);
    const std::size_t row =
        static_cast<std::size_t>(size_.width) * static_cast<std::size_t>(format_->bytes_each);
    if (bytes.size() < stride_ * (static_cast<std::size_t>(size_.height) - 1) + row) return std::nullopt;
    const auto stride = static_cast<std::ptrdiff_t>(stride_);
    switch (format_->code) {
      case V4L2_PIX_FMT_YUYV:
        return split(yuyv_bytes(size_, bytes.data(), stride, coding_));
      case V4L2_PIX_FMT_Y8I: {
        FrameBytes left = grey_bytes(size_, bytes.data(), stride);
        left.first.step = 2;
        FrameBytes right = left;
        ++right.first.data;
        return both(left, right);
      }
      default:
        return split(grey_bytes(size_, bytes.data(), stride));
    }
  }

  std::optional<CameraImage> image_of_jpeg(std::span<const std::uint8_t> bytes) {
    io::Raster raster;
    try {
      raster = io::decode_jpeg({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    } catch (const Error&) {
      return std::nullopt;
    }
    if (raster.size != size_) return std::nullopt;
    const std::ptrdiff_t stride = raster.row_length();
    return split(raster.channels == 3 ? rgb_bytes(size_, raster.bytes.data(), stride, 3, 0, 1, 2)
                                      : grey_bytes(size_, raster.bytes.data(), stride));
  }

  [[nodiscard]] CameraImage split(const FrameBytes& bytes) const {
    if (request_.layout == Layout::one) {
      CameraImage image;
      image.left = picture_of(bytes, request_.with_colour, pool_);
      return image;
    }
    const TwoFrames halves = halves_of(bytes, request_.layout);
    return both(halves.left, halves.right);
  }
  [[nodiscard]] CameraImage both(const FrameBytes& left, const FrameBytes& right) const {
    CameraImage image;
    image.left = picture_of(left, request_.with_colour, pool_);
    image.right = picture_of(right, false, pool_).gray;
    return image;
  }

  static Stamp stamp_of(const v4l2_buffer& buffer, Clock::time_point arrived) {
    if ((buffer.flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) == V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC)
      return {buffer.timestamp.tv_sec * std::int64_t{1'000'000'000} + buffer.timestamp.tv_usec * 1000};
    return {std::chrono::duration_cast<std::chrono::nanoseconds>(arrived.time_since_epoch()).count()};
  }

  V4l2Request request_;
  Pool pool_;
  Device device_;
  const Format* format_ = nullptr;
  Size size_;
  std::size_t stride_ = 0;
  YuvCoding coding_ = YuvCoding::bt601;
  std::vector<std::string> notes_;
  std::uint64_t dropped_ = 0;
  std::uint32_t sequence_ = 0;
  bool has_sequence_ = false;
  int errors_ = 0;
};

}  // namespace

std::unique_ptr<Camera> open_v4l2(const V4l2Request& request, V4l2Ops& ops, const Pool& pool) {
  return std::make_unique<V4l2Camera>(request, ops, pool);
}

}  // namespace cairn::input
