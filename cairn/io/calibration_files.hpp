// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/error.hpp>
#include <cairn/core/stereo_pair.hpp>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace cairn::io {

/// The contents of a calibration file of a rectified pair. All parts are optional.
struct Calibration {
  std::optional<StereoRig> rig;        // nullopt without focal length or baseline: no metres then
  std::optional<Size> image_size;      // of the images that it was made for
  std::optional<int> num_disparities;  // `ndisp`: the default of match.num_disparities
  KnownGround ground{};                // `ground_points`, `camera_height`, …: for Config::ground.known
  /// The file also describes the lenses of the raw cameras: `rig` is valid for images rectified with it.
  bool of_raw_cameras = false;
  /// What its user should know, without the file's name: unknown keys that were ignored, fx ≠ fy.
  std::vector<std::string> remarks{};
  std::optional<StereoRig> one_camera{};  // without a baseline, which is 0: enough for a depth camera
};

/// A calibration that is readable but impossible: a focal length or baseline that is not positive.
class ImpossibleCalibration : public Error {
 public:
  ImpossibleCalibration(const std::string& says, double value) : Error(says), value_(value) {}
  /// The impossible number.
  [[nodiscard]] double value() const { return value_; }

 private:
  double value_;
};

/// Reads a calibration, its form recognised by content (docs/formats.md shows each): our own YAML, Middlebury
/// calib.txt, KITTI calib_cam_to_cam.txt and calib.txt, OpenCV FileStorage YAML/XML/JSON with P1 and P2 or Q
/// (matrices also as plain or nested lists), ROS camera_info YAML (either file of the pair, one file with both,
/// or their folder), K.txt (9 numbers, then the baseline), key=value lines. Each may also contain the mounting
/// of the rig: ground_points, camera_height, camera_pitch, camera_roll. Throws Error (one line: file, what was
/// found, what was expected): missing, unknown form, a number that is invalid or out of range, fx and fy more
/// than 1 % apart, exchanged cameras; ImpossibleCalibration: a focal length or baseline that is not positive.
/// Of the four KITTI cameras, reads the colour pair unless `grey_cameras`.
Calibration load_calibration(const std::filesystem::path& path, bool grey_cameras = false);
/// The rig that gives the depths of a depth camera as disparities: `rig`, else that of the camera with an assumed
/// baseline, which changes no position. nullopt without a focal length.
std::optional<StereoRig> rig_of_depth(const Calibration& calibration);
/// The assumed baseline. Objects are found equally well from 0.1 to 0.25 m. (docs/bring_your_own_depth.md)
inline constexpr float kDepthBaseline_m = 0.15F;

/// load_calibration() for the content of a file, named `name` in messages.
Calibration parse_calibration(std::string_view text, const std::filesystem::path& name,
                              bool grey_cameras = false);

/// Atomically writes the calibration of a rectified pair as key=value lines; `num_disparities` as ndisp, and
/// the mounting of the rig. Throws Error.
void save_calibration(const std::filesystem::path& path, const StereoRig& rig, Size image,
                      std::optional<int> num_disparities = std::nullopt, const KnownGround& ground = {});
/// The text of that file.
std::string calibration_text(const StereoRig& rig, Size image, std::optional<int> num_disparities,
                             const KnownGround& ground);

/// The number of disparities for a nearest distance of `nearest_m` (0: five baselines, i.e. a fifth of the
/// focal length): a multiple of 16, at most the image width.
int disparities_down_to(double nearest_m, const StereoRig& rig, int width);

/// The same calibration for images of another size of the same shape, such as half-size ones. Throws Error
/// without a size in the file, or if the sides have ratios more than 1 % apart.
Calibration scaled(const Calibration& calibration, Size image);

/// Throws Error, naming --binning, if the factor is out of 1 … kMaxBinning.
void check_binning(int factor);
/// The calibration of binned images (cairn/image/binning.hpp) where it is for `image`. Throws Error like check_binning(),
/// or if the image is smaller than the factor.
Calibration binned(const Calibration& calibration, Size image, int factor);

/// The calibration for images of this size: scaled() if `scales` and it was made for another one. Throws Error if it
/// was and not `scales`.
Calibration suited(const Calibration& calibration, Size image, const std::filesystem::path& path,
                   bool scales = false);
/// Throws Error if its number of disparities is out of range for match.num_disparities.
void check_search_range(const Calibration& calibration, const std::filesystem::path& path);

}  // namespace cairn::io
