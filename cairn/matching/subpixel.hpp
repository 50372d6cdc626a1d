// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cairn/matching/match.hpp>
#include <cstdint>

namespace cairn {

/// What is laid through the costs of the winner and of its neighbours. parabola: for sums of squares and
/// correlations, which are round at the bottom. equiangular: two lines of opposite slope, for sums of
/// absolute values and of bits, which are pointed.
enum class SubpixelMethod : std::uint8_t { parabola, equiangular };

inline constexpr std::array kSubpixelMethods{
    Choice<SubpixelMethod>{"parabola", SubpixelMethod::parabola},
    Choice<SubpixelMethod>{"equiangular", SubpixelMethod::equiangular}};

struct SubpixelConfig {
  bool enabled = true;                               // off: whole px
  SubpixelMethod method = SubpixelMethod::parabola;  // as the costs are shaped: see above
};
template <class V>
void fields(SubpixelConfig& c, V&& v) {
  v("enabled", c.enabled, "", "refine each winner by a curve through its cost and its neighbours'", Any{});
  v("method", c.method, "", "the curve: round for squares, pointed for absolute differences and semi_global",
    kSubpixelMethods, when("subpixel.enabled", "true"));
}

/// Where the curve through the costs a, m, c at best − 1, best, best + 1 is lowest:
///   parabola     best + (a − c) / (2·(a − 2m + c))
///   equiangular  best + (a − c) / (2·(max(a, c) − m))      (Shimizu & Okutomi 2001)
/// The integer winner where a neighbour is
/// missing, where the three are flat, or where refinement is off or Matches holds no neighbours. NaN where
/// there is no match. (docs/stages/subpixel.md)
Image<float> refine_subpixel(const Matches& matches, const SubpixelConfig& config, const Exec& exec);

}  // namespace cairn
