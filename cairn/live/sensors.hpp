// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <cairn/input/laser_scans.hpp>
#include <cairn/input/priors.hpp>
#include <cairn/input/sensor_topics.hpp>
#include <cairn/input/sequence.hpp>

namespace cairn::live {

/// Data files of other sensors for a sequence. At most one of odometry, imu and poses; all are in metres, so
/// the source needs a rig. Odometry, imu and scan may also be topics of ROS 2, "ros2:/odom": of the recording if the
/// source is one, else live.
struct SensorFiles {
  std::optional<std::filesystem::path> odometry;
  std::optional<std::filesystem::path> imu;
  std::optional<std::filesystem::path> poses;
  std::optional<std::filesystem::path> scan;
  std::optional<std::filesystem::path> map;
  bool is_map_read_only = false;
  std::optional<Pose> start;  // in the map; nullopt: to be found by landmarks
};

/// The motion and the laser scans that other sensors measured: from files, from topics of the recording that the source
/// is, or from topics while they arrive with a live source.
class Sensors {
 public:
  /// Of odometry, imu and scan. `source_name`: the argument of open_sequence(). Throws Error like load_odometry(),
  /// load_imu(), load_scans() and read_sensor_topics(), and for topics of a source that cannot have them.
  Sensors(const SensorFiles& files, const std::string& source_name, const input::Sequence& source);

  /// Like MotionPriors::between().
  [[nodiscard]] std::optional<MotionPrior> between(Stamp before, Stamp now,
                                                   const Pose& camera_from_level) const;
  /// The scan nearest to a moment, see input::scan_at(); valid until the next call.
  [[nodiscard]] const LaserScan* scan_at(Stamp moment);
  /// What is assumed about sensors on topics that have no transform to the camera, one line each. Those of a live source
  /// follow from what has arrived.
  [[nodiscard]] std::vector<std::string> assumptions() const;
  /// What measures the motion, like MotionPriors::description(); empty if nothing does.
  [[nodiscard]] const std::string& description() const { return description_; }

 private:
  std::unique_ptr<input::MotionPriors> priors_;
  std::vector<LaserScan> scans_;
  std::unique_ptr<input::LiveSensors> live_;
  std::optional<LaserScan> live_scan_;
  std::vector<std::string> assumptions_;  // of a recording
  std::string description_;
};

}  // namespace cairn::live
