// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/stereo_pair.hpp>
#include <cairn/regions/region_graph.hpp>
#include <cairn/regions/segment_config.hpp>

namespace cairn {

/// Regions of similar intensity: gradient → watershed → build_graph → grow_statistical.
/// (docs/stages/intensity.md; paper, "Intensity segmentation")
Segmentation segment_intensity(View<const Gray> image, const IntensityConfig& config, const Exec& exec);

}  // namespace cairn
