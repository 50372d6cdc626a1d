// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/scene/ground_plane.hpp>
#include <cairn/stereo/disparity_map.hpp>
#include <cairn/stereo/left_right.hpp>
#include <cairn/stereo/speckle.hpp>
#include <cairn/stereo/texture.hpp>
#include <vector>

/// The slow twins of the checks, except those of equivalence/pixel_checks_test.cpp; the fast functions must
/// give the same bits. Written one pixel at a time, each from scratch.
namespace cairn::reference {

/// An image of judge(x, y).
template <class Judge>
Image<Reject> verdicts(Size size, Judge judge) {
  Image<Reject> image(size);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) image(x, y) = judge(x, y);
  }
  return image;
}

Image<Reject> reject_inconsistent(const Matches& matches, const LeftRightConfig& config);
Image<Reject> reject_textureless(View<const Gray> left, const TextureConfig& config);
DisparityMap combine(const Image<float>& refined_px, const std::vector<View<const Reject>>& verdicts);
DisparityMap reject_below_ground(const DisparityMap& disparity, const GroundPlane& plane, float doffs_px,
                                 float margin);
Image<std::uint8_t> label_floor(const DisparityMap& disparity, const GroundPlane& plane, float doffs_px,
                                float margin);
DisparityMap reject_speckles(const DisparityMap& disparity, const SpeckleConfig& config);

}  // namespace cairn::reference
