// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/objects/measure.hpp>
#include <cairn/scene/ground_plane.hpp>

namespace cairn {

/// Locates objects: adds the uncertainty of their disparity and, with a rig, position, depth interval and
/// extent, and with a ground the box on the floor.
/// The position is the centroid of the whole mask, at the depth of disparity_px, which also orders the
/// objects. Extent and box are measured on the main part of an object: the largest component of its mask whose
/// 4-neighbours differ by at most 1 px of disparity, and the other pixels of the mask with a disparity within
/// the component's range. So background or another object within the mask does not stretch them, and a hole
/// that divides it does not shorten them.
/// (docs/stages/objects.md, beyond the paper)
Objects locate(Objects objects, const DisparityMap& disparity, const Ground& ground,
               const std::optional<StereoRig>& rig, const Exec& exec);

/// The points of the object's pixels with a position, in raster order, m, in the left camera's frame. Covers
/// the whole mask, without holes of the disparity; box and extent only cover the main part. Throws Error if
/// there is no such object.
std::vector<Vec3> object_points(const Objects& objects, ObjectId id, View<const float> disparity_px,
                                const StereoRig& rig);

}  // namespace cairn
