// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/stereo/match.hpp>
#include <cairn/stereo/subpixel.hpp>

namespace cairn::reference {

/// The definitions of the matching stage: every window is summed from scratch for every candidate.
Matches match(const StereoPair& pair, const MatchConfig& config);
Image<Gray> filter_xsobel(View<const Gray> image, int cap);
Image<std::int16_t> remove_mean(View<const Gray> image, int window_size);
Image<float> refine_subpixel(const Matches& matches, const SubpixelConfig& config);

}  // namespace cairn::reference
