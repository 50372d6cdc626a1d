// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/input/open_parts.hpp>
#include <cairn/live/ros2.hpp>

/// The entry of the part for ROS 2 topics; the caller owns the result.
extern "C" CAIRN_EXPORT cairn::live::Sink* cairn_publish_ros2(const cairn::live::Ros2Options& options,
                                                              const std::optional<cairn::StereoRig>& rig);
