// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/cairn.hpp>
#include <cairn/opencv.hpp>
#include <cstring>
#include <opencv2/imgproc.hpp>
#include <string>
#include <type_traits>
#include <utility>

#include "support/samples.hpp"

namespace cairn {
namespace {

template <class Work>
std::string error_of(Work work) {
  try {
    work();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

/// The same pixels in memory allocated by OpenCV.
template <class T>
cv::Mat copy_of(const Image<T>& image) {
  return mat_of(image).clone();
}

template <class T>
bool same_bits(const Image<T>& a, const Image<T>& b) {
  if (a.size() != b.size()) return false;
  for (int y = 0; y < a.height(); ++y) {
    if (std::memcmp(a.row(y), b.row(y), sizeof(T) * static_cast<std::size_t>(a.width())) != 0) return false;
  }
  return true;
}

template <class T>
concept GivesMat = requires(T&& image) {
  mat_of(std::forward<T>(image));
};

TEST(OpenCv, ViewsTheMatricesOwnPixels) {
  const cv::Mat left(3, 5, CV_8UC1);
  const cv::Mat right(3, 5, CV_8UC1);
  const cv::Mat rgb(3, 5, CV_8UC3);
  const auto pair = stereo_pair(left, right, rgb);
  EXPECT_EQ(pair.left().data(), left.data);
  EXPECT_EQ(pair.right().data(), right.data);
  EXPECT_EQ(static_cast<const void*>(pair.left_rgb().data()), rgb.data);
  EXPECT_EQ(pair.size(), (Size{5, 3}));
}

TEST(OpenCv, ViewsAPartOfAMatrixWithItsStride) {
  cv::Mat whole(6, 10, CV_8UC3, cv::Scalar(0, 0, 0));
  const cv::Mat part = whole(cv::Rect(4, 2, 3, 4));
  whole.at<cv::Vec3b>(3, 6) = {1, 2, 3};
  const View<const Rgb> view = view_of<Rgb>(part);
  EXPECT_EQ(view.size(), (Size{3, 4}));
  EXPECT_EQ(view.stride(), 10);
  EXPECT_EQ(view(2, 1), (Rgb{1, 2, 3}));
}

TEST(OpenCv, PutsHeadersOverTheImagesOwnPixels) {
  Image<float> disparity({7, 3}, 1.5F, {});
  const cv::Mat mat = mat_of(disparity);
  EXPECT_EQ(mat.data, reinterpret_cast<uchar*>(disparity.row(0)));
  EXPECT_EQ(mat.type(), CV_32FC1);
  EXPECT_EQ(mat.size(), cv::Size(7, 3));
  disparity(6, 2) = 9;
  EXPECT_EQ(mat.at<float>(2, 6), 9);

  const Image<ObjectId> labels({7, 3}, ObjectId{4}, {});
  EXPECT_EQ(mat_of(labels).data, reinterpret_cast<const uchar*>(labels.row(0)));
  EXPECT_EQ(mat_of(labels).at<int>(2, 6), 4);
  EXPECT_EQ(mat_of(View<const Reject>{}).type(), CV_16UC1);
  EXPECT_TRUE(mat_of(View<const Reject>{}).empty());
}

TEST(OpenCv, SegmentsMatricesAsItDoesImages) {
  const samples::Sample sample = samples::load("four_in_a_row");
  const cv::Mat left = copy_of(sample.images.left.gray);
  const cv::Mat right = copy_of(sample.images.right.gray);
  const cv::Mat rgb = copy_of(sample.images.left.rgb);
  const Config config = sample.suited();
  const Frame expected = segment(sample.pair(), sample.calibration.rig, config, {});
  const auto pair = stereo_pair(left, right, rgb);
  const Frame frame = segment(pair, sample.calibration.rig, config, {});
  EXPECT_TRUE(same_bits(frame.disparity.disparity_px, expected.disparity.disparity_px));
  EXPECT_TRUE(same_bits(frame.objects.labels, expected.objects.labels));
  EXPECT_FALSE(frame.objects.list.empty());
}

TEST(OpenCv, SegmentsColourInOpenCvsOrderAsItDoesFiles) {
  const samples::Sample sample = samples::load("four_in_a_row");
  const auto bgr_of = [](const io::LoadedImage& picture) {
    cv::Mat bgr;
    cv::cvtColor(mat_of(picture.rgb), bgr, cv::COLOR_RGB2BGR);
    return bgr;
  };
  const cv::Mat left = bgr_of(sample.images.left);
  const cv::Mat right = bgr_of(sample.images.right);
  auto made = stereo_pair(left, right);
  const auto pair = std::move(made);  // keeps the pixels alive
  const Config config = sample.suited();
  const Frame expected = segment(sample.pair(), sample.calibration.rig, config, {});
  const Frame frame = segment(pair, sample.calibration.rig, config, {});
  EXPECT_TRUE(same_bits(frame.disparity.disparity_px, expected.disparity.disparity_px));
  EXPECT_TRUE(same_bits(frame.objects.labels, expected.objects.labels));
  EXPECT_EQ(pair.left_rgb()(3, 5), sample.images.left.rgb(3, 5));
  EXPECT_FALSE((std::is_convertible_v<MatPair, const StereoPair&>));  // its pixels would be freed
  EXPECT_TRUE((std::is_convertible_v<const MatPair&, const StereoPair&>));
}

TEST(OpenCv, RefusesWrongTypesByName) {
  const cv::Mat gray(3, 5, CV_8UC1);
  const cv::Mat bgr(3, 5, CV_8UC3);
  EXPECT_EQ(
      error_of([&] { stereo_pair(gray, bgr); }),
      "right: found pixels of CV_8UC3, expected CV_8UC1; cv::cvtColor with COLOR_BGR2GRAY makes it grey");
  EXPECT_EQ(error_of([&] { stereo_pair(bgr, gray); }), "right: found pixels of CV_8UC1, expected CV_8UC3");
  EXPECT_EQ(error_of([&] { stereo_pair(gray, gray, gray); }),
            "left_rgb: found pixels of CV_8UC1, expected CV_8UC3");
  EXPECT_EQ(
      error_of([&] { view_of<float>(cv::Mat(3, 5, CV_16SC1), "disparity"); }),
      "disparity: found pixels of CV_16SC1, expected CV_32FC1; StereoBM and StereoSGBM count in 1/16 px: "
      "convertTo with CV_32F and 1.0 / 16");
}

TEST(OpenCv, RefusesMatricesThatNoViewCanRepresent) {
  const int sizes[] = {2, 3, 4};
  EXPECT_EQ(error_of([&] { view_of<Gray>(cv::Mat(3, sizes, CV_8UC1), "left"); }),
            "left: found 3 dimensions, expected 2");
  std::string bytes(64, '\0');
  const cv::Mat odd(3, 5, CV_8UC3, bytes.data(), 16);
  EXPECT_EQ(error_of([&] { view_of<Rgb>(odd, "left_rgb"); }),
            "left_rgb: rows are 16 bytes apart, expected a multiple of 3; clone() makes them so");
  EXPECT_NE(error_of([] { stereo_pair(cv::Mat(), cv::Mat()); }), "no error");
}

TEST(OpenCv, DoesNotCompileForATemporaryImage) {
  EXPECT_TRUE(GivesMat<Image<float>&>);
  EXPECT_TRUE(GivesMat<const Image<float>&>);
  EXPECT_FALSE(GivesMat<Image<float>>);
}

}  // namespace
}  // namespace cairn
