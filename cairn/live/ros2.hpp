// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <memory>
#include <optional>
#include <string>

#include <cairn/live/live_frame.hpp>
#include <cairn/ros/from_step.hpp>

/// The results of every frame on ROS 2 topics (docs/ros2.md), through a module with Cyclone DDS (dds/).
namespace cairn::live {

struct Ros2Options {
  std::string name_space = "cairn";  // of the topics: /cairn/objects and so on
  std::string camera_frame;          // frame_id; empty: the source's, else cairn_camera
  bool marks_holes_as_ros = false;   // min_disparity − 1 instead of NaN
};

/// Opens sockets, and publishes topics with subscribers on its own thread; slow subscribers skip frames.
/// `rig`: of the source. Throws Error on failure, also in a build without Cyclone DDS.
std::unique_ptr<Sink> publish_ros2(const Ros2Options& options, const std::optional<StereoRig>& rig);

}  // namespace cairn::live
