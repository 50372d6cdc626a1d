// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cstddef>
#include <cstdint>

namespace cairn::input {

/// The system calls of V4L2, replaceable in tests. Like the calls of these names: -1 and errno on failure.
class V4l2Ops {
 public:
  V4l2Ops() = default;
  virtual ~V4l2Ops() = default;
  V4l2Ops(const V4l2Ops&) = delete;
  V4l2Ops& operator=(const V4l2Ops&) = delete;

  virtual int open(const char* path) = 0;
  virtual int close(int fd) = 0;
  virtual int ioctl(int fd, unsigned long request, void* argument) = 0;
  /// Null on failure.
  virtual void* map(int fd, std::size_t bytes, std::int64_t offset) = 0;
  virtual int unmap(void* start, std::size_t bytes) = 0;
  /// 1: a frame or an error is available; 0: timeout.
  virtual int poll(int fd, int timeout_ms) = 0;
};

/// The operating system.
V4l2Ops& system_v4l2();

}  // namespace cairn::input
