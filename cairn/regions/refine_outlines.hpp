// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cairn/core/ids.hpp>
#include <cairn/core/image.hpp>
#include <cstdint>

namespace cairn {

/// Regions of an image of half the size (rounded up), at the size of `edges`. Outlines are moved to the crest of the
/// edge within two pixels; see cut_superpixels(). Regions stay connected, and none vanishes.
Image<RegionId> refine_outlines(View<const RegionId> coarse, View<const std::uint16_t> edges,
                                const Exec& exec);

}  // namespace cairn
