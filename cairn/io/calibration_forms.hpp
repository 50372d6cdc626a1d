// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cairn/io/calibration_files.hpp>
#include <cairn/io/raw_calibration.hpp>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// The forms of calibration files, one function each; internal to io. All throw Error without a file name.
namespace cairn::io {

/// The numbers of a file as written. judged() validates them and makes a Calibration.
struct Statement {
  std::optional<double> fx, fy, cx, cy;  // px
  std::optional<double> baseline_m;
  std::optional<double> doffs;  // px
  std::optional<double> width, height, ndisp;
  bool has_distortion = false;  // of the lenses
  std::vector<std::string> unknown_keys{};
  std::vector<double> ground_points{};  // px; x_left, y_left, x_right, y_right of each
  std::optional<double> camera_height{}, camera_pitch{}, camera_roll{};  // m, degrees
};

/// The mounting of the rig: keys allowed in every form.
inline constexpr const char* kGroundPointsKey = "ground_points";
struct MountingKey {
  const char* key;
  std::optional<double> Statement::*member;
};
inline constexpr std::array kMountingKeys{MountingKey{"camera_height", &Statement::camera_height},
                                          MountingKey{"camera_pitch", &Statement::camera_pitch},
                                          MountingKey{"camera_roll", &Statement::camera_roll}};

/// `text` as one finite number; `key` is for the message of the Error.
double finite_number(std::string_view text, std::string_view key);
/// Numbers separated by white space, commas or semicolons.
std::vector<double> finite_numbers(std::string_view text, std::string_view key);
/// At most 60 characters on one line, quoted, for messages.
std::string excerpt(std::string_view text);
std::string_view trimmed(std::string_view text);

/// A 3x4 projection matrix, row-major.
using Projection = std::array<double, 12>;
/// Throws Error unless there are 12 numbers.
Projection projection_of(const std::vector<double>& numbers, std::string_view key);
/// Focal length, centre, baseline and doffs of two rectified cameras; their fourth columns are in px · m.
Statement from_projections(const Projection& left, const Projection& right);
/// The same, validated: throws Error if it is not a pair.
StereoRig rig_of(const Projection& left, const Projection& right);

Statement read_key_value_lines(std::string_view text);
Statement read_middlebury(std::string_view text);
/// From cameras 2 and 3, the KITTI colour pair, else from 0 and 1; in the opposite order for `grey_cameras`.
Statement read_kitti(std::string_view text, bool grey_cameras);
Statement read_opencv_xml(std::string_view text);
/// K.txt: the 9 numbers of a camera matrix, then the baseline in metres; nullopt for other text.
std::optional<Statement> read_camera_matrix_and_baseline(std::string_view text);
/// The program whose calibration this is and which numbers of it to copy, for forms that are recognised but not
/// read; nullopt for other text.
std::optional<std::string> known_but_unread(std::string_view text);
/// Our own YAML, and that of OpenCV and ROS, distinguished by their keys. `path` locates the file of the
/// other camera of a ROS pair; nullopt if the text is not a YAML map.
std::optional<Statement> read_yaml(std::string_view text, const std::filesystem::path& path);

/// Both cameras from YAML, XML and JSON of OpenCV, and from a ROS pair.
RawCalibration read_raw(std::string_view text, const std::filesystem::path& path);

/// left.yaml → right.yaml, *_left → *_right, left_* → right_*, also Left, LEFT and _L; nullopt for other names.
std::optional<std::filesystem::path> right_named_like(const std::filesystem::path& left);
/// The same in both directions.
std::optional<std::filesystem::path> other_camera(const std::filesystem::path& path);

}  // namespace cairn::io
