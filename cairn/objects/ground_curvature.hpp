// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/objects/obstacles.hpp>

/// Ground that curves away from its plane: a slope ahead, a bank, camber. Private to the library.
/// (docs/stages/obstacles.md, beyond the paper)
namespace cairn {

/// `disparity_px`, but what is labelled floor as if the ground were its plane, where its heights above the plane are a
/// quadratic function of the place on it. Such a ground is fitted to the floor, robustly; if it does not explain 3 % of
/// the floor more than the plane, within 1 px, or without a plane, nothing is changed. Both images have one size; NaN = hole.
Image<float> without_curvature(Image<float> disparity_px, View<const ObstacleLabel> space,
                               const Ground& ground, const StereoRig& rig);

}  // namespace cairn
