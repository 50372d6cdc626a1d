// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cairn/stereo/confidence.hpp>

namespace cairn::reference {

/// The signs of ConfidenceModel at one pixel: margin, cost, jumps, holes.
std::array<double, 4> confidence_signs(const Matches& matches, View<const float> disparity_px, int x, int y);

Image<float> estimate_confidence(const Matches& matches, const DisparityMap& disparity,
                                 const ConfidenceModel& model);

}  // namespace cairn::reference
