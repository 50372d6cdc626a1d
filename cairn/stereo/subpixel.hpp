// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cairn/stereo/match.hpp>
#include <cstdint>

namespace cairn {

/// The curve fitted to the costs of the winner and its neighbours. parabola: for sums of squares and
/// correlations, which are round at the minimum. equiangular: two lines of opposite slope, for sums of
/// absolute values and of bits, which are pointed. none: integer disparities.
enum class SubpixelMethod : std::uint8_t { none, parabola, equiangular };

inline constexpr std::array kSubpixelMethods{
    Choice<SubpixelMethod>{"none", SubpixelMethod::none},
    Choice<SubpixelMethod>{"parabola", SubpixelMethod::parabola},
    Choice<SubpixelMethod>{"equiangular", SubpixelMethod::equiangular}};

struct SubpixelConfig {
  SubpixelMethod method = SubpixelMethod::parabola;  // according to the shape of the costs: see above
};
template <class V>
void fields(SubpixelConfig& c, V&& v) {
  v("method", c.method, "", "curve through the costs: equiangular for semi_global, sad and zsad",
    kSubpixelMethods);
}

/// The minimum of the curve through the costs a, m, c at best − 1, best, best + 1:
///   parabola     best + (a − c) / (2·(a − 2m + c))
///   equiangular  best + (a − c) / (2·(max(a, c) − m))      (Shimizu & Okutomi 2001)
/// The integer winner if a neighbour is missing, the three costs are equal, refinement is off, or Matches
/// holds no neighbours. NaN if there is no match. (docs/stages/subpixel.md)
Image<float> refine_subpixel(const Matches& matches, const SubpixelConfig& config, const Exec& exec);

}  // namespace cairn
