// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/image.hpp>
#include <filesystem>

/// Disparity maps in and out, in px; NaN = hole. The extension names the form:
///   .png  16-bit grey, disparity · 256, 0 = hole (KITTI's); a true 0 is written as 1. Of 8 bits only
///         Middlebury's maps of 2001 to 2006 are read (disp0 … disp9, also .pgm), with their data set's scale
///   .pfm  32-bit float, either byte order, rows bottom-up; NaN and ±inf are read as holes, +inf is written
///         for one
///   .npy  read only: NumPy's, two-dimensional float32 or float64; NaN and ±inf are holes
/// Every function throws Error with one line that names the file.
namespace cairn::io {

/// Reads a map. Throws Error where the file is truncated, too long, of another kind, or its sides are absurd.
/// A map of nothing but holes is read: external_disparity() judges it.
Image<float> load_disparity(const std::filesystem::path& path, const Pool& pool = {});

/// Writes a map atomically. Holes: NaN and ±inf. A .png that cannot hold a value (below 0, or from 256 on) is
/// refused with the words that name .pfm.
void save_disparity(const std::filesystem::path& path, View<const float> disparity_px);

/// Whether 16-bit PNG holds every disparity of the search range min … min + num − 1.
constexpr bool png_can_hold(int min_disparity, int num_disparities) {
  return min_disparity >= 0 && min_disparity <= 256 - num_disparities;
}
/// Whether it holds every value of this map.
bool png_can_hold(View<const float> disparity_px);

}  // namespace cairn::io
