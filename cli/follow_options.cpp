// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "follow_options.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cairn/core/error.hpp>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <numbers>
#include <set>

#include "source_options.hpp"
#include "terminal.hpp"

namespace cairn::cli {
std::optional<Pose> pose_on_floor(const std::string& text) {
  double x = 0;
  double y = 0;
  double degrees = 0;
  int used = 0;
  const int read = std::sscanf(text.c_str(), "%lf,%lf,%lf%n", &x, &y, &degrees, &used);
  const bool is_near = std::abs(x) <= 1e6 && std::abs(y) <= 1e6 && std::abs(degrees) <= 1e6;
  if (read != 3 || static_cast<std::size_t>(used) != text.size() || !is_near) return std::nullopt;
  Pose pose = rotation_about({0, 0, degrees * std::numbers::pi / 180});
  pose.translation_m = {x, y, 0};
  return pose;
}

std::vector<std::string> SensorInput::given() const {
  std::vector<std::string> names;
  for (const auto& [file, name] : {std::pair{&map, "--map"},
                                   {&odometry, "--odometry"},
                                   {&imu, "--imu"},
                                   {&scan, "--scan"},
                                   {&poses, "--poses"}}) {
    if (!file->empty()) names.emplace_back(name);
  }
  return names;
}

std::pair<std::string, Pose> named_pose(const std::string& text) {
  const std::size_t equals = std::min(text.find('='), text.size());
  const std::optional<Pose> pose = pose_on_floor(text.substr(std::min(equals + 1, text.size())));
  if (!pose) throw Error("--at " + text + ": expected NAME=X,Y,DEG");
  return {text.substr(0, equals), *pose};
}

void add_motion_options(CLI::App& app, std::string& odometry, std::string& imu) {
  app.add_option("--odometry", odometry, "wheel odometry: table of speeds, poses of TUM or KITTI, or a topic")
      ->type_name("FILE|ros2:TOPIC");
  app.add_option("--imu", imu, "gyroscope rates in the form of EuRoC, or a topic (sensor_msgs/Imu)")
      ->type_name("FILE|ros2:TOPIC");
}

void add_sensor_options(CLI::App& app, SensorInput& input) {
  add_motion_options(app, input.odometry, input.imu);
  app.add_option("--poses", input.poses, "known camera poses (TUM), used instead of motion estimation")
      ->type_name("FILE");
  app.add_option("--scan", input.scan,
                 "laser scans to check disparities: a table, or a topic (sensor_msgs/LaserScan)")
      ->type_name("FILE|ros2:TOPIC");
  app.add_option("--map", input.map, "map of landmarks to use and extend; created if absent")
      ->type_name("FILE.db");
  app.add_flag("--read-only", input.map_read_only, "no changes to the map");
  app.add_option("--start", input.start,
                 "start pose in the map, m and degrees counter-clockwise; default: found by landmarks")
      ->type_name("X,Y,DEG");
}

live::SensorFiles sensor_files(const SensorInput& input, const input::Sequence& source) {
  refuse_two_priors(input.odometry, input.imu);
  if (!input.poses.empty() && !(input.odometry.empty() && input.imu.empty()))
    throw Error("--poses: already gives the motion, expected neither --odometry nor --imu");
  if (input.map_read_only && input.map.empty()) throw Error("--read-only: needs --map FILE.db");
  const std::optional<Pose> start = pose_on_floor(input.start);
  if (!start && !input.start.empty())
    throw Error("--start " + input.start + ": expected X,Y,DEGREES, e.g. 0,0,0 for where the map began");
  if (start && input.map.empty()) throw Error("--start: needs --map FILE.db");
  if (const auto names = input.given(); !source.rig() && !names.empty()) {
    throw Error(names.front() + ": needs metres, but " + source.name() +
                " has no calibration with a baseline; give one with --calib");
  }
  const auto named = [](const std::string& file) {
    return file.empty() ? std::nullopt : std::optional<std::filesystem::path>(file);
  };
  return {named(input.odometry),
          named(input.imu),
          named(input.poses),
          named(input.scan),
          named(input.map),
          input.map_read_only,
          start};
}

FollowConfig resolve_follow(const ConfigOptions& options, std::optional<int> calibrated_disparities,
                            KnownGround ground) {
  FollowConfig config;
  std::set<std::string> own;
  const auto elsewhere = [&](std::string_view name, std::string_view value) {
    if (!is_of_following(name)) return false;
    set(config, name, value);
    own.emplace(name);
    return true;
  };
  config.segmentation = resolve(options, calibrated_disparities, elsewhere).config;
  config.segmentation.ground.known = std::move(ground);
  validate(config);
  for (const std::string& name : own) require_active(config, name);
  return config;
}

std::string preset_of(const ConfigOptions& options) {
  return resolve(options, std::nullopt,
                 [](std::string_view name, std::string_view /*value*/) { return is_of_following(name); })
      .preset;
}

std::vector<OptionInfo> sequence_options(const ConfigOptions& config) {
  std::vector<OptionInfo> own;
  for (const OptionInfo& option : options(resolve_follow(config))) {
    if (is_of_following(option.name)) own.push_back(option);
  }
  return own;
}

std::string control_line(const ControlEvent& event) {
  return "steadier setting: " + event.candidate.option + "=" + event.candidate.value +
         (event.is_set ? ", set (was " : " (now ") + event.before + "), by " + percent(event.gain);
}

}  // namespace cairn::cli
