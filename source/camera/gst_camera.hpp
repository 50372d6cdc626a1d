// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <memory>
#include <string>

#include "camera.hpp"
#include "frame_bytes.hpp"

/// Pipelines of GStreamer, by a module (camera/gst_module.cpp). Internal to source.
namespace cairn::io {

struct GstRequest {
  std::string pipeline;  // as gst-launch-1.0 takes it, without the sink
  std::string location;  // of its element "cairn_source"; empty: it has none
  Layout layout = Layout::side_by_side;
  bool with_colour = true;    // of the left image
  bool must_not_end = false;  // its end is a loss
  Pool pool;
};

/// Throws Error where the pipeline cannot be made or started. Built without GStreamer, by the one that says
/// so.
std::unique_ptr<Camera> open_gst(const GstRequest& request);
/// The same in this very program or module.
std::unique_ptr<Camera> make_gst_camera(const GstRequest& request);

inline constexpr const char* kGstEntry = "cairn_open_gst";
/// The module's function of that name: the caller owns what it returns. Throws Error.
using GstEntry = Camera* (*)(const GstRequest&);

}  // namespace cairn::io
