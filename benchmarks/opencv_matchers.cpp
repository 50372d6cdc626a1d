// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "opencv_matchers.hpp"

#include <cstdint>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>

namespace cairn::report {
namespace {

cv::Mat matrix(View<const Gray> image) {
  // OpenCV has no matrix of constant pixels; the matchers only read.
  return {image.height(), image.width(), CV_8UC1, const_cast<Gray*>(image.row(0)),
          static_cast<std::size_t>(image.stride())};
}

Image<float> matched(cv::StereoMatcher& matcher, const StereoPair& pair) {
  constexpr auto kSubpixels = static_cast<float>(cv::StereoMatcher::DISP_SCALE);
  cv::Mat sixteenths;
  matcher.compute(matrix(pair.left()), matrix(pair.right()), sixteenths);
  Image<float> disparity_px(pair.size());
  for (int y = 0; y < disparity_px.height(); ++y) {
    for (int x = 0; x < disparity_px.width(); ++x) {
      const auto value = sixteenths.at<std::int16_t>(y, x);
      // OpenCV's mark of a hole lies below the least disparity, which is 0 here.
      disparity_px(x, y) =
          value < 0 ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(value) / kSubpixels;
    }
  }
  return disparity_px;
}

Image<float> block_matching(const StereoPair& pair, int num_disparities) {
  constexpr int kWindow = 9;
  const auto matcher = cv::StereoBM::create(num_disparities, kWindow);
  matcher->setDisp12MaxDiff(1);
  return matched(*matcher, pair);
}

Image<float> semi_global(const StereoPair& pair, int num_disparities, int mode) {
  constexpr int kBlock = 5;
  constexpr int kSmallPenalty = 8 * kBlock * kBlock;
  constexpr int kLargePenalty = 32 * kBlock * kBlock;
  constexpr int kMostDisagreement = 1;
  constexpr int kPrefilterCap = 63;
  constexpr int kUniqueness = 10;
  constexpr int kSpeckleSize = 100;
  constexpr int kSpeckleRange = 2;
  const auto matcher =
      cv::StereoSGBM::create(0, num_disparities, kBlock, kSmallPenalty, kLargePenalty, kMostDisagreement,
                             kPrefilterCap, kUniqueness, kSpeckleSize, kSpeckleRange, mode);
  return matched(*matcher, pair);
}

Image<float> semi_global_5_paths(const StereoPair& pair, int num_disparities) {
  return semi_global(pair, num_disparities, cv::StereoSGBM::MODE_SGBM);
}

Image<float> semi_global_8_paths(const StereoPair& pair, int num_disparities) {
  return semi_global(pair, num_disparities, cv::StereoSGBM::MODE_HH);
}

}  // namespace

constexpr std::string_view kSemiGlobalSettings =
    "block 5, P1 200, P2 800, prefilter cap 63, uniqueness 10, left-right 1, speckles 100 px within 2";

const std::array<OpenCvMatcher, 3> kOpenCvMatchers{
    OpenCvMatcher{"StereoBM",
                  "window 9, x-Sobel with cap 31, uniqueness 15, texture 10, left-right 1, no speckle filter",
                  block_matching},
    OpenCvMatcher{"StereoSGBM", kSemiGlobalSettings, semi_global_5_paths},
    OpenCvMatcher{"StereoSGBM HH", "the same with 8 paths", semi_global_8_paths}};

std::string_view opencv_version() {
  return CV_VERSION;
}

void use_one_opencv_thread() {
  cv::setNumThreads(1);
}

}  // namespace cairn::report
