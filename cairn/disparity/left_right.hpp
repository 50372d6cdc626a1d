// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cairn/disparity/reject.hpp>
#include <cairn/matching/match.hpp>

namespace cairn {

enum class LeftRightMethod : std::uint8_t { true_, vote };
inline constexpr std::array kLeftRightMethods{Choice<LeftRightMethod>{"true", LeftRightMethod::true_},
                                              Choice<LeftRightMethod>{"vote", LeftRightMethod::vote}};

struct LeftRightConfig {
  float max_diff = 1.0F;  // px, 0 … 64, −1 = off; more keeps slanted surfaces, less clears rims
  LeftRightMethod method = LeftRightMethod::true_;  // vote: OpenCV's results
};
template <class V>
void fields(LeftRightConfig& c, V&& v) {
  v("max_diff", c.max_diff, "px", "largest left-right disagreement still accepted", off_or(0.0F, 64.0F));
  v("method", c.method, "",
    "true: the right image's own winner over all candidates; vote: the right pixel takes the best left "
    "winner (OpenCV)",
    kLeftRightMethods, unless("left_right.max_diff", "-1"));
}

/// Marks pixels whose match, followed back from the right image, does not return to them: mostly
/// half-occluded ones, seen by one camera only. |best(x, y) − best_right(x − best, y + row)| ≤ max_diff, else
/// Reject::left_right. With vote, the right pixel's disparity is that of the left pixel of least cost that
/// claims it (ties: the smallest disparity). Pixels without match are left to Reject::border.
/// (docs/stages/left_right.md; paper, "right-left consistency check")
Image<Reject> reject_inconsistent(const Matches& matches, const LeftRightConfig& config, const Exec& exec);

}  // namespace cairn
