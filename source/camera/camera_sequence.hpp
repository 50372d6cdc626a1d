// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "../sequence.hpp"
#include "camera.hpp"
#include "kept_camera.hpp"

namespace cairn::io {

/// What a source of cameras is called.
struct CameraNames {
  std::string source;  // for messages: "v4l2:/dev/video0"
  std::string name;    // Sequence::name(): "video0"
  std::string stamps_from;
};

/// One camera that gives both images, or a left and a right one, as a sequence: the newest pair is delivered.
/// Throws Error where they cannot be opened, or no pair comes within options.open_timeout_s.
std::unique_ptr<Sequence> camera_sequence(CameraNames names, std::vector<CameraMaker> cameras,
                                          const SourceOptions& options, const Pool& pool,
                                          CameraTimes times = {});

}  // namespace cairn::io
