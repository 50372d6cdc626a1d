// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/input/dds/module.hpp>
#include <cairn/live/ros2.hpp>

namespace cairn::live {

inline constexpr const char* kRos2SinkEntry = "cairn_publish_ros2";
/// The function of that name: the caller owns the result. Throws Error.
using Ros2SinkEntry = Sink* (*)(const Ros2Options&, const std::optional<StereoRig>&);

}  // namespace cairn::live
