// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cairn/stereo/match.hpp>
#include <cairn/stereo/reject.hpp>

namespace cairn {

enum class LeftRightMethod : std::uint8_t { right_winner, vote };
inline constexpr std::array kLeftRightMethods{
    Choice<LeftRightMethod>{"right_winner", LeftRightMethod::right_winner},
    Choice<LeftRightMethod>{"vote", LeftRightMethod::vote}};

struct LeftRightConfig {
  float max_diff = 1.0F;  // px, 0 … 64, −1 = off; higher keeps slanted surfaces, lower clears edges
  LeftRightMethod method = LeftRightMethod::right_winner;  // vote: as in OpenCV
};
template <class V>
void fields(LeftRightConfig& c, V&& v) {
  v("max_diff", c.max_diff, "px", "largest accepted difference of left and right disparity",
    off_or(0.0F, 64.0F));
  v("method", c.method, "", "reference for the right image: its own winner or OpenCV's votes",
    kLeftRightMethods, unless("left_right.max_diff", "-1"));
}

/// Marks pixels whose match in the right image does not lead back to them, mostly half-occluded ones:
/// |best(x, y) − best_right(x − best, y + row)| > max_diff → Reject::left_right. With vote, the disparity of
/// a right pixel is that of the left pixel of lowest cost that matches it (ties: the smallest disparity).
/// Pixels without a match stay with Reject::border. (docs/stages/left_right.md; paper, "right-left
/// consistency check")
Image<Reject> reject_inconsistent(const Matches& matches, const LeftRightConfig& config, const Exec& exec);

}  // namespace cairn
