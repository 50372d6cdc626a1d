// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <memory>
#include <string>

#include "sequence.hpp"

/// Cameras that publish on ROS 2's topics, by a module that has Cyclone DDS (dds/); built without it
/// (CAIRN_DDS=OFF) it throws an Error that says so. Internal to source.
namespace cairn::io {

/// "ros2:/stereo": the topics /stereo/left/image_rect and so on.
std::unique_ptr<Sequence> open_ros2(const std::string& source, const SourceOptions& options,
                                    const Pool& pool);

}  // namespace cairn::io
