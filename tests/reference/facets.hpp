// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/grouping/facets.hpp>

namespace cairn::reference {

/// The slow twin of segment_facets(): fuses in the label image, and looks for all borders anew in each round.
Facets segment_facets(View<const Gray> gray, View<const Rgb> rgb, const FacetsConfig& config);

}  // namespace cairn::reference
