// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/cairn.hpp>
#include <cairn/opencv.hpp>
#include <cstdio>

namespace {

int count_objects(const cv::Mat& left_bgr, const cv::Mat& right_bgr, const cairn::StereoRig& rig,
                  const cairn::Config& config) {
  // [readme]
  const auto pair = cairn::stereo_pair(left_bgr, right_bgr);  // CV_8UC3 as cv::imread gives them, or CV_8UC1
  const auto frame = cairn::segment(pair, rig, config, cairn::Exec::with_threads(0));

  // Headers over the frame's own pixels: valid as long as the frame is.
  const cv::Mat disparity = cairn::mat_of(frame.disparity.disparity_px);  // CV_32FC1, NaN = hole
  const cv::Mat labels = cairn::mat_of(frame.objects.labels);             // CV_32SC1, 0 = no object
  // [/readme]
  std::printf("%d disparities, %d pixels of objects\n", cv::countNonZero(disparity == disparity),
              cv::countNonZero(labels));
  return static_cast<int>(frame.objects.list.size());
}

}  // namespace

/// From cv::Mat to cv::Mat, with OpenCV linked by the consumer alone.
int main() {
  cv::Mat left(48, 64, CV_8UC3);
  cv::randu(left, 0, 256);
  cairn::Config config;
  config.match.num_disparities = 16;
  std::printf("matrices: %d objects\n", count_objects(left, left, {60, 31.5F, 23.5F, 0.1F, 0}, config));
  try {
    (void)cairn::stereo_pair(left, cv::Mat(48, 64, CV_8UC1));
  } catch (const cairn::Error& error) {
    std::printf("matrices: %s\n", error.what());
    return 0;
  }
  return 1;
}
