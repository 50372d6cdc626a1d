// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/scene/ground_plane.hpp>

namespace cairn {

/// Searches for the floor in a disparity map: the plane, rising towards the camera, with most disparities on it
/// and fewest below it. See docs/stages/ground.md for the reasoning. If there is none, a plane is accepted as
/// floor if the image below it resembles the mirror image of what is above; skipped if `left` is empty.
/// Deterministic for any number of threads.
Ground find_floor(View<const float> disparity_px, View<const Gray> left, const std::optional<StereoRig>& rig,
                  const Exec& exec);

}  // namespace cairn
