// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/error.hpp>
#include <cairn/core/stereo_pair.hpp>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace cairn::io {

/// What a calibration file says of a rectified pair. Files may leave things out.
struct Calibration {
  std::optional<StereoRig> rig;  // nothing where the file has no focal length or no baseline: no metres then
  std::optional<Size> image_size;      // of the pictures that it was made for
  std::optional<int> num_disparities;  // `ndisp`: the default of match.num_disparities
  KnownGround ground{};  // `ground_points`, `camera_height`, …: what Config::ground.known takes
  /// The file describes the lenses of the raw cameras as well: `rig` fits pictures that were rectified with
  /// it.
  bool of_raw_cameras = false;
};

/// A calibration that can be read but cannot be true: a focal length or baseline that is not positive.
class ImpossibleCalibration : public Error {
 public:
  ImpossibleCalibration(const std::string& says, double value) : Error(says), value_(value) {}
  /// The number that cannot be.
  [[nodiscard]] double value() const { return value_; }

 private:
  double value_;
};

/// Reads a calibration, its form recognised by content (docs/formats.md shows each): our own YAML, Middlebury
/// calib.txt, KITTI calib_cam_to_cam.txt and calib.txt, OpenCV FileStorage YAML/XML/JSON with P1 and P2 or Q,
/// ROS camera_info YAML (either file of the pair, one file with both, or their folder), key=value lines. Each
/// may also say how the rig is mounted: ground_points, camera_height, camera_pitch, camera_roll.
/// Throws Error (one line: file, what was found, what was expected): missing, no known form, a number that is
/// none or out of range, fx ≠ fy; ImpossibleCalibration: a focal length or baseline that is not positive.
/// Of KITTI's four cameras the colour pair counts, unless `grey_cameras`.
Calibration load_calibration(const std::filesystem::path& path, bool grey_cameras = false);
/// The same of a file's content, which `name` stands for in messages.
Calibration parse_calibration(std::string_view text, const std::filesystem::path& name,
                              bool grey_cameras = false);

/// Writes a rectified pair's calibration as key=value lines, whole or not at all; `num_disparities` as ndisp,
/// and how the rig is mounted. Throws Error.
void save_calibration(const std::filesystem::path& path, const StereoRig& rig, Size image,
                      std::optional<int> num_disparities = std::nullopt, const KnownGround& ground = {});
/// What that file holds.
std::string calibration_text(const StereoRig& rig, Size image, std::optional<int> num_disparities,
                             const KnownGround& ground);

/// The number of disparities that reaches down to `nearest_m` (0: five baselines, a fifth of the focal length
/// in disparities): a multiple of 16, but no more than the pictures' width.
int disparities_down_to(double nearest_m, const StereoRig& rig, int width);

/// Throws Error where the calibration was made for pictures of another size.
void check_size(const Calibration& calibration, Size image, const std::filesystem::path& path);
/// Throws Error where the height or an angle of the camera is out of range, or points determine no plane.
void check_ground(const KnownGround& known);
/// Throws Error where its number of disparities is none that match.num_disparities takes.
void check_search_range(const Calibration& calibration, const std::filesystem::path& path);

}  // namespace cairn::io
