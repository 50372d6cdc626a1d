// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/observed.hpp>
#include <cairn/pipeline/config.hpp>

namespace cairn {

/// What a frame is made of: a pair or, without a right image, a left image and its disparities from
/// elsewhere.
struct Given {
  View<const Gray> left;
  View<const Rgb> left_rgb;
  View<const Gray> right;
  DisparityMap disparity;
};

/// Disparities that the checks of single pixels have passed, and what they were judged by.
struct Matched {
  EpipolarOffset epipolar;
  Matches matches;  // empty where the disparities come from elsewhere
  DisparityMap disparity;
};

/// Both methods begin with this. Takes the disparities of `given` where there is nothing to match. Private to
/// the library.
Matched match_and_check(Given& given, const Config& config, const Exec& exec, Observed& stage);

}  // namespace cairn
