// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/evaluation/consistency.hpp>
#include <cairn/evaluation/disparity_error.hpp>
#include <cairn/evaluation/object_error.hpp>
#include <cairn/tuning/search.hpp>
#include <optional>
#include <vector>

/// What a frame's loss is, by what is known of it.
namespace cairn {

/// True objects are known: their capped E (Eq. 5) over the number of scored ones. E alone does not see what
/// is found where nothing is, so each object of ours that is wrong (IoU < 0.5 with every true one, not mostly
/// don't-care) is a fault; none where the truth is partial.
Loss loss_of(const FrameObjects& frame);

/// True disparities are known: pixels off by more than 1 px, and kHoleCost for each without a disparity, over
/// those with truth.
Loss loss_of(const DisparityErrors& errors);
inline constexpr double kHoleCost = 0.5;

/// Nothing is known: Consistency::loss(), and kUnsteadyWeight times the unsteady share against the frame
/// before, where there is one; one frame is one thing.
Loss loss_of(const Consistency& frame, const std::optional<Steadiness>& since_last);
inline constexpr double kUnsteadyWeight = 0.5;

/// Which of `count` frames are held out: `share` of them, rounded, at least one and not all (of one frame,
/// none). In a sequence they are its end, since neighbours show the same; otherwise they are drawn by `seed`.
std::vector<bool> held_out(int count, double share, bool sequence, std::uint32_t seed);

}  // namespace cairn
