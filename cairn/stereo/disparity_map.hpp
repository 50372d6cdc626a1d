// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cairn/core/image.hpp>
#include <cairn/core/stereo_pair.hpp>
#include <cairn/stereo/reject.hpp>
#include <vector>

namespace cairn {

/// Disparity of each left pixel, and the reason for every hole. Hole ⇔ reject ≠ none ⇔ disparity is NaN.
struct DisparityMap {
  Image<float> disparity_px;
  Image<Reject> reject;
};

/// Disparities beyond ±this limit are refused on input: regions use 16 bits in 1/16 px.
inline constexpr float kMaxDisparity = 2047.0F;

/// Applies the verdicts of the checks: a pixel keeps every bit it received, NaN adds Reject::border.
/// (docs/why_is_this_pixel_a_hole.md) All views have the size of `refined_px`.
DisparityMap combine(Image<float> refined_px, const std::vector<View<const Reject>>& verdicts,
                     const Exec& exec);

/// A map from outside (depth camera, learned matcher): NaN and ±inf become holes with Reject::no_data. Throws
/// Error if the map is empty, has no finite value, or one beyond ±kMaxDisparity.
DisparityMap external_disparity(View<const float> disparity_px, const Exec& exec);
/// The same for sequences, also without a finite value: a depth camera may see nothing for a while.
DisparityMap with_holes_marked(View<const float> disparity_px, const Exec& exec);

/// The disparities of a depth image: f·b/z − doffs, the inverse of StereoRig::point_in_camera_m(). Depths that are not
/// above 0 (the usual mark of holes), not finite, or nearer than kMaxDisparity allows become NaN.
Image<float> disparity_of_depth(View<const float> depth_m, const StereoRig& rig, const Pool& pool = {});

}  // namespace cairn
