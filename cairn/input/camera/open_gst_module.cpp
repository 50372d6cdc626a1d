// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/input/camera/gst_camera.hpp>
#include <cairn/io/load_module.hpp>

/// Loads GStreamer with the first pipeline, so that other commands do not pay for it.
namespace cairn::input {

std::unique_ptr<Camera> open_gst(const GstRequest& request) {
  const auto entry = reinterpret_cast<GstEntry>(io::module_entry(
      {"cairn-gstreamer.so", kGstEntry, "they need", "GStreamer (libgstreamer-plugins-base1.0-0)",
       "package cairn-gstreamer; it is built where libgstreamer-plugins-base1.0-dev is"},
      "pipelines"));
  return std::unique_ptr<Camera>(entry(request));
}

}  // namespace cairn::input
