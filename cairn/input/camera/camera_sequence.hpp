// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <cairn/input/camera/camera.hpp>
#include <cairn/input/camera/kept_camera.hpp>
#include <cairn/input/sequence.hpp>

namespace cairn::input {

/// The names of a camera source.
struct CameraNames {
  std::string source;  // for messages: "v4l2:/dev/video0"
  std::string name;    // Sequence::name(): "video0"
  std::string stamps_from;
};

/// One camera with both images, or a left and a right camera, as a sequence: delivers the newest pair. Throws
/// Error if they cannot be opened, or no pair arrives within options.open_timeout_s.
std::unique_ptr<Sequence> camera_sequence(CameraNames names, std::vector<CameraMaker> cameras,
                                          const SourceOptions& options, const Pool& pool,
                                          CameraTimes times = {});

}  // namespace cairn::input
