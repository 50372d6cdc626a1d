// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cstddef>
#include <cstdint>

namespace cairn::io {

/// What the kernel does for us, so that tests can do it instead. As the system calls of these names: -1 and
/// errno where they fail.
class V4l2Ops {
 public:
  V4l2Ops() = default;
  virtual ~V4l2Ops() = default;
  V4l2Ops(const V4l2Ops&) = delete;
  V4l2Ops& operator=(const V4l2Ops&) = delete;

  virtual int open(const char* path) = 0;
  virtual int close(int fd) = 0;
  virtual int ioctl(int fd, unsigned long request, void* argument) = 0;
  /// Null where it fails.
  virtual void* map(int fd, std::size_t bytes, std::int64_t offset) = 0;
  virtual int unmap(void* start, std::size_t bytes) = 0;
  /// 1: there is a frame or an error to be fetched; 0: the time is over.
  virtual int poll(int fd, int timeout_ms) = 0;
};

/// The kernel itself.
V4l2Ops& system_v4l2();

}  // namespace cairn::io
