// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <cairn/sequence/landmark_geometry.hpp>

namespace cairn {

using landmarks::matrix;

namespace {

constexpr double kNearest_m = 0.3;
constexpr double kSigma_px = 0.35;

/// What is expected of the pixels of a landmark: its ellipse in the image, and its disparities.
struct Silhouette {
  double u = 0, v = 0;                // px; of its centre
  double a = 0, b = 0;                // px; half axes
  double core_a = 0, core_b = 0;      // px; without the rim, which often shows background
  double behind = 0, before = 0;      // px; disparities farther or nearer than the landmark
  Point3 centre_m;                    // in the map
  double radius_m = 0, height_m = 0;  // of a cylinder inside it
  double above_m = 0;                 // a ray that enters it lower may show the floor in front of it
  bool stands = false;                // on the floor
};

/// nullopt if its centre is behind the camera, too near or outside the image.
std::optional<Silhouette> silhouette_of(const Landmark& landmark, const LandmarkFrame& frame,
                                        const Pose& camera_from_map) {
  constexpr double kCore = 0.7;  // of the ellipse
  constexpr double kSigmas = 3;
  constexpr double kStands_m = 0.15;
  const Point3 centre = camera_from_map(landmark.position_m);
  if (centre.z < kNearest_m) return std::nullopt;
  Silhouette s;
  const auto focal = static_cast<double>(frame.rig.focal_px);
  s.u = static_cast<double>(frame.rig.cx_px) + focal * centre.x / centre.z;
  s.v = static_cast<double>(frame.rig.cy_px) + focal * centre.y / centre.z;
  if (s.u < 0 || s.v < 0 || s.u >= frame.disparity_px.width() || s.v >= frame.disparity_px.height())
    return std::nullopt;
  const double across_m = (landmark.size.narrowest_m + landmark.size.widest_m) / 2;
  const double sigma_m = std::sqrt(matrix(landmark.covariance_m2).topLeftCorner<2, 2>().trace() / 2);
  s.a = focal * across_m / 2 / centre.z;
  s.b = focal * landmark.size.height_m / 2 / centre.z;
  // The core excludes the margin left by the landmark's position uncertainty.
  s.core_a = std::max(kCore * s.a / 2, kCore * s.a - focal * sigma_m / centre.z / 2);
  s.core_b = kCore * s.b;
  const double depth_sigma_px =
      focal * static_cast<double>(frame.rig.baseline_m) / (centre.z * centre.z) * sigma_m;
  const double margin = kSigmas * std::hypot(kSigma_px, depth_sigma_px);
  const auto disparity_at = [&](double z) {
    return focal * static_cast<double>(frame.rig.baseline_m) / z - static_cast<double>(frame.rig.doffs_px);
  };
  s.behind = disparity_at(centre.z + landmark.size.widest_m / 2) - margin;
  s.before = disparity_at(std::max(kNearest_m, centre.z - landmark.size.widest_m / 2)) + margin;
  constexpr double kInside = 0.9, kAbove_m = 0.12, kLeastAbove_m = 0.04, kLow = 0.3;
  s.centre_m = landmark.position_m;
  s.radius_m = std::max(kInside * landmark.size.narrowest_m - sigma_m, landmark.size.narrowest_m / 2) / 2;
  s.height_m = kInside * landmark.size.height_m;
  s.above_m = std::clamp(kLow * landmark.size.height_m, kLeastAbove_m, kAbove_m);
  s.stands = landmark.position_m.z - landmark.size.height_m / 2 < kStands_m;
  return s;
}

enum class Floor : std::uint8_t { none, seen_through, unclear };

/// Whether a pixel shows the floor and its ray passes through the landmark: a cylinder that stands there. Behind a low
/// object, or inside its outline on the floor, the floor has nearly the same disparity; it is recognised by being flat.
/// Unclear is what may as well be the object's lowest part.
Floor floor_at(const Silhouette& s, Point3 pixel, const LandmarkFrame& frame, const Pose& map_from_camera) {
  constexpr double kFlat_m = 0.06;
  if (!s.stands) return Floor::none;
  const auto seen = frame.rig.point_in_camera_m(static_cast<float>(pixel.x), static_cast<float>(pixel.y),
                                                static_cast<float>(pixel.z));
  if (!seen) return Floor::none;
  const Point3 p = map_from_camera(
      {static_cast<double>(seen->x), static_cast<double>(seen->y), static_cast<double>(seen->z)});
  if (std::abs(frame.height_m(*seen, p)) > std::min(kFlat_m, s.height_m / 2)) return Floor::none;
  const Point3 eye = map_from_camera.translation_m;
  // On the floor plan: where the way from the camera to the point is inside the circle, as shares of the way.
  const double dx = p.x - eye.x, dy = p.y - eye.y, ex = eye.x - s.centre_m.x, ey = eye.y - s.centre_m.y;
  const double squared = dx * dx + dy * dy, half = ex * dx + ey * dy;
  const double root = half * half - squared * (ex * ex + ey * ey - s.radius_m * s.radius_m);
  if (root <= 0 || squared <= 0) return Floor::none;
  const double enters = (-half - std::sqrt(root)) / squared;
  const double leaves = std::min((-half + std::sqrt(root)) / squared, 1.0);
  const double eye_height_m = frame.height_m({}, eye);
  const auto height_at = [&](double share) { return (1 - share) * eye_height_m; };
  if (enters <= 0 || enters >= leaves || height_at(leaves) >= s.height_m) return Floor::none;
  return height_at(enters) > s.above_m ? Floor::seen_through : Floor::unclear;
}

}  // namespace

Expectation expect(const Landmark& landmark, const LandmarkFrame& frame, const Pose& map_from_odom) {
  constexpr double kInView = 0.85;  // of the samples
  constexpr int kSide = 13;         // samples across
  const Pose map_from_camera = map_from_odom * frame.odom_from_camera;
  const std::optional<Silhouette> s = silhouette_of(landmark, frame, inverse(map_from_camera));
  Expectation result;
  if (!s) return result;
  int inside = 0;
  int wanted = 0;
  int unclear = 0;
  for (int j = 0; j < kSide; ++j) {
    for (int i = 0; i < kSide; ++i) {
      const double x = 2.0 * (i + 0.5) / kSide - 1;
      const double y = 2.0 * (j + 0.5) / kSide - 1;
      if (x * x + y * y > 1) continue;
      ++wanted;
      const int px = static_cast<int>(std::floor(s->u + x * s->core_a + 0.5));
      const int py = static_cast<int>(std::floor(s->v + y * s->core_b + 0.5));
      if (!frame.disparity_px.contains(px, py)) continue;
      ++inside;
      const auto d = static_cast<double>(frame.disparity_px(px, py));
      const Floor floor =
          std::isnan(d) ? Floor::none : floor_at(*s, {double(px), double(py), d}, frame, map_from_camera);
      if (std::isnan(d)) {
        ++result.unknown;
      } else if (d < s->behind || floor == Floor::seen_through) {
        ++result.farther;
      } else if (floor == Floor::unclear) {
        ++unclear;
      } else if (d > s->before) {
        ++result.nearer;
      } else {
        ++result.agree;
      }
    }
  }
  if (result.samples() < wanted / 4) result.unknown += unclear;
  if (inside < kInView * wanted) return {};
  result.in_view = static_cast<int>(std::numbers::pi * s->a * s->b);
  return result;
}

}  // namespace cairn
