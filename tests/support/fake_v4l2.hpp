// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <linux/videodev2.h>

#include <algorithm>
#include <cairn/input/camera/v4l2_ops.hpp>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace cairn::support {

/// The next event of a device when it is polled or a frame is dequeued.
struct DeviceEvent {
  int error = 0;            // errno of DQBUF; 0 = a frame
  bool is_silence = false;  // no event until the timeout
  std::uint32_t sequence = 0;
  std::int64_t stamp_us = 0;
  std::optional<std::string> bytes;  // other than the device's image
  std::uint32_t flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
};

/// A camera as presented by its driver.
struct FakeDevice {
  std::uint32_t capabilities = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
  std::vector<std::uint32_t> formats{V4L2_PIX_FMT_YUYV};
  std::uint32_t width = 8, height = 4;
  std::optional<std::pair<std::uint32_t, std::uint32_t>> gives_size;  // whatever size is requested
  bool shrinks = false;                                               // to half its width when reopened
  int opens = 0;
  std::uint32_t stride = 0;              // 0 = without padding
  double gives_fps = 0;                  // 0 = as requested
  std::map<unsigned long, int> refuses;  // errno by ioctl
  std::uint32_t buffers = 4;
  std::deque<int> open_errors;  // errno of the next attempts to open it
  std::string picture;          // the bytes of each frame without its own
  std::deque<DeviceEvent> events;
  int pace_ms = 0;       // time between events
  bool repeats = false;  // repeats the last frame after the last event
};

/// Devices that replay a list of events, then stay silent.
class FakeV4l2 : public input::V4l2Ops {
 public:
  std::map<std::string, FakeDevice> devices;
  int opened = 0;
  int open_now = 0;
  int mapped_now = 0;
  int streaming_now = 0;

