// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/live/sequence_run.hpp>
#include <cairn/sequence/follow_config.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common.hpp"

namespace CLI {
class App;
}

namespace cairn::cli {

/// Like resolve(), with the options of a sequence, which may be in the same file and in --set.
FollowConfig resolve_follow(const ConfigOptions& options,
                            std::optional<int> calibrated_disparities = std::nullopt,
                            KnownGround ground = {});
/// Of "X,Y,DEGREES": metres, counterclockwise. nullopt if it is something else, or beyond 1e6.
std::optional<Pose> pose_on_floor(const std::string& text);
/// "NAME=X,Y,DEG" of --at. Throws Error.
std::pair<std::string, Pose> named_pose(const std::string& text);

/// Files of other sensors, and the map.
struct SensorInput {
  std::string odometry;
  std::string imu;
  std::string poses;
  std::string scan;
  std::string map;
  bool map_read_only = false;
  std::string start;

  /// The given ones that need metres: option names.
  [[nodiscard]] std::vector<std::string> given() const;
};
/// --odometry and --imu.
void add_motion_options(CLI::App& app, std::string& odometry, std::string& imu);
void add_sensor_options(CLI::App& app, SensorInput& input);
/// Throws Error for options that exclude each other, or do not suit the source.
live::SensorFiles sensor_files(const SensorInput& input, const input::Sequence& source);

/// The base preset.
std::string preset_of(const ConfigOptions& options);
/// What the search for better options found, in words.
std::string control_line(const ControlEvent& event);

}  // namespace cairn::cli
