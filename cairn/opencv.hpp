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

/// cv::Mat in and out without a copy, for programs that use OpenCV anyway: they link it themselves
/// (opencv_core), the library knows nothing of it, and cairn.hpp does not include this header.
///
///   const auto pair = cairn::stereo_pair(left, right);                             // cv::Mat, CV_8UC1
///   const auto frame = cairn::segment(pair, rig, config, exec);
///   const cv::Mat disparity = cairn::mat_of(frame.disparity.disparity_px);         // CV_32FC1, NaN = hole
///   const cv::Mat labels = cairn::mat_of(frame.objects.labels);                    // CV_32SC1, 0 = none
namespace cairn {

/// OpenCV's number of the pixel type T: CV_8UC1 for Gray, CV_16UC1 for Reject, CV_8UC3 for Rgb, CV_32SC1 for
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

/// What usually stands behind a wrong type, and how to put it right; empty where nothing is known.
template <class T>
std::string way_out(int found) {
  if (std::is_same_v<T, Gray> && found == CV_8UC3) return "; cv::cvtColor with COLOR_BGR2GRAY makes it grey";
  if (std::is_same_v<T, float> && found == CV_16SC1)
    return "; StereoBM and StereoSGBM count in 1/16 px: convertTo with CV_32F and 1.0 / 16";
  return {};
}

}  // namespace opencv_detail

/// The pixels of `mat`, which must live on and keep its size as long as the view is used. An empty matrix
/// gives an empty view. Rgb means what it says: OpenCV's own order is BGR, and cv::cvtColor with
/// COLOR_BGR2RGB turns it. Throws Error naming `what` where the matrix has other pixels than T, more than two
/// dimensions, or rows that are not a whole number of pixels apart.
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

/// A rectified pair that borrows its matrices: `left` and `right` CV_8UC1, `left_rgb` CV_8UC3 in the order
/// R, G, B, or empty. Throws Error as view_of() and StereoPair::from() do.
inline StereoPair stereo_pair(const cv::Mat& left, const cv::Mat& right, const cv::Mat& left_rgb = {}) {
  return StereoPair::from(view_of<Gray>(left, "left"), view_of<Gray>(right, "right"),
                          view_of<Rgb>(left_rgb, "left_rgb"));
}

/// A header over the view's pixels: they are not copied, and the matrix does not own them. OpenCV knows no
/// matrix of const pixels: do not write into one made from const pixels.
template <class T>
cv::Mat mat_of(View<T> view) {
  using Pixel = std::remove_const_t<T>;
  if (view.empty()) return cv::Mat(view.height(), view.width(), mat_type<Pixel>());
  return cv::Mat(view.height(), view.width(), mat_type<Pixel>(), const_cast<Pixel*>(view.data()),
                 static_cast<std::size_t>(view.stride()) * sizeof(T));
}
/// The same over an image, which must live on as long as the matrix is used.
template <class T>
cv::Mat mat_of(Image<T>& image) {
  return mat_of(image.view());
}
template <class T>
cv::Mat mat_of(const Image<T>& image) {
  return mat_of(image.view());
}
template <class T>
cv::Mat mat_of(Image<T>&& image) = delete;  // the pixels would be gone before the matrix is

}  // namespace cairn
