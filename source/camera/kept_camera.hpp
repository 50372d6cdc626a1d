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

#include "camera.hpp"

namespace cairn::io {

/// How long things may take before a camera counts as lost, and how soon it is opened again.
struct CameraTimes {
  std::chrono::milliseconds first_image{10000};   // after it was opened again; RTSP tries UDP for 5 s
  std::chrono::milliseconds silence{3000};        // between images
  std::chrono::milliseconds first_back_off{500};  // doubled with each attempt
  std::chrono::milliseconds most_back_off{8000};
};

/// Keeps a camera open on a thread of its own: its images go to `take`, and where it is lost it is opened
/// again until it is back.
class KeptCamera {
 public:
  /// On the camera's thread; must return soon.
  using Take = std::function<void(CameraImage&&)>;

  KeptCamera(CameraMaker make, CameraTimes times, Take take);
  /// Waits for the thread, which the operating system may hold while it opens or closes a device.
  ~KeptCamera();
  KeptCamera(const KeptCamera&) = delete;
  KeptCamera& operator=(const KeptCamera&) = delete;

  /// No image comes from now on. From any thread, and from a signal handler.
  void stop() noexcept { is_stopped_ = true; }

  struct State {
    bool is_connected = false;
    bool has_failed = false;  // has never given an image: `trouble` says why
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
  /// Until the camera is lost (throws Error) or ends.
  void read(Camera& camera);
  void wait(std::chrono::milliseconds time) const;

  CameraMaker make_;
  CameraTimes times_;
  Take take_;
  std::atomic<bool> is_stopped_ = false;
  std::chrono::milliseconds back_off_;
  Size size_;  // of its images; 0 before the first
  mutable std::mutex mutex_;
  State state_;
  std::thread thread_;
};

}  // namespace cairn::io
