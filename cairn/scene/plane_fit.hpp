// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/scene/ground_plane.hpp>
#include <cmath>
#include <optional>

namespace cairn {

/// Least-squares fit of d = a·x + b·y + c, point by point. Coordinates are relative to an origin amid the
/// points, which avoids cancellation in the sums.
class PlaneFit {
 public:
  PlaneFit(double origin_x, double origin_y) : origin_x_(origin_x), origin_y_(origin_y) {}

  void add(double x, double y, double d) {
    x -= origin_x_;
    y -= origin_y_;
    n_ += 1;
    x_ += x;
    y_ += y;
    d_ += d;
    xx_ += x * x;
    xy_ += x * y;
    yy_ += y * y;
    xd_ += x * d;
    yd_ += y * d;
  }

  /// nullopt if the points are (nearly) collinear: narrower than a pixel.
  [[nodiscard]] std::optional<GroundPlane> solve() const {
    if (n_ < 3) return std::nullopt;
    const double mean_x = x_ / n_;
    const double mean_y = y_ / n_;
    const double var_x = xx_ / n_ - mean_x * mean_x;
    const double var_y = yy_ / n_ - mean_y * mean_y;
    const double cov_xy = xy_ / n_ - mean_x * mean_y;
    const double determinant = var_x * var_y - cov_xy * cov_xy;
    // The determinant is the product of the variances along and across the cloud; their sum bounds the
    // former.
    constexpr double kLeastVariance = 0.25;
    if (!(determinant >= kLeastVariance * (var_x + var_y)) || !(determinant > 0)) return std::nullopt;
    const double cov_xd = xd_ / n_ - mean_x * d_ / n_;
    const double cov_yd = yd_ / n_ - mean_y * d_ / n_;
    const double a = (var_y * cov_xd - cov_xy * cov_yd) / determinant;
    const double b = (var_x * cov_yd - cov_xy * cov_xd) / determinant;
    const double c = d_ / n_ - a * (mean_x + origin_x_) - b * (mean_y + origin_y_);
    return GroundPlane{static_cast<float>(a), static_cast<float>(b), static_cast<float>(c)};
  }

 private:
  double origin_x_;
  double origin_y_;
  double n_ = 0, x_ = 0, y_ = 0, d_ = 0, xx_ = 0, xy_ = 0, yy_ = 0, xd_ = 0, yd_ = 0;
};

}  // namespace cairn
