// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/input/camera/v4l2_ops.hpp>

#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>

namespace cairn::input {
namespace {

class System : public V4l2Ops {
 public:
  int open(const char* path) override { return ::open(path, O_RDWR | O_NONBLOCK | O_CLOEXEC); }
  int close(int fd) override { return ::close(fd); }
  int ioctl(int fd, unsigned long request, void* argument) override {
    int result = 0;
    do {
      result = ::ioctl(fd, request, argument);
    } while (result < 0 && errno == EINTR);
    return result;
  }
  void* map(int fd, std::size_t bytes, std::int64_t offset) override {
    void* start = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, fd, static_cast<off_t>(offset));
    return start == MAP_FAILED ? nullptr : start;
  }
  int unmap(void* start, std::size_t bytes) override { return ::munmap(start, bytes); }
  int poll(int fd, int timeout_ms) override {
    pollfd waits{fd, POLLIN, 0};
    return ::poll(&waits, 1, timeout_ms);
  }
};

}  // namespace

V4l2Ops& system_v4l2() {
  static System system;
  return system;
}

}  // namespace cairn::input
