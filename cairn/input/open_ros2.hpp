// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <memory>
#include <string>

#include <cairn/input/sequence.hpp>

/// Cameras on ROS 2 topics, through a module with Cyclone DDS (dds/); a build without it (CAIRN_DDS=OFF)
/// throws Error. Internal to source.
namespace cairn::input {

/// "ros2:/stereo": the topics /stereo/left/image_rect and so on.
std::unique_ptr<Sequence> open_ros2(const std::string& source, const SourceOptions& options,
                                    const Pool& pool);

}  // namespace cairn::input
