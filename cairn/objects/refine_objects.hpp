// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/objects/measure.hpp>

namespace cairn {

/// Refines disparity_px of each object by the images, and renumbers the objects if their order changes.
///
/// Smoothed matching carries the disparity of an outline across a plain surface, whose middle is nearer. This
/// estimates the common shift of an object's disparities for which its interior matches in both images: by
/// least squares on the brightness with a common offset (Lucas and Kanade 1981, in one dimension) and a prior
/// of no shift. The shift is at most 1 px. `right`: rectified, of the size of `left`; if empty, the objects
/// are unchanged. (docs/stages/objects.md, beyond the paper)
Objects refine_objects(Objects objects, const DisparityMap& disparity, View<const Gray> left,
                       View<const Gray> right, const Exec& exec);

}  // namespace cairn
