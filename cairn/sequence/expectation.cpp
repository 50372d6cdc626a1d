// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cmath>
#include <numbers>

#include <cairn/sequence/landmark_geometry.hpp>

namespace cairn {

using landmarks::matrix;

Expectation expect(const Landmark& landmark, const LandmarkFrame& frame, const Pose& map_from_odom) {
  constexpr double kCore = 0.7;     // of the ellipse: its rim often shows background
  constexpr double kInView = 0.85;  // of the samples
  constexpr double kSigma_px = 0.35;
  constexpr double kSigmas = 3;
  constexpr int kSide = 13;  // samples across
  constexpr double kNearest_m = 0.3;
  Expectation result;
  const Pose map_from_camera = map_from_odom * frame.odom_from_camera;
  const Pose camera_from_map = inverse(map_from_camera);
  const Point3 centre = camera_from_map(landmark.position_m);
  if (centre.z < kNearest_m) return result;
  const auto focal = static_cast<double>(frame.rig.focal_px);
  const double u = static_cast<double>(frame.rig.cx_px) + focal * centre.x / centre.z;
  const double v = static_cast<double>(frame.rig.cy_px) + focal * centre.y / centre.z;
  const int width = frame.disparity_px.width();
  const int height = frame.disparity_px.height();
  if (u < 0 || v < 0 || u >= width || v >= height) return result;
  const double across_m = (landmark.size.narrowest_m + landmark.size.widest_m) / 2;
  const double sigma_m = std::sqrt(matrix(landmark.covariance_m2).topLeftCorner<2, 2>().trace() / 2);
  const double a = focal * across_m / 2 / centre.z;
  const double b = focal * landmark.size.height_m / 2 / centre.z;
  // The core excludes the margin left by the landmark's position uncertainty.
  const double core_a = std::max(kCore * a / 2, kCore * a - focal * sigma_m / centre.z / 2);
  const double core_b = kCore * b;
  const double depth_sigma_px =
      focal * static_cast<double>(frame.rig.baseline_m) / (centre.z * centre.z) * sigma_m;
  const double margin = kSigmas * std::hypot(kSigma_px, depth_sigma_px);
  const auto disparity_at = [&](double z) {
    return focal * static_cast<double>(frame.rig.baseline_m) / z - static_cast<double>(frame.rig.doffs_px);
  };
  const double behind = disparity_at(centre.z + landmark.size.widest_m / 2) - margin;
  const double before = disparity_at(std::max(kNearest_m, centre.z - landmark.size.widest_m / 2)) + margin;
  // The floor just behind an object's base has nearly the same disparity; it is recognised by being flat.
  constexpr double kFlat_m = 0.06;
  constexpr double kAbove_m = 0.12;
  constexpr double kStands_m = 0.15;
  const bool stands = landmark.position_m.z - landmark.size.height_m / 2 < kStands_m;
  const double at_centre = disparity_at(centre.z) - kSigma_px;
  const auto is_floor = [&](int px, int py, double d) {
    if (!stands || d >= at_centre) return false;
    const auto seen =
        frame.rig.point_in_camera_m(static_cast<float>(px), static_cast<float>(py), static_cast<float>(d));
    if (!seen) return false;
    const Point3 p{static_cast<double>(seen->x), static_cast<double>(seen->y), static_cast<double>(seen->z)};
    const double height_m = map_from_camera(p).z;
    return std::abs(height_m) < kFlat_m && map_from_camera((centre.z / p.z) * p).z > height_m + kAbove_m;
  };
  int inside = 0;
  int wanted = 0;
  for (int j = 0; j < kSide; ++j) {
    for (int i = 0; i < kSide; ++i) {
      const double x = 2.0 * (i + 0.5) / kSide - 1;
      const double y = 2.0 * (j + 0.5) / kSide - 1;
      if (x * x + y * y > 1) continue;
      ++wanted;
      const int px = static_cast<int>(std::floor(u + x * core_a + 0.5));
      const int py = static_cast<int>(std::floor(v + y * core_b + 0.5));
      if (px < 0 || py < 0 || px >= width || py >= height) continue;
      ++inside;
      const auto d = static_cast<double>(frame.disparity_px(px, py));
      if (std::isnan(d)) {
        ++result.unknown;
      } else if (d < behind || is_floor(px, py, d)) {
        ++result.farther;
      } else if (d > before) {
        ++result.nearer;
      } else {
        ++result.agree;
      }
    }
  }
  if (inside < kInView * wanted) return {};
  result.in_view = static_cast<int>(std::numbers::pi * a * b);
  return result;
}

}  // namespace cairn
