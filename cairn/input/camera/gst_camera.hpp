// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <memory>
#include <string>

#include <cairn/input/camera/camera.hpp>
#include <cairn/input/camera/frame_bytes.hpp>
#include <cairn/io/load_module.hpp>

/// GStreamer pipelines, a part of its own (io/load_module.hpp). Internal to source.
namespace cairn::input {

struct GstRequest {
  std::string pipeline;  // for gst-launch-1.0, without the sink
  std::string location;  // of the element "cairn_source"; empty if there is none
  Layout layout = Layout::side_by_side;
  bool with_colour = true;    // of the left image
  bool must_not_end = false;  // its end counts as a loss
  Pool pool;
};

/// Throws Error if the pipeline cannot be created or started, or in a build without GStreamer.
std::unique_ptr<Camera> open_gst(const GstRequest& request);

}  // namespace cairn::input

/// The entry of the part; the caller owns the result.
extern "C" CAIRN_EXPORT cairn::input::Camera* cairn_open_gst(const cairn::input::GstRequest& request);
