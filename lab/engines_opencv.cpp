// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// OpenCV's engines. One thread each, unless the name says two.
#include <memory>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <cairn/timing/opencv_matrix.hpp>
#include "engines.hpp"

namespace cairn::lab {
namespace {

using timing::matrix;

template <class T>
Image<T> resized_by_opencv(const Image<T>& image, Size size) {
  Image<T> small(size);
  cv::Mat out = timing::matrix(View<const T>(small));
  cv::resize(timing::matrix(View<const T>(image)), out, out.size(), 0, 0, cv::INTER_LINEAR);
  return small;
}

Run compute(const cv::Ptr<cv::StereoMatcher>& matcher, const Scene& scene, int threads) {
  return [=, out = std::make_shared<cv::Mat>(), &scene] {
    cv::setNumThreads(threads);
    matcher->compute(timing::matrix(View<const Gray>(scene.left)),
                     timing::matrix(View<const Gray>(scene.right)), *out);
  };
}

/// StereoBM's default is the x-Sobel prefilter with a cap of 31.
cv::Ptr<cv::StereoBM> block_matcher(int num_disparities, int window, bool checks) {
  auto matcher = cv::StereoBM::create(num_disparities, window);
  matcher->setUniquenessRatio(checks ? 15 : 0);
  matcher->setTextureThreshold(checks ? 10 : 0);
  matcher->setDisp12MaxDiff(checks ? 1 : -1);
  return matcher;
}

Run block_matching(const Scene& scene, bool checks, int threads) {
  return compute(block_matcher(scene.num_disparities, 9, checks), scene, threads);
}

Run semi_global(const Scene& scene, int mode) {
  constexpr int kBlock = 5;
  return compute(cv::StereoSGBM::create(0, scene.num_disparities, kBlock, 8 * kBlock * kBlock,
                                        32 * kBlock * kBlock, 1, 63, 10, 0, 0, mode),
                 scene, 1);
}

const Registration kOpenCv([](Registry& all) {
  all.engines.push_back({"StereoBM raw", [](const Scene& s) { return block_matching(s, false, 1); }});
  all.engines.push_back({"StereoBM full", [](const Scene& s) { return block_matching(s, true, 1); }});
  all.engines.push_back(
      {"StereoBM full, two threads", [](const Scene& s) { return block_matching(s, true, 2); }});
  all.engines.push_back(
      {"StereoSGBM 3WAY", [](const Scene& s) { return semi_global(s, cv::StereoSGBM::MODE_SGBM_3WAY); }});
  all.engines.push_back(
      {"StereoSGBM", [](const Scene& s) { return semi_global(s, cv::StereoSGBM::MODE_SGBM); }});
});

}  // namespace

Image<float> block_matched(const StereoPair& pair, int num_disparities, int window) {
  cv::Mat sixteenths;
  block_matcher(num_disparities, window, true)
      ->compute(timing::matrix(pair.left()), timing::matrix(pair.right()), sixteenths);
  return timing::disparity_px_of(sixteenths, 0);
}

Image<Gray> resized(const Image<Gray>& image, Size size) {
  return resized_by_opencv(image, size);
}
Image<Rgb> resized(const Image<Rgb>& image, Size size) {
  return resized_by_opencv(image, size);
}

}  // namespace cairn::lab
