// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/input/camera/gst_camera.hpp>

/// Linked directly, without a module: sanitizers need one program.
namespace cairn::input {

std::unique_ptr<Camera> open_gst(const GstRequest& request) {
  return make_gst_camera(request);
}

}  // namespace cairn::input
