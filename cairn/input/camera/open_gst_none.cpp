// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/core/error.hpp>

#include <cairn/input/camera/gst_camera.hpp>

namespace cairn::input {

std::unique_ptr<Camera> open_gst(const GstRequest&) {
  throw Error(
      "pipelines are not built in: they need GStreamer (libgstreamer1.0-dev "
      "libgstreamer-plugins-base1.0-dev); v4l2:/dev/video0 can be read");
}

}  // namespace cairn::input
