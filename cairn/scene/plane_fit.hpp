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

  /// Of the points added, one at least; means of x and y are relative to the origin.
  struct Moments {
    double mean_x, mean_y, mean_d;
    double var_x, var_y, cov_xy, cov_xd, cov_yd;
    [[nodiscard]] double determinant() const { return var_x * var_y - cov_xy * cov_xy; }
    /// a and b. Precondition: determinant() > 0.
    [[nodiscard]] double slope_x() const { return (var_y * cov_xd - cov_xy * cov_yd) / determinant(); }
    [[nodiscard]] double slope_y() const { return (var_x * cov_yd - cov_xy * cov_xd) / determinant(); }
  };
  [[nodiscard]] Moments moments() const {
    const double mean_x = x_ / n_;
    const double mean_y = y_ / n_;
    return {mean_x,
            mean_y,
            d_ / n_,
            xx_ / n_ - mean_x * mean_x,
            yy_ / n_ - mean_y * mean_y,
            xy_ / n_ - mean_x * mean_y,
            xd_ / n_ - mean_x * d_ / n_,
            yd_ / n_ - mean_y * d_ / n_};
  }
  [[nodiscard]] double count() const { return n_; }

  /// nullopt if the points are (nearly) collinear: narrower than a pixel.
  [[nodiscard]] std::optional<GroundPlane> solve() const {
    if (n_ < 3) return std::nullopt;
    const Moments m = moments();
    const double determinant = m.determinant();
    // The determinant is the product of the variances along and across the cloud; their sum bounds the
    // former.
    constexpr double kMinVariance = 0.25;
    if (!(determinant >= kMinVariance * (m.var_x + m.var_y)) || !(determinant > 0)) return std::nullopt;
    const double a = m.slope_x();
    const double b = m.slope_y();
    const double c = m.mean_d - a * (m.mean_x + origin_x_) - b * (m.mean_y + origin_y_);
    return GroundPlane{static_cast<float>(a), static_cast<float>(b), static_cast<float>(c)};
  }

 private:
  double origin_x_;
  double origin_y_;
  double n_ = 0, x_ = 0, y_ = 0, d_ = 0, xx_ = 0, xy_ = 0, yy_ = 0, xd_ = 0, yd_ = 0;
};

}  // namespace cairn
