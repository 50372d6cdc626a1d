// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/regions/watershed.hpp>

namespace cairn {

/// Cuts basins along the floor: all floor pixels (`floor` non-zero) become one region, connected or not; what
/// is left of a basin becomes one region for each of its connected parts. Numbered in raster order of the
/// first pixel. `floor` has the size of the labels.
Basins split_floor(const Basins& basins, View<const std::uint8_t> floor, const Exec& exec);

}  // namespace cairn
