// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/core/error.hpp>

#include <cairn/input/open_ros2.hpp>

namespace cairn::input {

std::unique_ptr<Sequence> open_ros2(const std::string& source, const SourceOptions&, const Pool&) {
  throw Error(source + ": topics of ROS 2 are not built in: they need Cyclone DDS (cyclonedds-dev)");
}

}  // namespace cairn::input
