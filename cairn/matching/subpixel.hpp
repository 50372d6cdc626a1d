// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/matching/match.hpp>

namespace cairn {

struct SubpixelConfig {
  bool enabled = true;
};
template <class V>
void fields(SubpixelConfig& c, V&& v) {
  v("enabled", c.enabled, "", "refine each winner by a parabola through its cost and its neighbours'", Any{});
}

/// The vertex of the parabola through (best−1, best, best+1); the integer winner where a neighbour is
/// missing, where the three are flat, or where refinement is off or Matches holds no neighbours. NaN where
/// there is no match. (METHOD §1)
Image<float> refine_subpixel(const Matches& matches, const SubpixelConfig& config, const Exec& exec);

}  // namespace cairn
