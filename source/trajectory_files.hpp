// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cairn/core/fields.hpp>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "../tracking/trajectory_error.hpp"

namespace cairn::io {

/// The forms that trajectories are written in.
/// tum: "t x y z qx qy qz qw", t in s. kitti: the 12 numbers of map_from_camera's upper rows, no stamps.
/// euroc: "ns,x,y,z,qw,qx,qy,qz".
enum class TrajectoryForm : std::uint8_t { tum, kitti, euroc };
inline constexpr std::array kTrajectoryForms{Choice{"tum", TrajectoryForm::tum},
                                             Choice{"kitti", TrajectoryForm::kitti},
                                             Choice{"euroc", TrajectoryForm::euroc}};

struct Trajectory {
  std::vector<TimedPose> poses;  // sorted by stamp, no two at the same one
  bool has_stamps = true;        // KITTI's have none: the k-th pose then has the stamp k · 0.1 s
};

/// Reads a trajectory in the form that its lines have: 8 numbers separated by blanks are TUM's, 12 are
/// KITTI's (with the stamps of `times.txt` in the same folder where that has as many lines), commas EuRoC's.
/// A folder is a house folder whose frames hold `pose.txt`, with the stamps of its stamps.txt or
/// trajectory.csv, else 0.1 s apart. Throws Error (file and line; what was found, what was expected).
Trajectory load_trajectory(const std::filesystem::path& path);

/// A pose.txt: camera-to-map, 4×4 or its upper 3×4 numbers, row by row. Throws Error.
Pose load_pose(const std::filesystem::path& path);

/// The poses as the text of a file in this form; a line each.
std::string trajectory_text(const std::vector<TimedPose>& poses, TrajectoryForm form);

}  // namespace cairn::io
