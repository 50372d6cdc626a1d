// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "live_ros2.hpp"

#include <CLI/CLI.hpp>
#include <cairn/core/error.hpp>
#include <cairn/live/ros2.hpp>

namespace cairn::cli {

void add_ros2_options(CLI::App& app, Ros2CommandOptions& options) {
  options.is_wanted =
      app.add_option("--ros2", options.name_space, "namespace of published ROS 2 topics (default: cairn)")
          ->type_name("[NAME]")
          ->expected(0, 1);
  app.add_option("--ros2-frame", options.frame,
                 "frame_id of the left camera (default: that of the source, else cairn_camera)")
      ->type_name("NAME");
  app.add_option("--ros2-holes", options.holes, "value of holes: nan (default) or ros (min_disparity - 1)")
      ->type_name("NAME");
}

std::unique_ptr<live::Sink> make_ros2_sink(const Ros2CommandOptions& options, const input::Sequence& source) {
  if (options.is_wanted->count() == 0) {
    if (!options.frame.empty()) throw Error("--ros2-frame: needs --ros2");
    if (!options.holes.empty()) throw Error("--ros2-holes: needs --ros2");
    return nullptr;
  }
  if (!options.holes.empty() && options.holes != "nan" && options.holes != "ros")
    throw Error("--ros2-holes: found " + options.holes + ", expected nan or ros");
  live::Ros2Options how;
  if (!options.name_space.empty()) how.name_space = options.name_space;
  how.camera_frame = options.frame;
  how.marks_holes_as_ros = options.holes == "ros";
  return live::publish_ros2(how, source.rig());
}

}  // namespace cairn::cli
