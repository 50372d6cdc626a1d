// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/grouping/group.hpp>

namespace cairn::reference {

/// The slow twin of group_facets(): pixel by pixel, planes solved and steps measured each time that they are
/// asked for. Sums in the same order, so that every bit is the same.
Segmentation group_facets(const Facets& facets, const std::vector<std::int32_t>& figure,
                          const DisparityMap& disparity, View<const float> evidence_px,
                          const Background& background, const std::optional<StereoRig>& rig,
                          const FigureConfig& figure_config, const GroupConfig& config);

}  // namespace cairn::reference
