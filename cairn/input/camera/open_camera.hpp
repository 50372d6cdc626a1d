// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <cairn/input/camera/kept_camera.hpp>
#include <cairn/input/camera/v4l2_camera.hpp>
#include <cairn/input/sequence.hpp>

/// Camera sources by name. (docs/cameras.md) Internal to source.
namespace cairn::input {

/// "v4l2:", "gst:", "rtsp://" and "rtsps://".
bool is_camera(std::string_view source);
/// Throws Error.
std::unique_ptr<Sequence> open_camera(const std::string& source, const SourceOptions& options,
                                      const Pool& pool);

// Parts of open_camera(), for tests:

/// "v4l2:/dev/video0,w=2560,h=720": one request, or one for each of two devices. Throws Error.
std::vector<V4l2Request> parse_v4l2(const std::string& source, const SourceOptions& options);
std::unique_ptr<Sequence> open_v4l2_sequence(const std::string& source, const SourceOptions& options,
                                             const Pool& pool, V4l2Ops& ops, CameraTimes times = {});

}  // namespace cairn::input
