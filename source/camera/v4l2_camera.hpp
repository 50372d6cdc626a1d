// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <memory>
#include <string>

#include "camera.hpp"
#include "frame_bytes.hpp"
#include "v4l2_ops.hpp"

namespace cairn::io {

/// What a device is asked for; 0 and empty: what it has.
struct V4l2Request {
  std::string device;
  Size size;
  double fps = 0;
  std::string format;  // YUYV, GREY, MJPG or Y8I
  // How the two images lie in a frame; one: the device has a single image. Of Y8I it does not count: both
  // lie in every frame.
  Layout layout = Layout::side_by_side;
  bool with_colour = true;  // of the left image
};

/// A device by the kernel's V4L2, with frames in memory that both share. Throws Error where it cannot be
/// opened as asked for; `ops` must outlive it.
std::unique_ptr<Camera> open_v4l2(const V4l2Request& request, V4l2Ops& ops, const Pool& pool);

}  // namespace cairn::io
