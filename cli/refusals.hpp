// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/stereo/disparity_map.hpp>
#include <string>
#include <vector>

namespace cairn::cli {

/// The frequency of a rejection reason in a map.
struct RefusalCount {
  std::string name;
  double share = 0;          // of all pixels
  double dark_or_plain = 0;  // share of these without texture above the noise
};
struct Refusals {
  std::vector<RefusalCount> counts;  // of each listed reason, in the order of their bits
  double dark_or_plain = 0;          // of all pixels
};
Refusals count_refusals(const DisparityMap& map, View<const Gray> left, Reject in_force, const Exec& exec);

/// "refused: left_right 6.4 %, speckle 30.6 % (92 % of it too dark or without texture)"; empty if nothing
/// was.
std::string refusals_line(const Refusals& refusals);
std::string refusals_table(const Refusals& refusals);

}  // namespace cairn::cli
