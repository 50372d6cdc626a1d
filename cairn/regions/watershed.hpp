// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cairn/core/ids.hpp>
#include <cairn/core/image.hpp>

namespace cairn {

struct Basins {
  Image<RegionId> labels;  // numbered in raster order of their first pixel
  int count = 0;
};

/// Watershed by steepest descent, 4-connected, without ridge lines: every pixel belongs to a basin. A pixel
/// drains to its lowest neighbour if that is lower (ties: the first in the order up, left, right, down). On a
/// plateau, a pixel without lower neighbour drains to the plateau neighbour whose breadth-first distance to
/// the lower border of the plateau is one less (ties: the same order); a plateau without lower border is one
/// basin. (docs/stages/intensity.md; paper [3])
Basins watershed(View<const std::uint16_t> gradient, const Exec& exec);

}  // namespace cairn
