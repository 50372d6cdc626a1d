// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/regions/watershed.hpp>

namespace cairn {

/// The floor (`floor` non-zero), including the holes (`values` kHole16) of every basin with more floor pixels
/// than other valid ones: 255, else 0. `floor` and `values` have the size of the labels.
Image<std::uint8_t> floor_with_holes(const Basins& basins, View<const std::uint8_t> floor,
                                     View<const std::int16_t> values, const Exec& exec);

/// Splits basins along the floor: all floor pixels (`floor` non-zero) become one region, connected or not;
/// each connected component of the rest of a basin becomes a region. Numbered in raster order of the first
/// pixel. `floor` has the size of the labels.
Basins split_floor(const Basins& basins, View<const std::uint8_t> floor, const Exec& exec);

}  // namespace cairn
