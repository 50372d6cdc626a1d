// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <memory>
#include <optional>

#include <cairn/live/ros2.hpp>

namespace cairn::live {

/// Like publish_ros2().
std::unique_ptr<Sink> ros2_sink(const Ros2Options& options, const std::optional<StereoRig>& rig);

}  // namespace cairn::live
