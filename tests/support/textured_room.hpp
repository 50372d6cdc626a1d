// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/stereo_pair.hpp>
#include <cairn/sequence/pose.hpp>
#include <cairn/stereo/disparity_map.hpp>
#include <cmath>
#include <limits>

/// A scene of textured planes, rendered from any pose with exact disparities.
namespace cairn::room {

inline const StereoRig kRig{
    .focal_px = 200, .cx_px = 119.5F, .cy_px = 89.5F, .baseline_m = 0.12F, .doffs_px = 0};
inline constexpr Size kSize{240, 180};

struct Seen {
  Image<Gray> left;
  DisparityMap disparity;
  [[nodiscard]] DisparityMap copy() const {
    return {disparity.disparity_px.clone(), disparity.reject.clone()};
  }
};

/// Hash of two integers, in 0 … 1.
inline double hashed(std::int64_t x, std::int64_t y) {
  auto h = static_cast<std::uint64_t>(x) * 0x9E3779B97F4A7C15ULL +
           static_cast<std::uint64_t>(y) * 0xC2B2AE3D27D4EB4FULL;
  h = (h ^ (h >> 29U)) * 0xBF58476D1CE4E5B9ULL;
  h = (h ^ (h >> 32U)) * 0x94D049BB133111EBULL;
  return static_cast<double>(h >> 40U) / static_cast<double>(1U << 24U);
}

/// Smooth noise of two scales.
inline double texture(double u_m, double v_m) {
  double sum = 0;
  double weight = 0.6;
  for (const double cell_m : {0.17, 0.08}) {
    const double u = u_m / cell_m;
    const double v = v_m / cell_m;
    const double fu = u - std::floor(u);
    const double fv = v - std::floor(v);
    const auto iu = static_cast<std::int64_t>(std::floor(u));
    const auto iv = static_cast<std::int64_t>(std::floor(v));
    const double su = fu * fu * (3 - 2 * fu);
    const double sv = fv * fv * (3 - 2 * fv);
    sum += weight * ((hashed(iu, iv) * (1 - su) + hashed(iu + 1, iv) * su) * (1 - sv) +
                     (hashed(iu, iv + 1) * (1 - su) + hashed(iu + 1, iv + 1) * su) * sv);
    weight = 0.4;
  }
  return sum;
}

/// A room that extends 6 m from the map's origin (x right, y down, z forward), with side walls, a floor, a
/// ceiling and a panel at 2.2 m, shifted `panel_m` to the right.
/// `scale`: factor on all lengths.
inline Seen look(const Pose& map_from_camera, double panel_m = 0, double scale = 1) {
  Seen seen{Image<Gray>(kSize), {Image<float>(kSize), Image<Reject>(kSize)}};
  seen.disparity.reject.fill(Reject::none);
  const Point3 from = map_from_camera.translation_m;
  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 0; x < kSize.width; ++x) {
      const Point3 ray = map_from_camera.rotated({(x - double{kRig.cx_px}) / double{kRig.focal_px},
                                                  (y - double{kRig.cy_px}) / double{kRig.focal_px}, 1});
      double nearest = std::numeric_limits<double>::infinity();  // depth, as the z of the ray is 1
      double value = 0;
      const auto wall = [&](double offset_m, double along, double at, auto&& uv) {
        const double t = (offset_m * scale - at) / along;
        if (!(t > 0.05) || t >= nearest) return;
        const Point3 p = from + t * ray;
        if (!uv(p)) return;
        nearest = t;
      };
      const auto paint = [&](double u, double v) {
        value = texture(u / scale, v / scale);
        return true;
      };
      wall(6, ray.z, from.z, [&](Point3 p) { return paint(p.x, p.y); });
      wall(-4, ray.z, from.z, [&](Point3 p) { return paint(p.x + 3, p.y); });
      wall(2.5, ray.x, from.x, [&](Point3 p) { return paint(p.z + 11, p.y); });
      wall(-2.5, ray.x, from.x, [&](Point3 p) { return paint(p.z + 23, p.y); });
      wall(1.0, ray.y, from.y, [&](Point3 p) { return paint(p.x, p.z + 31); });
      wall(-1.5, ray.y, from.y, [&](Point3 p) { return paint(p.x, p.z + 47); });
      wall(2.2, ray.z, from.z, [&](Point3 p) {
        const double u = p.x / scale - panel_m;
        if (std::abs(u) > 0.35 || std::abs(p.y / scale) > 0.3) return false;
        constexpr double kFiner = 2.5;  // gives it as many corners as its background
        value = texture(kFiner * (u + 61), kFiner * p.y / scale);
        return true;
      });
      seen.left(x, y) = static_cast<Gray>(std::lround(20 + 215 * value));
      seen.disparity.disparity_px(x, y) =
          static_cast<float>(double{kRig.focal_px} * double{kRig.baseline_m} / nearest);
    }
  }
  return seen;
}

}  // namespace cairn::room