  int open(const char* path) override {
    const std::lock_guard lock(mutex_);
    const auto found = devices.find(path);
    if (found == devices.end()) return fail(ENOENT);
    FakeDevice& device = found->second;
    if (!device.open_errors.empty()) {
      const int error = device.open_errors.front();
      device.open_errors.pop_front();
      if (error != 0) return fail(error);
    }
    ++opened;
    if (++device.opens > 1 && device.shrinks) device.gives_size = {{device.width / 2, device.height}};
    ++open_now;
    const int fd = next_fd_++;
    files_[fd].device = &device;
    return fd;
  }
  int close(int fd) override {
    const std::lock_guard lock(mutex_);
    files_.erase(fd);
    --open_now;
    return 0;
  }
  int ioctl(int fd, unsigned long request, void* argument) override {
    const std::lock_guard lock(mutex_);
    File& file = files_.at(fd);
    FakeDevice& device = *file.device;
    if (const auto refused = device.refuses.find(request); refused != device.refuses.end())
      return fail(refused->second);
    switch (request) {
      case VIDIOC_QUERYCAP: {
        auto& can = *static_cast<v4l2_capability*>(argument);
        can.capabilities = V4L2_CAP_DEVICE_CAPS;
        can.device_caps = device.capabilities;
        return 0;
      }
      case VIDIOC_ENUM_FMT: {
        auto& format = *static_cast<v4l2_fmtdesc*>(argument);
        if (format.index >= device.formats.size()) return fail(EINVAL);
        format.pixelformat = device.formats[format.index];
        return 0;
      }
      case VIDIOC_G_FMT: {
        auto& pixels = static_cast<v4l2_format*>(argument)->fmt.pix;
        pixels.width = device.width;
        pixels.height = device.height;
        pixels.pixelformat = device.formats.front();
        return 0;
      }
      case VIDIOC_S_FMT: {
        auto& pixels = static_cast<v4l2_format*>(argument)->fmt.pix;
        if (device.gives_size) {
          pixels.width = device.gives_size->first;
          pixels.height = device.gives_size->second;
        }
        pixels.bytesperline = device.stride;
        return 0;
      }
      case VIDIOC_S_PARM: {
        auto& period = static_cast<v4l2_streamparm*>(argument)->parm.capture.timeperframe;
        if (device.gives_fps > 0) period = {1000, static_cast<std::uint32_t>(1000 * device.gives_fps)};
        return 0;
      }
      case VIDIOC_REQBUFS: {
        auto& wanted = *static_cast<v4l2_requestbuffers*>(argument);
        wanted.count = std::min(wanted.count, device.buffers);
        file.memory.assign(wanted.count, std::vector<char>(kBufferBytes));
        return 0;
      }
      case VIDIOC_QUERYBUF: {
        auto& buffer = *static_cast<v4l2_buffer*>(argument);
        buffer.length = kBufferBytes;
        buffer.m.offset = buffer.index * kBufferBytes;
        return 0;
      }
      case VIDIOC_QBUF:
        file.queued.push_back(static_cast<v4l2_buffer*>(argument)->index);
        return 0;
      case VIDIOC_STREAMON:
        ++streaming_now;
        return 0;
      case VIDIOC_STREAMOFF:
        --streaming_now;
        return 0;
      case VIDIOC_DQBUF:
        return fetch(file, *static_cast<v4l2_buffer*>(argument));
      default:
        return fail(ENOTTY);
    }
  }
  void* map(int fd, std::size_t, std::int64_t offset) override {
    const std::lock_guard lock(mutex_);
    ++mapped_now;
    return files_.at(fd).memory[static_cast<std::size_t>(offset) / kBufferBytes].data();
  }
  int unmap(void*, std::size_t) override {
    const std::lock_guard lock(mutex_);
    --mapped_now;
    return 0;
  }
  int poll(int fd, int timeout_ms) override {
    int sleep_ms = timeout_ms;
    bool has_event = false;
    {
      const std::lock_guard lock(mutex_);
      FakeDevice& device = *files_.at(fd).device;
      if (!device.events.empty() && device.events.front().is_silence) {
        if (device.events.size() > 1 || !device.repeats) device.events.pop_front();
      } else if (!device.events.empty()) {
        has_event = true;
        sleep_ms = device.pace_ms;
      }
    }
    if (sleep_ms > 0) std::this_thread::sleep_for(std::chrono::milliseconds(sleep_ms));
    return has_event ? 1 : 0;
  }

 private:
  static constexpr std::uint32_t kBufferBytes = 1U << 16U;
  struct File {
    FakeDevice* device = nullptr;
    std::vector<std::vector<char>> memory;
    std::deque<std::uint32_t> queued;
  };

  static int fail(int error) {
    errno = error;
    return -1;
  }

  static int fetch(File& file, v4l2_buffer& buffer) {
    FakeDevice& device = *file.device;
    if (device.events.empty() || device.events.front().is_silence) return fail(EAGAIN);
    const DeviceEvent event = device.events.front();
    if (device.events.size() > 1 || !device.repeats) {
      device.events.pop_front();
    } else {
      ++device.events.front().sequence;
      device.events.front().stamp_us += 1000 * std::max(1, device.pace_ms);
    }
    if (event.error != 0) return fail(event.error);
    if (file.queued.empty()) return fail(EAGAIN);
    buffer.index = file.queued.front();
    file.queued.pop_front();
    const std::string& bytes = event.bytes ? *event.bytes : device.picture;
    std::memcpy(file.memory[buffer.index].data(), bytes.data(), bytes.size());
    buffer.bytesused = static_cast<std::uint32_t>(bytes.size());
    buffer.sequence = event.sequence;
    buffer.flags = event.flags;
    buffer.timestamp.tv_sec = event.stamp_us / 1'000'000;
    buffer.timestamp.tv_usec = event.stamp_us % 1'000'000;
    return 0;
  }

  std::mutex mutex_;
  std::map<int, File> files_;
  int next_fd_ = 3;
};

}  // namespace cairn::support
