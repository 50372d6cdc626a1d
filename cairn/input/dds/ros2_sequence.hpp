// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <memory>
#include <string>

#include <cairn/input/sequence.hpp>

namespace cairn::input {

/// "ros2:/stereo": /stereo/left/image_rect and /stereo/right/image_rect, with the rig of
/// /stereo/left/camera_info and /stereo/right/camera_info unless options.calib is given; with options.rectify
/// the topics are image_raw. options.topics names other topics, below the name unless they begin with a slash:
/// left and right images, or an image and its depth; the second one is a DisparityImage if it is named
/// disparity. Waits for the first pair. Throws Error if none arrives within options.open_timeout_s.
std::unique_ptr<Sequence> ros2_sequence(const std::string& source, const SourceOptions& options,
                                        const Pool& pool);

}  // namespace cairn::input
