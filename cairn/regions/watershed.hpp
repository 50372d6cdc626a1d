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

/// Watershed by steepest descent, 4-connected, no ridge lines: every pixel belongs to a basin.
/// A pixel flows to its lowest neighbour if that is lower than itself (ties: the first in the order up, left,
/// right, down). A plateau's pixels without a lower neighbour flow to the plateau neighbour whose
/// breadth-first distance to the plateau's lower border is one less (ties: the same order); a plateau without
/// lower border is one basin. (docs/stages/intensity.md; paper [3])
Basins watershed(View<const std::uint16_t> gradient, const Exec& exec);

}  // namespace cairn
