// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/image.hpp>
#include <cairn/core/stereo_pair.hpp>
#include <filesystem>
#include <optional>

/// Reading and writing of disparity maps, in px; NaN = hole. The extension determines the form:
///   .png  16-bit grey, disparity · 256, 0 = hole (as KITTI); a true 0 is written as 1. 8-bit files:
///         only Middlebury maps of 2001 to 2006 (disp0 … disp9, also .pgm), with the scale of their set
///   .pfm  32-bit float, either byte order, rows bottom-up; NaN and ±inf are read as holes, holes are written
///         as +inf
///   .npy  read only: NumPy, two-dimensional float32 or float64; NaN and ±inf are holes
/// Every function throws Error with one line that names the file.
namespace cairn::io {

/// Reads a map. Throws Error if the file is truncated, too long, of another type, or of implausible size. A
/// map of holes only is accepted: external_disparity() checks it.
Image<float> load_disparity(const std::filesystem::path& path, const Pool& pool = {});

/// The units per metre of a 16-bit depth image: mm, as RealSense, OAK-D, ZED and ROS write them.
inline constexpr double kDepthUnitsPerMetre = 1000;

/// Reads a depth image, in m; NaN = hole. 16-bit .png and .npy hold `units_per_m`, 0 = hole (TUM RGB-D: 5000); .pfm
/// and .npy of floats hold m; NaN, ±inf and values up to 0 are holes. Throws Error like load_disparity().
Image<float> load_depth(const std::filesystem::path& path, double units_per_m = kDepthUnitsPerMetre,
                        const Pool& pool = {});

/// The disparities of a frame from a file, instead of a right image.
struct GivenMap {
  std::filesystem::path path;
  std::optional<double> depth_units_per_m = {};  // of a depth image; nullopt: a disparity map
};
/// Its values, in m or px; NaN = hole. Throws Error like the readers.
Image<float> load_values(const GivenMap& map, const Pool& pool = {});
/// Its disparities, in px; NaN = hole. Throws Error like the readers, if the size is not that of `image`, and for depth
/// without a rig.
Image<float> load_given(const GivenMap& map, Size image, const std::optional<StereoRig>& rig,
                        const Pool& pool = {});

/// Writes a map atomically. Holes: NaN and ±inf. Throws Error, suggesting .pfm, if a .png cannot hold a value
/// (below 0, or from 256 on).
void save_disparity(const std::filesystem::path& path, View<const float> disparity_px);

/// Whether 16-bit PNG holds every disparity of the search range min … min + num − 1.
constexpr bool png_can_hold(int min_disparity, int num_disparities) {
  return min_disparity >= 0 && min_disparity <= 256 - num_disparities;
}
/// Whether 16-bit PNG holds every value of this map.
bool png_can_hold(View<const float> disparity_px);

}  // namespace cairn::io
