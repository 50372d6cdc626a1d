// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cairn/core/stereo_pair.hpp>
#include <cairn/io/image_files.hpp>
#include <cairn/io/raw_calibration.hpp>
#include <memory>
#include <optional>
#include <span>
#include <vector>

/// Calibration of raw cameras and rectification, by OpenCV's calib3d. In a build without it
/// (CAIRN_CALIBRATION=OFF) every function here throws Error.
namespace cairn::io {

/// A checkerboard: its inner corners, and the side of a square.
struct Board {
  int columns = 0;
  int rows = 0;
  double square_m = 0;
};

using Corners = std::vector<std::array<float, 2>>;  // px, row by row
struct BoardDetection {
  Corners left;
  Corners right;
};

/// The inner corners of the board with subpixel accuracy; nullopt unless the image shows all of them.
std::optional<Corners> find_board(View<const Gray> image, const Board& board);

struct StereoCalibration {
  RawCalibration raw;        // with R, T and the rectification
  double error_px = 0;       // root mean squared reprojection error over both cameras
  double left_error_px = 0;  // per camera
  double right_error_px = 0;
  double rows_error_px = 0;           // root mean squared difference of the rows of rectified corners
  std::vector<double> pair_error_px;  // of the worse camera, one per sighting
};

inline constexpr std::size_t kMinSightings = 3;

/// Both cameras and their relative pose, from one board in several positions (Zhang 2000). Throws Error with
/// fewer than kMinSightings, or if OpenCV finds no solution.
StereoCalibration calibrate_stereo(std::span<const BoardDetection> sightings, const Board& board, Size image);

/// Rectifies images of raw cameras.
class Rectifier {
 public:
  /// Throws Error unless the two cameras are side by side.
  explicit Rectifier(const RawCalibration& calibration);
  ~Rectifier();
  Rectifier(const Rectifier&) = delete;
  Rectifier& operator=(const Rectifier&) = delete;

  /// Takes images of the calibrated size; areas beyond their border become black. Throws Error for other
  /// sizes.
  [[nodiscard]] LoadedPair operator()(const LoadedPair& raw, const Pool& pool = {}) const;
  /// The calibration of the rectified pair.
  [[nodiscard]] const StereoRig& rig() const { return rig_; }
  /// The rotation from the raw left camera to the rectified one, row-major.
  [[nodiscard]] const std::array<double, 9>& left_rotation() const { return left_rotation_; }

 private:
  struct Maps;
  std::unique_ptr<Maps> maps_;
  StereoRig rig_;
  std::array<double, 9> left_rotation_{1, 0, 0, 0, 1, 0, 0, 0, 1};
};

}  // namespace cairn::io
