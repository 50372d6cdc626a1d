// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cairn/regions/watershed.hpp>

namespace cairn {

/// Fuses the basins of `edges` in pairs until at most `count` are left; see cut_superpixels(). They are numbered in
/// raster order of their first pixel again.
Basins fuse_basins(Basins basins, View<const std::uint16_t> edges, int count, const Exec& exec);

}  // namespace cairn
