// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include <cairn/input/camera/camera.hpp>

namespace cairn::input {

/// The time limits after which a camera counts as lost, and the delay before it is opened again.
struct CameraTimes {
  std::chrono::milliseconds first_image{10000};   // after it was opened again; RTSP tries UDP for 5 s
  std::chrono::milliseconds silence{3000};        // between images
  std::chrono::milliseconds first_back_off{500};  // doubled with each attempt
  std::chrono::milliseconds most_back_off{8000};
};

/// Keeps a camera open on its own thread: passes its images to `take`, and reopens it after a loss until it
/// is back.
class KeptCamera {
 public:
  /// Called on the thread of the camera; must return soon.
  using Take = std::function<void(CameraImage&&)>;

  KeptCamera(CameraMaker make, CameraTimes times, Take take);
  /// Joins the thread, which the operating system may block while it opens or closes a device.
  ~KeptCamera();
  KeptCamera(const KeptCamera&) = delete;
  KeptCamera& operator=(const KeptCamera&) = delete;

  /// Stops the delivery of images. From any thread, and from a signal handler.
  void stop() noexcept { is_stopped_ = true; }

  struct State {
    bool is_connected = false;
    bool has_failed = false;  // never delivered an image; `trouble` has the reason
    bool has_ended = false;
    std::uint64_t dropped = 0;
    std::uint64_t reconnects = 0;
    std::string trouble;
    std::vector<std::string> notes;
  };
  [[nodiscard]] State state() const;

 private:
  void work();
  void note_opening(const Camera& camera);
  /// Reads until the camera is lost (throws Error) or ends.
  void read(Camera& camera);
  void wait(std::chrono::milliseconds time) const;

  CameraMaker make_;
  CameraTimes times_;
  Take take_;
  std::atomic<bool> is_stopped_ = false;
  std::chrono::milliseconds back_off_;
  Size size_;  // of the images; 0 before the first
  mutable std::mutex mutex_;
  State state_;
  std::thread thread_;
};

}  // namespace cairn::input
