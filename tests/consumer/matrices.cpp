// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/cairn.hpp>
#include <cairn/opencv.hpp>
#include <cstdio>

/// From cv::Mat to cv::Mat, with OpenCV linked by the consumer alone.
int main() {
  cv::Mat left(48, 64, CV_8UC1);
  cv::randu(left, 0, 256);
  cairn::Config config;
  config.match.num_disparities = 16;
  const cairn::Frame frame = cairn::segment(cairn::stereo_pair(left, left), {}, config, {});
  const cv::Mat disparity = cairn::mat_of(frame.disparity.disparity_px);
  std::printf("matrices: %d x %d\n", disparity.cols, disparity.rows);
  return disparity.data == reinterpret_cast<const uchar*>(frame.disparity.disparity_px.row(0)) ? 0 : 1;
}
