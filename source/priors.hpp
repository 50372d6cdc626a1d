// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "../tracking/odometry.hpp"
#include "../tracking/pose.hpp"

#include "sequence.hpp"

/// What other sensors say of the camera's motion, read from files. (docs/sequences.md, "Priors")
namespace cairn::io {

/// A file of odometry or of an IMU, as motions between any two moments that it covers.
class MotionPriors {
 public:
  virtual ~MotionPriors() = default;
  MotionPriors(const MotionPriors&) = delete;
  MotionPriors& operator=(const MotionPriors&) = delete;

  /// The camera's motion from `before` to `now`. None where the file does not cover both, has a gap of more
  /// than 0.2 s between them, or holds numbers there that are none or cannot be. `camera_from_level`: the
  /// rotation from a camera that looks level (x right, y down along gravity, z forward) to the real one;
  /// wheels move in the former's plane. A camera that looks down by 12 degrees and is taken for level has a
  /// prior that is wrong by a fifth of the way.
  [[nodiscard]] virtual std::optional<MotionPrior> between(Stamp before, Stamp now,
                                                           const Pose& camera_from_level = {}) const = 0;
  [[nodiscard]] virtual PriorKind kind() const = 0;
  /// What the file covers.
  [[nodiscard]] virtual Stamp first() const = 0;
  [[nodiscard]] virtual Stamp last() const = 0;
  /// What was found and assumed, in one line: "speeds of wheels, 100 rows at 5 Hz".
  [[nodiscard]] virtual std::string description() const = 0;

 protected:
  MotionPriors() = default;
};

/// The rotation camera_from_level of a camera that looks down by `pitch_deg` and whose right side is lowered
/// by `roll_deg`; see KnownGround.
Pose camera_from_level(double pitch_deg, double roll_deg);

/// Reads odometry, its form recognised by content: a table with the columns t_s, v_m_per_s, omega_rad_per_s
/// (speed ahead and turn rate to the left, each the mean since the row before); TUM's lines
/// `t x y z qx qy qz qw`; KITTI's lines of 12 numbers, which need stamps: times.txt or stamps.txt beside the
/// file or in `source_folder`. Poses are those of the left rectified camera (x right, y down, z forward), or
/// of a robot (x forward, y left, z up) whose centre the camera is taken to be, where the file's name or a
/// comment in it has the word base_link or base_footprint. Throws Error (file, line, what was found): no such
/// form, stamps that do not rise or are in another unit, speeds of more than 20 m/s (60 m/s between poses),
/// which are mm, rates of more than 20 rad/s, which are degrees.
std::unique_ptr<MotionPriors> load_odometry(const std::filesystem::path& path,
                                            const std::filesystem::path& source_folder = {});

/// Reads an IMU's gyroscope from a table as EuRoC has it: ns, three rates in rad/s about its axes, and
/// accelerations, which are not used. `camera_from_imu`: the rotation from its axes to the rectified left
/// camera's. What it shows at rest in its first half second is taken off as its bias.
/// Throws Error as load_odometry() does.
std::unique_ptr<MotionPriors> load_imu(const std::filesystem::path& path, const Pose& camera_from_imu = {});

/// How an IMU is mounted, from the sensor.yaml beside its file and that of cam0 (EuRoC), and how that camera
/// was rectified; none where they are not there: its axes are then taken for the camera's. Throws Error.
std::optional<Pose> mounting_of_imu(const std::filesystem::path& path, const Rectifier* rectifier);

}  // namespace cairn::io
