// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/core/error.hpp>

#include <cairn/live/ros2.hpp>

namespace cairn::live {

std::unique_ptr<Sink> publish_ros2(const Ros2Options&, const std::optional<StereoRig>&) {
  throw Error("--ros2: topics of ROS 2 are not built in: they need Cyclone DDS (cyclonedds-dev)");
}

}  // namespace cairn::live
