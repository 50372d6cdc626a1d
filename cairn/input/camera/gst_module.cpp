// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/input/camera/gst_camera.hpp>
#include <cairn/io/load_module.hpp>

extern "C" {

__attribute__((visibility("default"))) const char* cairn_module_version() {
  return CAIRN_VERSION;
}

__attribute__((visibility("default"))) cairn::input::Camera* cairn_open_gst(
    const cairn::input::GstRequest& request) {
  return cairn::input::make_gst_camera(request).release();
}

}  // extern "C"
