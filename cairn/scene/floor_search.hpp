// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/scene/ground_plane.hpp>

namespace cairn {

/// What else is known of the scene; each may be empty.
struct FloorCues {
  View<const float> textured_px = {};  // the disparities among those searched that texture supports
  View<const Gray> left = {};
};

/// Searches for the floor in a disparity map: the plane, rising towards the camera, with most disparities on it
/// and fewest below it. See docs/stages/ground.md for the reasoning. Textured disparities refuse planes that
/// they show to be upright. If there is no floor and the left image is given, a plane is accepted if the image
/// below it resembles the mirror image of what is above. Deterministic for any number of threads.
Ground find_floor(View<const float> disparity_px, const FloorCues& cues, const std::optional<StereoRig>& rig,
                  const Exec& exec);

}  // namespace cairn
