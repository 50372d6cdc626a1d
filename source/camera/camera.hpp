// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "../../io/image_files.hpp"
#include "../../tracking/pose.hpp"

/// What a device or a pipeline gives; how it is kept open and what becomes of its images is the same for all.
/// Internal to source.
namespace cairn::io {

struct CameraImage {
  Picture left;       // or the only one
  Image<Gray> right;  // empty where the camera has one image only
  Stamp stamp;        // by the steady clock
  std::chrono::steady_clock::time_point arrived;
  std::uint64_t dropped = 0;  // frames lost since the image before, as far as the camera knows
  bool is_after_gap = false;  // the first one after the camera was lost
};

/// One connection to a camera.
class Camera {
 public:
  Camera() = default;
  virtual ~Camera() = default;
  Camera(const Camera&) = delete;
  Camera& operator=(const Camera&) = delete;

  /// The next image; none within the time. Throws Error where the connection is lost: why, in one line.
  virtual std::optional<CameraImage> next(std::chrono::milliseconds timeout) = 0;
  /// It will give no further image, and has lost nothing.
  [[nodiscard]] virtual bool has_ended() const { return false; }
  /// What is to be said of how it was opened: "fps: found 25, asked for 30".
  [[nodiscard]] virtual std::vector<std::string> notes() const { return {}; }
};

/// Opens the camera, for the first time or once more. Throws Error: why it cannot, in one line.
using CameraMaker = std::function<std::unique_ptr<Camera>()>;

}  // namespace cairn::io
