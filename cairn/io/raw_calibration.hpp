// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cairn/core/geometry.hpp>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace cairn::io {

/// A raw camera in OpenCV's model; all matrices row-major.
struct RawCamera {
  std::array<double, 9> matrix{};    // focal lengths and principal point, px
  std::vector<double> distortion{};  // k1 k2 p1 p2 [k3 [k4 k5 k6 [s1 s2 s3 s4 [tx ty]]]]; empty = none
  std::optional<std::array<double, 9>> rotation{};     // from this camera to the rectified one
  std::optional<std::array<double, 12>> projection{};  // of the rectified camera, px and px · m
  bool is_fisheye = false;  // distortion is k1 k2 k3 k4 of OpenCV's fisheye model (equidistant)
};

/// Two raw cameras. Either both have rotation and projection, or the relative pose of the right one is known.
struct RawCalibration {
  Size image_size;
  RawCamera left;
  RawCamera right;
  std::optional<std::array<double, 9>> rotation{};  // x_right = rotation · x_left + translation
  std::optional<std::array<double, 3>> translation_m{};
  std::filesystem::path path{};  // of the file, for messages
};

/// Reads OpenCV FileStorage YAML/XML/JSON (M1 D1 M2 D2 with R T, or with R1 R2 P1 P2; also K1, cameraMatrix1,
/// distCoeffs1 and the like; also as intrinsics.yml next to extrinsics.yml; matrices also as lists), ROS
/// camera_info YAML pairs, found as in load_calibration(), EuRoC's cam0/sensor.yaml with that of cam1, and Kalibr's
/// camchain. Lengths are in metres. Takes the size of the images from `image_size` if the file has none. Throws
/// Error (one line: file, what was found, what was expected).
RawCalibration load_raw_calibration(const std::filesystem::path& path,
                                    const std::function<Size()>& image_size = {});

/// Atomically writes it as OpenCV FileStorage YAML; `remarks` become comment lines at its top. With P1 and
/// P2, load_calibration() reads the calibration of the rectified pair from it.
void save_raw_calibration(const std::filesystem::path& path, const RawCalibration& calibration,
                          const std::vector<std::string>& remarks);

}  // namespace cairn::io
