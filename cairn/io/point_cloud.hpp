// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/ids.hpp>
#include <cairn/core/image.hpp>
#include <cairn/core/stereo_pair.hpp>
#include <cairn/objects/measure.hpp>
#include <filesystem>

namespace cairn::io {

/// Writes a coloured point cloud as binary little-endian PLY, atomically: one point per pixel with a finite
/// positive depth, in raster order. Vertices are float x, y, z (m, in the left camera frame: x right, y down,
/// z forward), uchar red, green, blue and, with labels, int object (0 = none). `left_rgb` (grey points
/// without) and `objects` may be empty. Throws Error (names the file).
void save_ply(const std::filesystem::path& path, View<const Gray> left, View<const Rgb> left_rgb,
              View<const float> disparity_px, View<const ObjectId> objects, const StereoRig& rig);

/// Writes the points of each object in a file of its own, without the property object: `folder`/1.ply for
/// object 1, and so on. An object without points has a file of zero vertices. Creates `folder`. Throws Error.
void save_object_plys(const std::filesystem::path& folder, View<const Gray> left, View<const Rgb> left_rgb,
                      View<const float> disparity_px, const Objects& objects, const StereoRig& rig);

}  // namespace cairn::io
