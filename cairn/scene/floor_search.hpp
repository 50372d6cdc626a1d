// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/scene/ground_plane.hpp>

namespace cairn {

/// The floor of a disparity map, when there is one: the plane that rises towards the camera on which the most
/// disparities lie and under which the fewest do. See docs/stages/ground.md for the reasoning.
/// Where there is none such, a plane is the floor if the picture below it looks like the mirror image of what
/// is above; `left` is not asked where it is empty. Same result for any number of threads; nothing random.
Ground find_floor(View<const float> disparity_px, View<const Gray> left, const std::optional<StereoRig>& rig,
                  const Exec& exec);

}  // namespace cairn
