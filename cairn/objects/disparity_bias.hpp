// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cairn/objects/measure.hpp>
#include <cairn/regions/fitted_trees.hpp>
#include <string_view>

/// How much the disparity of an object differs from the true one because of its shape and its looks: smoothed
/// matching carries the disparity of an outline across a plain surface, whose middle is nearer if it is round.
/// (docs/stages/objects.md, beyond the paper)
namespace cairn {

inline constexpr std::size_t kBiasFeatures = 12;
using BiasFeatures = std::array<float, kBiasFeatures>;
std::array<std::string_view, kBiasFeatures> bias_feature_names();

/// Of each object, in the order of the list; disparity_px is the median of its mask. `shift_px`: of each object,
/// from image_shifts(). `right`: rectified, of the size of `left`.
std::vector<BiasFeatures> bias_features(const Objects& objects, const std::vector<double>& shift_px,
                                        const DisparityMap& disparity, View<const Gray> left,
                                        View<const Gray> right, const Exec& exec);

/// The expected true disparity minus the median and its shift, px, from bias_features(). Fitted by ./dev fit.
const FittedTrees& disparity_bias_trees();

}  // namespace cairn
