// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <memory>
#include <string>

#include <cairn/input/camera/camera.hpp>
#include <cairn/input/camera/frame_bytes.hpp>
#include <cairn/input/camera/v4l2_ops.hpp>

namespace cairn::input {

/// The settings requested of a device; 0 or empty: its own.
struct V4l2Request {
  std::string device;
  Size size;
  double fps = 0;
  std::string format;  // YUYV, GREY, MJPG or Y8I
  // The arrangement of the two images in a frame; one: the device has a single image. Ignored for Y8I, which
  // has both in every frame.
  Layout layout = Layout::side_by_side;
  bool with_colour = true;  // of the left image
};

/// A V4L2 device with memory-mapped buffers. Throws Error if it cannot be opened with these settings; `ops`
/// must outlive it.
std::unique_ptr<Camera> open_v4l2(const V4l2Request& request, V4l2Ops& ops, const Pool& pool);

}  // namespace cairn::input
