// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/error.hpp>
#include <cairn/core/image.hpp>
#include <cairn/core/stereo_pair.hpp>
#include <cstddef>
#include <opencv2/core.hpp>
#include <string>
#include <string_view>
#include <type_traits>

/// Conversion from and to cv::Mat, for programs that link OpenCV (opencv_core) themselves. The library does
/// not depend on OpenCV, and cairn.hpp does not include this header.
///
///   const auto pair = cairn::stereo_pair(left_bgr, right_bgr);  // as from cv::imread
///   const auto frame = cairn::segment(pair, rig, config, exec);
///   const cv::Mat disparity = cairn::mat_of(frame.disparity.disparity_px);  // CV_32FC1, NaN = hole
///   const cv::Mat labels = cairn::mat_of(frame.objects.labels);             // CV_32SC1, 0 = none
namespace cairn {

/// The OpenCV type of the pixel type T: CV_8UC1 for Gray, CV_16UC1 for Reject, CV_8UC3 for Rgb, CV_32SC1 for
/// RegionId and ObjectId, CV_32FC1 for float, and so on.
template <class T>
constexpr int mat_type() {
  if constexpr (std::is_same_v<T, Rgb>) {
    return CV_8UC3;
  } else if constexpr (std::is_enum_v<T>) {
    return cv::DataType<std::underlying_type_t<T>>::type;
  } else {
    return cv::DataType<T>::type;
  }
}

namespace opencv_detail {

/// The usual cause of a wrong type and its remedy; empty if unknown.
template <class T>
std::string way_out(int found) {
  if (std::is_same_v<T, Gray> && found == CV_8UC3) return "; cv::cvtColor with COLOR_BGR2GRAY makes it grey";
  if (std::is_same_v<T, float> && found == CV_16SC1)
    return "; StereoBM and StereoSGBM count in 1/16 px: convertTo with CV_32F and 1.0 / 16";
  return {};
}

}  // namespace opencv_detail

/// The pixels of `mat`, which must outlive the view and keep its size. An empty matrix gives an empty view.
/// Rgb is in the order R, G, B: convert OpenCV's BGR by cv::cvtColor with COLOR_BGR2RGB. Throws Error naming
/// `what` if the pixels are not of type T, the matrix has more than two dimensions, or its rows are not a
/// whole number of pixels apart.
template <class T>
View<const T> view_of(const cv::Mat& mat, std::string_view what = "cv::Mat") {
  if (mat.empty()) return {};
  const std::string name(what);
  if (mat.dims != 2) {
    throw Error(name + ": found " + std::to_string(mat.dims) + " dimensions, expected 2");
  }
  if (mat.type() != mat_type<T>()) {
    throw Error(name + ": found pixels of " + cv::typeToString(mat.type()) + ", expected " +
                cv::typeToString(mat_type<T>()) + opencv_detail::way_out<T>(mat.type()));
  }
  if (mat.step[0] % sizeof(T) != 0) {
    throw Error(name + ": rows are " + std::to_string(mat.step[0]) + " bytes apart, expected a multiple of " +
                std::to_string(sizeof(T)) + "; clone() makes them so");
  }
  return {mat.ptr<T>(), {mat.cols, mat.rows}, static_cast<std::ptrdiff_t>(mat.step[0] / sizeof(T))};
}

namespace opencv_detail {

/// Grey and colour of a CV_8UC3 matrix in OpenCV's order; the grey is that of cairn's file readers.
inline void convert(const cv::Mat& bgr, std::string_view what, Image<Gray>& gray, Image<Rgb>* rgb) {
  const View<const Rgb> from = view_of<Rgb>(bgr, what);  // r holds B
  gray = Image<Gray>(from.size());
  if (rgb != nullptr) *rgb = Image<Rgb>(from.size());
  for (int y = 0; y < from.height(); ++y) {
    for (int x = 0; x < from.width(); ++x) {
      const Rgb c = from(x, y);
      gray(x, y) = static_cast<Gray>((77 * c.b + 150 * c.g + 29 * c.r + 128) >> 8);
      if (rgb != nullptr) (*rgb)(x, y) = {c.b, c.g, c.r};
    }
  }
}

}  // namespace opencv_detail

/// A rectified pair of matrices that converts to StereoPair. Grey matrices are borrowed and must outlive it;
/// for coloured ones it owns grey and colour. It must be a named variable: the pixels of a temporary would be
/// gone.
class MatPair {
 public:
  MatPair(const cv::Mat& left, const cv::Mat& right, const cv::Mat& left_rgb)
      : pair_(StereoPair::from(view_of<Gray>(left, "left"), view_of<Gray>(right, "right"),
                               view_of<Rgb>(left_rgb, "left_rgb"))) {}
  MatPair(const cv::Mat& left_bgr, const cv::Mat& right_bgr)
      : pair_((opencv_detail::convert(left_bgr, "left", left_, &left_rgb_),
               opencv_detail::convert(right_bgr, "right", right_, nullptr),
               StereoPair::from(left_, right_, left_rgb_))) {}

  operator const StereoPair&() const& {
    return pair_;
  }  // NOLINT(google-explicit-constructor): MatPair is a StereoPair
  operator const StereoPair&() && = delete;
  [[nodiscard]] View<const Gray> left() const { return pair_.left(); }
  [[nodiscard]] View<const Gray> right() const { return pair_.right(); }
  [[nodiscard]] View<const Rgb> left_rgb() const { return pair_.left_rgb(); }
  [[nodiscard]] Size size() const { return pair_.size(); }

 private:
  Image<Gray> left_;  // empty if the matrices are borrowed
  Image<Gray> right_;
  Image<Rgb> left_rgb_;
  StereoPair pair_;
};

/// Two CV_8UC3 matrices in OpenCV's order B, G, R; or two CV_8UC1 and `left_rgb`, a CV_8UC3 matrix in the
/// order R, G, B, or empty. Throws Error like view_of() and StereoPair::from().
inline MatPair stereo_pair(const cv::Mat& left, const cv::Mat& right, const cv::Mat& left_rgb = {}) {
  if (left.type() == CV_8UC3 && left_rgb.empty()) return {left, right};
  return {left, right, left_rgb};
}

/// A matrix header over the pixels of the view, without a copy and without ownership. OpenCV has no matrix of
/// const pixels: do not write to one made from const pixels.
template <class T>
cv::Mat mat_of(View<T> view) {
  using Pixel = std::remove_const_t<T>;
  if (view.empty()) return cv::Mat(view.height(), view.width(), mat_type<Pixel>());
  return cv::Mat(view.height(), view.width(), mat_type<Pixel>(), const_cast<Pixel*>(view.data()),
                 static_cast<std::size_t>(view.stride()) * sizeof(T));
}
/// The same for an image, which must outlive the matrix.
template <class T>
cv::Mat mat_of(Image<T>& image) {
  return mat_of(image.view());
}
template <class T>
cv::Mat mat_of(const Image<T>& image) {
  return mat_of(image.view());
}
template <class T>
cv::Mat mat_of(Image<T>&& image) = delete;  // the matrix would outlive its pixels

}  // namespace cairn
