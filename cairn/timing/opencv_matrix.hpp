// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/image.hpp>
#include <cstdint>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>

/// Conversion between cairn's and OpenCV's images.
namespace cairn::timing {

// OpenCV has no matrix of constant pixels; its functions only read.
inline cv::Mat matrix(View<const Gray> image) {
  return {image.height(), image.width(), CV_8UC1, const_cast<Gray*>(image.row(0)),
          static_cast<std::size_t>(image.stride())};
}
inline cv::Mat matrix(View<const Rgb> image) {
  return {image.height(), image.width(), CV_8UC3, const_cast<Rgb*>(image.row(0)),
          static_cast<std::size_t>(image.stride()) * sizeof(Rgb)};
}

/// The output of an OpenCV matcher, in sixteenths of a pixel, as px; NaN = hole, which OpenCV marks by a
/// value below the minimum disparity.
inline Image<float> disparity_px_of(const cv::Mat& sixteenths, int min_disparity) {
  constexpr auto kSubpixels = static_cast<float>(cv::StereoMatcher::DISP_SCALE);
  const int least = min_disparity * cv::StereoMatcher::DISP_SCALE;
  Image<float> disparity_px(Size{sixteenths.cols, sixteenths.rows});
  for (int y = 0; y < disparity_px.height(); ++y) {
    for (int x = 0; x < disparity_px.width(); ++x) {
      const auto value = sixteenths.at<std::int16_t>(y, x);
      disparity_px(x, y) =
          value < least ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(value) / kSubpixels;
    }
  }
  return disparity_px;
}

}  // namespace cairn::timing
