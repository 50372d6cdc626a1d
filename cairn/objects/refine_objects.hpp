// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/objects/disparity_bias.hpp>

namespace cairn {

/// Refines disparity_px of each object, and renumbers the objects if their order changes. Adds the shift of
/// image_shifts(), and the remaining bias that `bias` predicts, reduced by 0.08 px; each at most 1 px, and
/// both together at most half of the disparity. `bias`: disparity_bias_trees(), or FittedTrees{} for none.
/// `right`: rectified, of the size of `left`; if empty, the objects are unchanged. (docs/stages/objects.md,
/// beyond the paper)
Objects refine_objects(Objects objects, const DisparityMap& disparity, View<const Gray> left,
                       View<const Gray> right, const FittedTrees& bias, const Exec& exec);

/// For each object the common shift of its disparities, px, for which its interior matches in both images: by
/// least squares on the brightness with a common offset (Lucas and Kanade 1981, in one dimension) and a prior
/// of no shift. `right`: as above, not empty.
std::vector<double> image_shifts(const Objects& objects, const DisparityMap& disparity, View<const Gray> left,
                                 View<const Gray> right, const Exec& exec);

}  // namespace cairn
