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

#include <cairn/io/image_files.hpp>
#include <cairn/sequence/pose.hpp>

/// The interface to a device or a pipeline; reconnection and image handling are common to all. Internal to
/// source.
namespace cairn::input {

struct CameraImage {
  io::LoadedImage left;  // or the only image
  Image<Gray> right;     // empty for a camera with one image only
  Stamp stamp;           // by the steady clock
  std::chrono::steady_clock::time_point arrived;
  std::uint64_t dropped = 0;  // frames lost since the image before, if the camera reports them
  bool is_after_gap = false;  // the first image after the camera was lost
};

/// One connection to a camera.
class Camera {
 public:
  Camera() = default;
  virtual ~Camera() = default;
  Camera(const Camera&) = delete;
  Camera& operator=(const Camera&) = delete;

  /// The next image; nullopt after the timeout. Throws Error with the reason, in one line, if the connection
  /// is lost.
  virtual std::optional<CameraImage> next(std::chrono::milliseconds timeout) = 0;
  /// Whether the source has ended regularly, without further images.
  [[nodiscard]] virtual bool has_ended() const { return false; }
  /// Remarks on the settings in effect: "fps: found 25, expected 30".
  [[nodiscard]] virtual std::vector<std::string> notes() const { return {}; }
};

/// Opens the camera, also again after a loss. Throws Error with the reason, in one line.
using CameraMaker = std::function<std::unique_ptr<Camera>()>;

}  // namespace cairn::input
