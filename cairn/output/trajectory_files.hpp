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

#include <cairn/sequence/trajectory_error.hpp>

namespace cairn::output {

/// The forms of trajectory files.
/// tum: "t x y z qx qy qz qw", t in s. kitti: the 12 numbers of the upper rows of map_from_camera, no stamps.
/// euroc: "ns,x,y,z,qw,qx,qy,qz".
enum class TrajectoryForm : std::uint8_t { tum, kitti, euroc };
inline constexpr std::array kTrajectoryForms{Choice{"tum", TrajectoryForm::tum},
                                             Choice{"kitti", TrajectoryForm::kitti},
                                             Choice{"euroc", TrajectoryForm::euroc}};

struct Trajectory {
  std::vector<TimedPose> poses;  // sorted by stamp, stamps are unique
  bool has_stamps = true;        // KITTI has none: the k-th pose then has the stamp k · 0.1 s
};

/// Reads a trajectory, its form recognised by its lines: 8 numbers separated by blanks are TUM, 12 are KITTI
/// (with the stamps of `times.txt` in the same folder if that has as many lines), commas EuRoC. A folder is a
/// folder of frames with `pose.txt`, with the stamps of its stamps.txt or trajectory.csv, else 0.1 s apart.
/// Throws Error (file and line; what was found, what was expected).
Trajectory load_trajectory(const std::filesystem::path& path);

/// Reads a pose.txt: camera-to-map, 4×4 or its upper 3×4 numbers, row-major. Throws Error.
Pose load_pose(const std::filesystem::path& path);

/// The poses as the text of a file in this form, one line each.
std::string trajectory_text(const std::vector<TimedPose>& poses, TrajectoryForm form);

}  // namespace cairn::output
