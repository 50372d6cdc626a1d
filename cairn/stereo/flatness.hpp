// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/stereo/match.hpp>
#include <cairn/stereo/reject.hpp>

namespace cairn {

struct FlatnessConfig {
  float threshold = 0.1F;  // share, 0 … 1, −1 = off; higher rejects more low-texture pixels
};
template <class V>
void fields(FlatnessConfig& c, V&& v) {
  v("threshold", c.threshold, "share", "smallest relative depth of the best cost below the mean",
    off_or(0.0F, 1.0F));
}

/// Marks pixels with "a constant correlation function": (mean − best) / mean < threshold → Reject::flat; a
/// mean of 0 is flat. Pixels without a match stay with Reject::border. (docs/stages/flatness.md; paper)
Image<Reject> reject_flat(const Matches& matches, const FlatnessConfig& config, const Exec& exec);

}  // namespace cairn
