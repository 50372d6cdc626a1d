// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/live/dds/ros2_sink.hpp>
#include <cairn/live/ros2.hpp>

/// Linked directly, without a module: sanitizers need one program.
namespace cairn::live {

std::unique_ptr<Sink> publish_ros2(const Ros2Options& options, const std::optional<StereoRig>& rig) {
  return ros2_sink(options, rig);
}

}  // namespace cairn::live
