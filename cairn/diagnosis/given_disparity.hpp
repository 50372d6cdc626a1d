// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cairn/core/stereo_pair.hpp>
#include <cairn/diagnosis/findings.hpp>
#include <optional>

namespace cairn {

/// Compares an external disparity map (NaN = hole) with the images: points found in both images must be at the
/// disparity that the map gives them. A map that fits at hardly any of them is broken; if it would fit upside down,
/// mirrored, with the other sign, scaled, as depth or as the map of the right image, the finding says so. nullopt
/// for a map that fits, and if too few points can be compared. `rig` names the unit of depths. Throws Error if the
/// sizes differ.
std::optional<Finding> check_given_disparity(View<const float> disparity_px, const StereoPair& pair,
                                             const std::optional<StereoRig>& rig, const Exec& exec);

}  // namespace cairn
