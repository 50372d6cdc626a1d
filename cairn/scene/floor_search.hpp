// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/scene/ground_plane.hpp>

namespace cairn {

/// The floor of a disparity map, when there is one: the plane that rises towards the camera on which the most
/// disparities lie and under which the fewest do. See docs/stages/ground.md for the reasoning.
/// Same result for any number of threads; nothing random.
Ground find_floor(View<const float> disparity_px, const std::optional<StereoRig>& rig, const Exec& exec);

}  // namespace cairn
