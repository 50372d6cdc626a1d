// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cairn/core/stereo_pair.hpp>
#include <memory>
#include <optional>
#include <span>
#include <vector>
#include "image_files.hpp"
#include "raw_calibration.hpp"

/// From raw cameras to rectified pairs, by OpenCV's calib3d. Built without it (CAIRN_CALIBRATION=OFF) every
/// function here throws an Error that says so.
namespace cairn::io {

/// A checkerboard: its inner corners, and the side of a square.
struct Board {
  int columns = 0;
  int rows = 0;
  double square_m = 0;
};

using Corners = std::vector<std::array<float, 2>>;  // px, row by row
struct BoardSighting {
  Corners left;
  Corners right;
};

/// The board's inner corners between the pixels; nullopt where the picture does not show all of them.
std::optional<Corners> find_board(View<const Gray> image, const Board& board);

struct StereoCalibration {
  RawCalibration raw;        // with R, T and all that rectifies
  double error_px = 0;       // root mean squared reprojection error over both cameras
  double left_error_px = 0;  // of each camera on its own
  double right_error_px = 0;
  double rows_error_px = 0;           // root mean squared difference of the rows of rectified corners
  std::vector<double> pair_error_px;  // the worse camera's, one per sighting
};

inline constexpr std::size_t kLeastSightings = 3;

/// Both cameras and how they stand to each other, from one board in several places (Zhang 2000). Throws Error
/// with fewer than kLeastSightings, or where OpenCV finds no solution.
StereoCalibration calibrate_stereo(std::span<const BoardSighting> sightings, const Board& board, Size image);

/// Turns pictures of raw cameras into those of a rectified pair.
class Rectifier {
 public:
  /// Throws Error where the two cameras do not stand one beside the other.
  explicit Rectifier(const RawCalibration& calibration);
  ~Rectifier();
  Rectifier(const Rectifier&) = delete;
  Rectifier& operator=(const Rectifier&) = delete;

  /// Pictures of the calibration's size, with what lies beyond their border black. Throws Error for others.
  [[nodiscard]] PicturePair operator()(const PicturePair& raw, const Pool& pool = {}) const;
  /// The rectified pair's calibration.
  [[nodiscard]] const StereoRig& rig() const { return rig_; }
  /// The rotation from the raw left camera to the rectified one, row by row.
  [[nodiscard]] const std::array<double, 9>& left_rotation() const { return left_rotation_; }

 private:
  struct Maps;
  std::unique_ptr<Maps> maps_;
  StereoRig rig_;
  std::array<double, 9> left_rotation_{1, 0, 0, 0, 1, 0, 0, 0, 1};
};

}  // namespace cairn::io
