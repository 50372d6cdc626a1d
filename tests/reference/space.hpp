// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/objects/space.hpp>

/// The slow twin of label_space(): each pixel from scratch.
namespace cairn::reference {

Image<Space> label_space(const SpaceCues& cues, const std::optional<StereoRig>& rig,
                         const GroundConfig& config);

}  // namespace cairn::reference
