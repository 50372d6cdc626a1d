// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "../ros/from_step.hpp"
#include "live_frame.hpp"

/// What is found in every frame, on topics of ROS 2 (docs/ros2.md), by a module that has Cyclone DDS (dds/).
namespace cairn::live {

struct Ros2Options {
  std::string name_space = "cairn";  // of the topics: /cairn/objects and so on
  ros::FrameNames frames;
  bool marks_holes_as_ros = false;  // min_disparity − 1 instead of NaN
};

/// Opens sockets, and publishes on a thread of its own what somebody listens to: who is slow skips frames.
/// `rig`: the source's. Throws Error where that cannot be, also where Cyclone DDS is not built in.
std::unique_ptr<Sink> publish_ros2(const Ros2Options& options, const std::optional<StereoRig>& rig);

}  // namespace cairn::live
