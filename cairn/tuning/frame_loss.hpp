// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/evaluation/consistency.hpp>
#include <cairn/evaluation/disparity_error.hpp>
#include <cairn/evaluation/object_error.hpp>
#include <cairn/tuning/search.hpp>
#include <optional>
#include <vector>

/// The loss of a frame, according to its ground truth.
namespace cairn {

/// With true objects: their capped E (Eq. 5) over the number of scored objects. E ignores false objects, so
/// each wrong found object (IoU < 0.5 with every true one, not mostly don't-care) is a fault; none if the
/// truth is partial.
Loss loss_of(const FrameObjects& frame);

/// With true disparities: the number of pixels off by more than 1 px, plus kHoleCost per hole, over the
/// pixels with truth.
Loss loss_of(const DisparityErrors& errors);
inline constexpr double kHoleCost = 0.5;

/// Without truth: Consistency::loss(), plus kUnsteadyWeight times the unsteady share relative to the previous
/// frame, if there is one; a frame counts once.
Loss loss_of(const Consistency& frame, const std::optional<Steadiness>& since_last);
inline constexpr double kUnsteadyWeight = 0.5;

/// Which of `count` frames are held out: `share` of them, rounded, at least one and not all (of one frame,
/// none). In a sequence, its end, since neighbouring frames are alike; otherwise a choice by `seed`.
std::vector<bool> held_out(int count, double share, bool sequence, std::uint32_t seed);

}  // namespace cairn
