// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/timing/opencv_matchers.hpp>

#include <array>
#include <cairn/core/error.hpp>
#include <cstdlib>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <utility>

#include <cairn/timing/opencv_matrix.hpp>

namespace cairn::timing {

struct ReadyMatcher::State {
  cv::Ptr<cv::StereoMatcher> matcher;
  cv::Mat sixteenths;
};

namespace {

ReadyMatcher ready(cv::Ptr<cv::StereoMatcher> matcher) {
  return ReadyMatcher(std::make_shared<ReadyMatcher::State>(ReadyMatcher::State{std::move(matcher), {}}));
}

ReadyMatcher block_matching(const SearchRange& range) {
  constexpr int kWindow = 9;
  auto matcher = cv::StereoBM::create(searched_by_opencv(range.num_disparities), kWindow);
  matcher->setMinDisparity(range.min_disparity);
  matcher->setDisp12MaxDiff(1);
  return ready(std::move(matcher));
}

ReadyMatcher semi_global(const SearchRange& range, int mode) {
  constexpr int kBlock = 5;
  constexpr int kSmallPenalty = 8 * kBlock * kBlock;
  constexpr int kLargePenalty = 32 * kBlock * kBlock;
  constexpr int kMaxDisagreement = 1;
  constexpr int kPrefilterCap = 63;
  constexpr int kUniqueness = 10;
  constexpr int kSpeckleSize = 100;
  constexpr int kSpeckleRange = 2;
  return ready(cv::StereoSGBM::create(range.min_disparity, searched_by_opencv(range.num_disparities), kBlock,
                                      kSmallPenalty, kLargePenalty, kMaxDisagreement, kPrefilterCap,
                                      kUniqueness, kSpeckleSize, kSpeckleRange, mode));
}

ReadyMatcher semi_global_3_paths(const SearchRange& range) {
  return semi_global(range, cv::StereoSGBM::MODE_SGBM_3WAY);
}
ReadyMatcher semi_global_5_paths(const SearchRange& range) {
  return semi_global(range, cv::StereoSGBM::MODE_SGBM);
}

constexpr OpenCvMatcher kBlockMatching{
    "StereoBM", "window 9, x-Sobel with cap 31, uniqueness 15, texture 10, left-right 1, no speckle filter",
    block_matching};
constexpr std::string_view kSemiGlobalSettings =
    "block 5, P1 200, P2 800, prefilter cap 63, uniqueness 10, left-right 1, speckles 100 px within 2";
constexpr OpenCvMatcher kSemiGlobal{"StereoSGBM", kSemiGlobalSettings, semi_global_5_paths};

constexpr std::array kQuick{
    kBlockMatching, OpenCvMatcher{"StereoSGBM 3-way", "like StereoSGBM, with 3 paths", semi_global_3_paths},
    kSemiGlobal};

}  // namespace

void ReadyMatcher::compute(const StereoPair& pair) const {
  // For narrower images OpenCV 4.6 throws on its own threads, which cannot be caught.
  constexpr int kMargin = 16;
  const cv::StereoMatcher& matcher = *state_->matcher;
  const int least_width = matcher.getNumDisparities() + std::abs(matcher.getMinDisparity()) + kMargin;
  if (pair.size().width < least_width || pair.size().height < kMargin) {
    throw Error("needs at least " + text(Size{least_width, kMargin}) + " px");
  }
  try {
    state_->matcher->compute(matrix(pair.left()), matrix(pair.right()), state_->sixteenths);
  } catch (const cv::Exception& refusal) {
    throw Error(refusal.err);
  }
}

Image<float> ReadyMatcher::disparity_px() const {
  return disparity_px_of(state_->sixteenths, state_->matcher->getMinDisparity());
}

std::span<const OpenCvMatcher> quick_opencv_matchers() {
  return kQuick;
}

std::string_view opencv_version() {
  return CV_VERSION;
}

void set_opencv_threads(int threads) {
  cv::setNumThreads(threads);
}

}  // namespace cairn::timing
