// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/stereo/match.hpp>
#include <cairn/stereo/reject.hpp>

namespace cairn {

struct UniquenessConfig {
  float ratio = 10.0F;  // %, 0 … 100, −1 = off; higher rejects more repetitive texture
};
template <class V>
void fields(UniquenessConfig& c, V&& v) {
  v("ratio", c.ratio, "%", "margin of the best cost over the runner-up (OpenCV's uniquenessRatio)",
    off_or(0.0F, 100.0F));
}

/// Marks pixels with "more than one suitable minimum": runner_up·(100 − ratio) < cost·100 →
/// Reject::not_unique. No runner-up (kNoCost): unique. (docs/stages/uniqueness.md; paper; OpenCV's rule)
Image<Reject> reject_ambiguous(const Matches& matches, const UniquenessConfig& config, const Exec& exec);

}  // namespace cairn
