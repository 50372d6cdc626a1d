// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <cairn/input/laser_scans.hpp>
#include <cairn/input/priors.hpp>
#include <cairn/ros/messages.hpp>

/// Other sensors as ROS messages: wheels, gyroscope and laser, from recordings and from topics. (docs/ros2.md, "Other
/// sensors")
namespace cairn::input {

/// The names of topics; empty: not used. At most one of odometry and imu.
struct SensorTopicNames {
  std::string odometry;  // nav_msgs/msg/Odometry
  std::string imu;       // sensor_msgs/msg/Imu
  std::string scan;      // sensor_msgs/msg/LaserScan
  [[nodiscard]] bool any() const { return !odometry.empty() || !imu.empty() || !scan.empty(); }
};

/// The topic in "ros2:/odom", the value of an option that may also name a file; nullopt for a file.
std::optional<std::string> topic_in(const std::string& option);

/// The transforms of /tf_static, a tree of frames.
class StaticTransforms {
 public:
  void add(const ros::TFMessage& message);
  /// Maps points of `source` to `target`; nullopt if they are not connected.
  [[nodiscard]] std::optional<Pose> between(const std::string& target, const std::string& source) const;

 private:
  struct Link {
    std::string parent;
    Pose parent_from_child;
  };
  /// The frame itself, and its ancestors, with the poses of the frame in them.
  [[nodiscard]] std::vector<std::pair<std::string, Pose>> ancestors(const std::string& frame) const;
  std::map<std::string, Link> by_child_;
};

/// Collects the messages of other sensors, and says what a run needs of them: the same for a whole recording as for
/// topics. Without a transform from a sensor to the camera, wheels move a robot with a level camera at its centre, the
/// axes of a gyroscope are those of the camera, and a laser is at the camera.
class SensorTopics {
 public:
  /// `camera`: the frame_id of the left images; empty: cairn_camera.
  explicit SensorTopics(std::string camera);

  // A message that is not later than the one before is ignored, unless the clock was set back, see clock_step().
  void add(const ros::Odometry& message);
  void add(const ros::Imu& message);
  void add(const ros::LaserScan& message);
  void add(const ros::TFMessage& message);
  /// Counts a message that could not be decoded.
  void add_damaged() { ++damaged_; }
  /// For topics: drops what is more than 10 s older than the newest message.
  void forget_old();

  /// The newest stamps so far.
  [[nodiscard]] std::optional<Stamp> newest_motion() const;
  [[nodiscard]] std::optional<Stamp> newest_scan() const;

  /// Null with fewer than two messages.
  [[nodiscard]] std::unique_ptr<MotionPriors> priors() const;
  [[nodiscard]] std::vector<LaserScan> scans() const;
  /// Like input::scan_at() of these; converts only that one.
  [[nodiscard]] std::optional<LaserScan> scan_at(Stamp moment) const;
  /// Throws Error like load_odometry() and load_imu() for numbers in other units, and without messages. The names are
  /// for messages; empty ones are not checked.
  void check(const SensorTopicNames& names) const;
  /// What is assumed about the sensors that have no transform to the camera, and what was left out, one line each.
  [[nodiscard]] std::vector<std::string> assumptions() const;

 private:
  struct RobotPose {
    Stamp stamp;
    Pose world_from_robot;
  };
  [[nodiscard]] std::optional<Pose> camera_from(const std::string& frame) const;
  [[nodiscard]] PoseRows pose_rows() const;

  std::string camera_;
  StaticTransforms transforms_;
  std::vector<RobotPose> poses_;
  std::string robot_frame_;
  GyroscopeRows rates_;
  std::string imu_frame_;
  std::optional<std::array<double, 3>> bias_;
  bool has_judged_bias_ = false;
  std::vector<ros::LaserScan> scans_;
  int set_back_ = 0;
  int damaged_ = 0;
};

/// The scan as seen by a level camera with the heading of the real one. `camera_from_laser`: nullopt if unknown.
LaserScan scan_of(const ros::LaserScan& message, const std::optional<Pose>& camera_from_laser);

/// All messages on these topics of a recording, with its /tf_static. Throws Error: no such topic, of another type,
/// without sound messages, in other units.
SensorTopics read_sensor_topics(const std::filesystem::path& recording, const SensorTopicNames& names,
                                const std::string& camera);

/// Topics of other sensors while they arrive.
class LiveSensors {
 public:
  virtual ~LiveSensors() = default;
  LiveSensors(const LiveSensors&) = delete;
  LiveSensors& operator=(const LiveSensors&) = delete;
  /// Like MotionPriors::between(); waits for up to 50 ms for what was measured up to `now`.
  virtual std::optional<MotionPrior> between(Stamp before, Stamp now, const Pose& camera_from_level) = 0;
  /// Like scan_at(), among the scans that have arrived; waits for up to 50 ms if none of them is near.
  virtual std::optional<LaserScan> scan_at(Stamp moment) = 0;
  /// See SensorTopics::assumptions().
  [[nodiscard]] virtual std::vector<std::string> assumptions() const = 0;

 protected:
  LiveSensors() = default;
};

}  // namespace cairn::input
