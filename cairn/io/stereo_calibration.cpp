// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/core/error.hpp>
#include <cairn/io/calibration_forms.hpp>
#include <cairn/io/stereo_calibration.hpp>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <string>

namespace cairn::io {
namespace {

/// OpenCV's exceptions as a single line.
template <class Work>
auto with_opencv(const char* doing, Work work) {
  try {
    return work();
  } catch (const cv::Exception& exception) {
    throw Error(std::string(doing) + ": OpenCV says: " + exception.err);
  }
}

template <std::size_t N>
cv::Mat matrix(const std::array<double, N>& numbers, int rows) {
  return cv::Mat(rows, static_cast<int>(N) / rows, CV_64F, const_cast<double*>(numbers.data())).clone();
}

template <std::size_t N>
std::array<double, N> numbers_of(const cv::Mat& matrix) {
  const cv::Mat flat = matrix.reshape(1, 1);
  std::array<double, N> numbers{};
  for (std::size_t i = 0; i < N; ++i) numbers[i] = flat.at<double>(0, static_cast<int>(i));
  return numbers;
}

cv::Size size_of(Size size) {
  return {size.width, size.height};
}

std::vector<cv::Point2f> points_of(const Corners& corners) {
  std::vector<cv::Point2f> points;
  for (const auto& [x, y] : corners) points.emplace_back(x, y);
  return points;
}

/// Rotations and projections of the rectified pair if the calibration does not contain them. The rectified
/// images have no empty pixels (alpha = 0), and doffs is 0.
RawCalibration with_rectification(RawCalibration raw) {
  if (raw.left.rotation && raw.left.projection && raw.right.rotation && raw.right.projection) return raw;
  cv::Mat left_rotation;
  cv::Mat right_rotation;
  cv::Mat left_projection;
  cv::Mat right_projection;
  cv::Mat reprojection;
  const cv::Mat rotation = matrix(*raw.rotation, 3);
  const cv::Mat translation = matrix(*raw.translation_m, 3);
  const cv::Size size = size_of(raw.image_size);
  if (raw.left.is_fisheye) {
    cv::fisheye::stereoRectify(matrix(raw.left.matrix, 3), raw.left.distortion, matrix(raw.right.matrix, 3),
                               raw.right.distortion, size, rotation, translation, left_rotation,
                               right_rotation, left_projection, right_projection, reprojection,
                               cv::CALIB_ZERO_DISPARITY);
  } else {
    cv::stereoRectify(matrix(raw.left.matrix, 3), raw.left.distortion, matrix(raw.right.matrix, 3),
                      raw.right.distortion, size, rotation, translation, left_rotation, right_rotation,
                      left_projection, right_projection, reprojection, cv::CALIB_ZERO_DISPARITY, 0);
  }
  raw.left.rotation = numbers_of<9>(left_rotation);
  raw.right.rotation = numbers_of<9>(right_rotation);
  raw.left.projection = numbers_of<12>(left_projection);
  raw.right.projection = numbers_of<12>(right_projection);
  return raw;
}

/// RMS of the row differences of rectified corners.
double rows_error(std::span<const BoardDetection> sightings, const RawCalibration& raw) {
  const auto rectified = [](const Corners& corners, const RawCamera& camera) {
    std::vector<cv::Point2f> points;
    cv::undistortPoints(points_of(corners), points, matrix(camera.matrix, 3), camera.distortion,
                        matrix(*camera.rotation, 3), matrix(*camera.projection, 3));
    return points;
  };
  double squares = 0;
  double count = 0;
  for (const BoardDetection& sighting : sightings) {
    const auto left = rectified(sighting.left, raw.left);
    const auto right = rectified(sighting.right, raw.right);
    for (std::size_t i = 0; i < left.size(); ++i) {
      const double rows = static_cast<double>(left[i].y) - static_cast<double>(right[i].y);
      squares += rows * rows;
      count += 1;
    }
  }
  return std::sqrt(squares / std::max(1.0, count));
}

/// Makes the corner order agree in both images: a board looks the same after half a turn.
std::vector<cv::Point2f> in_order_of(const std::vector<cv::Point2f>& left, std::vector<cv::Point2f> right) {
  const cv::Point2f along_left = left.back() - left.front();
  const cv::Point2f along_right = right.back() - right.front();
  if (along_left.dot(along_right) < 0) std::reverse(right.begin(), right.end());
  return right;
}

StereoCalibration calibrate(std::span<const BoardDetection> sightings, const Board& board, Size image) {
  std::vector<cv::Point3f> corners;
  for (int row = 0; row < board.rows; ++row) {
    for (int column = 0; column < board.columns; ++column) {
      corners.emplace_back(static_cast<float>(column * board.square_m),
                           static_cast<float>(row * board.square_m), 0.0F);
    }
  }
  const std::vector<std::vector<cv::Point3f>> boards(sightings.size(), corners);
  std::vector<std::vector<cv::Point2f>> left;
  std::vector<std::vector<cv::Point2f>> right;
  for (const BoardDetection& sighting : sightings) {
    left.push_back(points_of(sighting.left));
    right.push_back(in_order_of(left.back(), points_of(sighting.right)));
  }
  const cv::TermCriteria precisely(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 100, 1e-7);
  StereoCalibration result;
  std::vector<cv::Mat> turns;
  std::vector<cv::Mat> places;
  cv::Mat left_matrix;
  cv::Mat left_distortion;
  cv::Mat right_matrix;
  cv::Mat right_distortion;
  result.left_error_px = cv::calibrateCamera(boards, left, size_of(image), left_matrix, left_distortion,
                                             turns, places, 0, precisely);
  result.right_error_px = cv::calibrateCamera(boards, right, size_of(image), right_matrix, right_distortion,
                                              turns, places, 0, precisely);
  cv::Mat rotation;
  cv::Mat translation;
  cv::Mat essential;
  cv::Mat fundamental;
  cv::Mat errors;
  result.error_px = cv::stereoCalibrate(boards, left, right, left_matrix, left_distortion, right_matrix,
                                        right_distortion, size_of(image), rotation, translation, essential,
                                        fundamental, errors, cv::CALIB_USE_INTRINSIC_GUESS, precisely);
  for (int i = 0; i < errors.rows; ++i)
    result.pair_error_px.push_back(std::max(errors.at<double>(i, 0), errors.at<double>(i, 1)));
  result.raw.image_size = image;
  result.raw.left = {numbers_of<9>(left_matrix), left_distortion.reshape(1, 1), {}, {}};
  result.raw.right = {numbers_of<9>(right_matrix), right_distortion.reshape(1, 1), {}, {}};
  result.raw.rotation = numbers_of<9>(rotation);
  result.raw.translation_m = numbers_of<3>(translation);
  result.raw = with_rectification(std::move(result.raw));
  result.rows_error_px = rows_error(sightings, result.raw);
  return result;
}

cv::Mat borrowed(View<const Gray> image) {
  return {image.height(), image.width(), CV_8UC1, const_cast<Gray*>(image.data()),
          static_cast<std::size_t>(image.stride())};
}
cv::Mat borrowed(View<const Rgb> image) {
  return {image.height(), image.width(), CV_8UC3, const_cast<Rgb*>(image.data()),
          static_cast<std::size_t>(image.stride()) * sizeof(Rgb)};
}

template <class T>
Image<T> remapped(const Image<T>& image, const cv::Mat& x, const cv::Mat& y, const Pool& pool) {
  Image<T> result(image.size(), pool);
  cv::Mat out = borrowed(View<const T>(result.view()));
  cv::remap(borrowed(View<const T>(image.view())), out, x, y, cv::INTER_LINEAR, cv::BORDER_CONSTANT);
  return result;
}

}  // namespace

std::optional<Corners> find_board(View<const Gray> image, const Board& board) {
  return with_opencv("finding the board", [&]() -> std::optional<Corners> {
    const cv::Mat picture = borrowed(image);
    std::vector<cv::Point2f> points;
    const cv::Size inner(board.columns, board.rows);
    if (!cv::findChessboardCorners(picture, inner, points)) return std::nullopt;
    const cv::TermCriteria precisely(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 50, 1e-4);
    cv::cornerSubPix(picture, points, {5, 5}, {-1, -1}, precisely);
    Corners corners;
    for (const cv::Point2f& point : points) corners.push_back({point.x, point.y});
    return corners;
  });
}

StereoCalibration calibrate_stereo(std::span<const BoardDetection> sightings, const Board& board,
                                   Size image) {
  if (sightings.size() < kMinSightings) {
    throw Error("calibrating: the whole board is visible in " + std::to_string(sightings.size()) +
                " pairs, expected at least " + std::to_string(kMinSightings) + ", preferably fifteen");
  }
  return with_opencv("calibrating", [&] { return calibrate(sightings, board, image); });
}

/// The position in the raw image of each rectified pixel.
struct Rectifier::Maps {
  Size size;
  cv::Mat left_x;
  cv::Mat left_y;
  cv::Mat right_x;
  cv::Mat right_y;
};

Rectifier::Rectifier(const RawCalibration& calibration) try : maps_(std::make_unique<Maps>()) {
  with_opencv("rectifying", [&] {
    const RawCalibration raw = with_rectification(calibration);
    maps_->size = raw.image_size;
    const auto map = [&](const RawCamera& camera, cv::Mat& x, cv::Mat& y) {
      const cv::Mat lens = matrix(camera.matrix, 3);
      const cv::Mat rotation = matrix(*camera.rotation, 3);
      const cv::Mat projection = matrix(*camera.projection, 3);
      const cv::Size size = size_of(raw.image_size);
      if (camera.is_fisheye) {
        cv::fisheye::initUndistortRectifyMap(lens, camera.distortion, rotation, projection, size, CV_32FC1, x,
                                             y);
      } else {
        cv::initUndistortRectifyMap(lens, camera.distortion, rotation, projection, size, CV_32FC1, x, y);
      }
    };
    map(raw.left, maps_->left_x, maps_->left_y);
    map(raw.right, maps_->right_x, maps_->right_y);
    left_rotation_ = *raw.left.rotation;
    rig_ = rig_of(*raw.left.projection, *raw.right.projection);
    return 0;
  });
} catch (const Error& error) {
  throw Error((calibration.path.empty() ? "" : calibration.path.string() + ": ") + error.what());
}

Rectifier::~Rectifier() = default;

LoadedPair Rectifier::operator()(const LoadedPair& raw, const Pool& pool) const {
  if (raw.left.gray.size() != maps_->size) {
    throw Error("the calibration is for " + text(maps_->size) + ", the images are " +
                text(raw.left.gray.size()));
  }
  return with_opencv("rectifying", [&] {
    const auto rectified = [&](const LoadedImage& picture, const cv::Mat& x, const cv::Mat& y) {
      LoadedImage result{remapped(picture.gray, x, y, pool), {}};
      if (!picture.rgb.empty()) result.rgb = remapped(picture.rgb, x, y, pool);
      return result;
    };
    return LoadedPair{rectified(raw.left, maps_->left_x, maps_->left_y),
                      rectified(raw.right, maps_->right_x, maps_->right_y), raw.bits};
  });
}

}  // namespace cairn::io
