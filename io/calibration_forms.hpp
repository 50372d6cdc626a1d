// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>
#include "calibration_files.hpp"
#include "raw_calibration.hpp"

/// The forms of calibration files, one function each; internal to io. All throw Error without a file's name.
namespace cairn::io {

/// What a file says, as it says it. judged() turns it into a Calibration or refuses it.
struct Statement {
  std::optional<double> fx, fy, cx, cy;  // px
  std::optional<double> baseline_m;
  std::optional<double> doffs;  // px
  std::optional<double> width, height, ndisp;
  bool has_distortion = false;          // of the lenses, besides
  std::vector<double> ground_points{};  // px; x_left, y_left, x_right, y_right of each
  std::optional<double> camera_height{}, camera_pitch{}, camera_roll{};  // m, degrees
};

/// How the rig is mounted: the keys that every form may have besides its own.
inline constexpr const char* kGroundPointsKey = "ground_points";
struct MountingKey {
  const char* key;
  std::optional<double> Statement::*member;
};
inline constexpr std::array kMountingKeys{MountingKey{"camera_height", &Statement::camera_height},
                                          MountingKey{"camera_pitch", &Statement::camera_pitch},
                                          MountingKey{"camera_roll", &Statement::camera_roll}};

/// The whole of `text` as one finite number; `key` is for the words of the Error.
double finite_number(std::string_view text, std::string_view key);
/// Numbers separated by white space, commas or semicolons.
std::vector<double> finite_numbers(std::string_view text, std::string_view key);
/// At most 60 characters of it on one line, quoted, for messages.
std::string excerpt(std::string_view text);
std::string_view trimmed(std::string_view text);

/// A 3x4 projection matrix in rows.
using Projection = std::array<double, 12>;
/// Throws Error where there are not 12 numbers.
Projection projection_of(const std::vector<double>& numbers, std::string_view key);
/// Focal length, centre, baseline and doffs of two rectified cameras; their fourth columns are in px · m.
Statement from_projections(const Projection& left, const Projection& right);
/// The same, judged: throws Error where it is no pair.
StereoRig rig_of(const Projection& left, const Projection& right);

Statement read_key_value_lines(std::string_view text);
Statement read_middlebury(std::string_view text);
/// Of cameras 2 and 3, which are KITTI's colour pair, else of 0 and 1; the other way round for
/// `grey_cameras`.
Statement read_kitti(std::string_view text, bool grey_cameras);
Statement read_opencv_xml(std::string_view text);
/// Our own YAML, OpenCV's, ROS': by their keys. `path` finds the other camera's file of a ROS pair; nothing
/// where the text is no YAML map.
std::optional<Statement> read_yaml(std::string_view text, const std::filesystem::path& path);

/// The cameras of OpenCV's YAML, XML and JSON, and of a ROS pair.
RawCalibration read_raw(std::string_view text, const std::filesystem::path& path);

/// left.yaml ↔ right.yaml, *_left ↔ *_right, left_* ↔ right_*; nothing where the name has neither word.
std::optional<std::filesystem::path> other_camera(const std::filesystem::path& path);

}  // namespace cairn::io
