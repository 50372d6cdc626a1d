// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/objects/measure.hpp>
#include <cairn/scene/ground_plane.hpp>

namespace cairn {

/// Where objects are: fills in what they hold of the uncertainty of their disparity and, with a rig, their
/// position, the interval of their depth, their extent, and with a ground their box on the floor.
///
/// All are measured over an object's main part: the largest island of its mask in which neighbours (4) differ
/// by at most 1 px of disparity, so that what the mask holds of the background, or of another thing, does not
/// stretch it. Depth is that of the median disparity of the whole mask: by it the objects are ordered.
/// (docs/stages/objects.md, beyond the paper)
Objects locate(Objects objects, const DisparityMap& disparity, const Ground& ground,
               const std::optional<StereoRig>& rig, const Exec& exec);

}  // namespace cairn
