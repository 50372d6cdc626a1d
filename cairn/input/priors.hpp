// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <cairn/sequence/odometry.hpp>
#include <cairn/sequence/pose.hpp>

#include <cairn/input/sequence.hpp>

/// Camera motion from other sensors, read from files. (docs/sequences.md, "Priors")
namespace cairn::input {

/// A file of odometry or of an IMU, as the motion between any two times that it covers.
class MotionPriors {
 public:
  virtual ~MotionPriors() = default;
  MotionPriors(const MotionPriors&) = delete;
  MotionPriors& operator=(const MotionPriors&) = delete;

  /// The camera motion from `before` to `now`. nullopt if the file does not cover both, has a gap of more
  /// than 0.2 s between them, or contains invalid or implausible numbers there. `camera_from_level`: the
  /// rotation from a level camera (x right, y down along gravity, z forward) to the real one; wheels move in
  /// the level plane. For a camera that looks down by 12 degrees, assuming a level one makes the prior wrong
  /// by a fifth of the path.
  [[nodiscard]] virtual std::optional<MotionPrior> between(Stamp before, Stamp now,
                                                           const Pose& camera_from_level = {}) const = 0;
  [[nodiscard]] virtual PriorKind kind() const = 0;
  /// The time range of the file.
  [[nodiscard]] virtual Stamp first() const = 0;
  [[nodiscard]] virtual Stamp last() const = 0;
  /// Contents and assumptions, in one line: "speeds of wheels, 100 rows at 5 Hz".
  [[nodiscard]] virtual std::string description() const = 0;

 protected:
  MotionPriors() = default;
};

/// Poses in time, stamps ascending: of the camera or, if is_of_robot, of a level camera at the centre of a robot.
struct PoseRows {
  std::vector<Stamp> stamps;
  std::vector<Pose> world_from_camera;
  bool is_of_robot = false;
};
/// The pose of a level camera at the centre of a robot (x forward, y left, z up).
Pose level_camera_of(const Pose& world_from_robot);

/// What a gyroscope measured, about its own axes, stamps ascending. `accelerations_m_s2` may be empty.
struct GyroscopeRows {
  std::vector<Stamp> stamps;
  std::vector<std::array<double, 3>> rates_rad_s;
  std::vector<std::array<double, 3>> accelerations_m_s2;
};
/// Its bias: the mean rate of the first half second, if rates and accelerations are steady then.
std::optional<std::array<double, 3>> bias_at_rest(const GyroscopeRows& rows);

/// The priors of at least two rows.
std::unique_ptr<MotionPriors> priors_of(PoseRows rows);
std::unique_ptr<MotionPriors> priors_of(GyroscopeRows rows, const std::optional<std::array<double, 3>>& bias,
                                        const Pose& camera_from_imu);
/// Throws Error naming `source` if there are fewer than two rows, stamps do not ascend, or most numbers are too large
/// to be in m and rad/s.
void check_rows(const PoseRows& rows, const std::string& source);
void check_rows(const GyroscopeRows& rows, const std::string& source);

/// The rotation camera_from_level of a camera that is pitched down by `pitch_deg` and rolled to the right by
/// `roll_deg`; see KnownGround.
Pose camera_from_level(double pitch_deg, double roll_deg);

/// Reads odometry, its form recognised by content: a table with the columns t_s, v_m_per_s, omega_rad_per_s
/// (forward speed and counter-clockwise turn rate, each the mean since the row before); TUM lines `t x y z qx
/// qy qz qw`; KITTI lines of 12 numbers, which need stamps: times.txt or stamps.txt next to the file or in
/// `source_folder`. Poses are those of the left rectified camera (x right, y down, z forward), or, if the
/// file name or a comment in it contains base_link or base_footprint, of a robot (x forward, y left, z up)
/// with the camera at its centre. Throws Error (file, line, what was found): unknown form, stamps that do not
/// ascend or are in another unit, speeds above 20 m/s (60 m/s between poses), which are mm, rates above 20
/// rad/s, which are degrees.
std::unique_ptr<MotionPriors> load_odometry(const std::filesystem::path& path,
                                            const std::filesystem::path& source_folder = {});

/// Reads the gyroscope of an IMU from a table in the form of EuRoC: ns, three rates in rad/s about its axes,
/// and accelerations, which are ignored. `camera_from_imu`: the rotation from its axes to the rectified left
/// camera. If it is at rest in the first half second, the mean is subtracted as its bias. Throws Error like
/// load_odometry().
std::unique_ptr<MotionPriors> load_imu(const std::filesystem::path& path, const Pose& camera_from_imu = {});

/// The mounting of an IMU, from the sensor.yaml next to its file and that of cam0 (EuRoC), and the
/// rectification of that camera; nullopt if absent: the axes are then assumed to be those of the camera.
/// Throws Error.
std::optional<Pose> mounting_of_imu(const std::filesystem::path& path, const io::Rectifier* rectifier);

}  // namespace cairn::input
