// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>
#include "true_tracks.hpp"

/// A room with upright cylinders on a floor, seen by a stereo camera: disparities and ids by ray casting.
namespace cairn::support {

struct Cylinder {
  int thing = 0;
  double x = 0;
  double y = 0;
  double radius = 0.2;
  double height = 0.5;
  ColourHistogram look{};
};

inline ColourHistogram random_look(std::mt19937& random) {
  // A few bins of each part: most objects have one or two colours.
  ColourHistogram look{};
  std::uniform_real_distribution<float> share(0.2F, 0.8F);
  const float light = share(random);
  look[random() % 8] += light;
  look[random() % 8] += 1 - light;
  const float colour = share(random);
  look[8 + random() % 64] += colour;
  look[8 + random() % 64] += 1 - colour;
  return look;
}

struct DrawnRoom {
  static constexpr Size kSize{240, 180};
  static constexpr StereoRig kRig{156, 120, 90, 0.12F, 0};
  static constexpr double kWall_m = 5;  // half of the room's side
  std::vector<Cylinder> things;

  /// `count` objects, at least 1 m apart, away from the camera's path (radius 1.5 m).
  static DrawnRoom random(unsigned seed, int count) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> place(-4, 4);
    std::uniform_real_distribution<double> size(0.15, 0.3);
    std::uniform_real_distribution<double> height(0.3, 0.9);
    DrawnRoom room;
    while (static_cast<int>(room.things.size()) < count) {
      Cylinder c;
      c.x = place(random);
      c.y = place(random);
      if (std::hypot(c.x, c.y) < 3) continue;
      bool is_free = true;
      for (const Cylinder& other : room.things) is_free &= std::hypot(c.x - other.x, c.y - other.y) > 1;
      if (!is_free) continue;
      c.radius = size(random);
      c.height = height(random);
      c.look = random_look(random);
      c.thing = static_cast<int>(room.things.size()) + 1;
      room.things.push_back(c);
    }
    return room;
  }
};

/// At (x, y), 0.8 m high, looking along `yaw` and 12° down.
inline Pose camera_at(double x, double y, double yaw) {
  constexpr double kPitch = 12 * std::numbers::pi / 180;
  const double c = std::cos(yaw);
  const double s = std::sin(yaw);
  const double cp = std::cos(kPitch);
  const double sp = std::sin(kPitch);
  // Columns: the camera's right, down and forward in the map.
  return {{s, -c * sp, c * cp, -c, -s * sp, s * cp, 0, -cp, -sp}, {x, y, 0.8}};
}

struct DrawnView {
  Image<float> disparity{DrawnRoom::kSize};
  Image<int> things{DrawnRoom::kSize};
};

inline DrawnView draw(const DrawnRoom& room, const Pose& map_from_camera, std::mt19937& random) {
  std::normal_distribution<float> noise(0, 0.25F);
  DrawnView view;
  const StereoRig& rig = DrawnRoom::kRig;
  const Point3 o = map_from_camera.translation_m;
  struct Span {
    const Cylinder* thing;
    int first;
    int last;
  };
  std::vector<Span> spans;  // column range of each object
  for (const Cylinder& c : room.things) {
    const Point3 p = inverse(map_from_camera)({c.x, c.y, 0});
    const double nearest = p.z - c.radius - c.height;
    if (p.z < 0) continue;
    const double focal = static_cast<double>(rig.focal_px);
    const double middle = static_cast<double>(rig.cx_px) + focal * p.x / p.z;
    const double half = focal * (c.radius + c.height) / std::max(0.1, nearest) * (1 + std::abs(p.x) / p.z);
    spans.push_back({&c, static_cast<int>(std::max(0.0, middle - half)),
                     static_cast<int>(std::min<double>(DrawnRoom::kSize.width, middle + half))});
  }
  for (int y = 0; y < DrawnRoom::kSize.height; ++y) {
    for (int x = 0; x < DrawnRoom::kSize.width; ++x) {
      const Point3 d = map_from_camera.rotated(
          {static_cast<double>((static_cast<float>(x) - rig.cx_px) / rig.focal_px),
           static_cast<double>((static_cast<float>(y) - rig.cy_px) / rig.focal_px), 1});
      double z = std::numeric_limits<double>::infinity();  // along d, which has a depth of 1
      int thing = 0;
      if (d.z < 0) z = -o.z / d.z;
      for (const auto& [from, along] : {std::pair{o.x, d.x}, {o.y, d.y}}) {
        if (along != 0)
          z = std::min(z, ((along > 0 ? DrawnRoom::kWall_m : -DrawnRoom::kWall_m) - from) / along);
      }
      for (const Span& span : spans) {
        if (x < span.first || x > span.last) continue;
        const Cylinder& c = *span.thing;
        const double ox = o.x - c.x;
        const double oy = o.y - c.y;
        const double a = d.x * d.x + d.y * d.y;
        const double b = ox * d.x + oy * d.y;
        const double root = b * b - a * (ox * ox + oy * oy - c.radius * c.radius);
        if (root >= 0) {
          const double t = (-b - std::sqrt(root)) / a;
          const double up = o.z + t * d.z;
          if (t > 0 && t < z && up >= 0 && up <= c.height) {
            z = t;
            thing = c.thing;
          }
        }
        if (d.z < 0) {  // its top
          const double t = (c.height - o.z) / d.z;
          if (t > 0 && t < z && std::hypot(ox + t * d.x, oy + t * d.y) <= c.radius) {
            z = t;
            thing = c.thing;
          }
        }
      }
      view.disparity(x, y) = rig.focal_px * rig.baseline_m / static_cast<float>(z) + noise(random);
      view.things(x, y) = thing;
    }
  }
  return view;
}

/// The output of a perfect segmenter.
inline std::vector<TrueTracks::Seen> things_in(const DrawnView& view, const DrawnRoom& room,
                                               const Pose& map_from_camera) {
  const StereoRig& rig = DrawnRoom::kRig;
  std::vector<TrueTracks::Seen> all;
  for (const Cylinder& c : room.things) {
    std::vector<float> d;
    double sx = 0;
    double sy = 0;
    Rect box;
    for (int y = 0; y < view.things.height(); ++y) {
      for (int x = 0; x < view.things.width(); ++x) {
        if (view.things(x, y) != c.thing) continue;
        sx += x;
        sy += y;
        box = united(box, {x, y, 1, 1});
        d.push_back(view.disparity(x, y));
      }
    }
    constexpr std::size_t kMin = 40;
    if (d.size() < kMin) continue;
    std::nth_element(d.begin(), d.begin() + static_cast<std::ptrdiff_t>(d.size() / 2), d.end());
    const auto n = static_cast<double>(d.size());
    const auto p =
        rig.point_in_camera_m(static_cast<float>(sx / n), static_cast<float>(sy / n), d[d.size() / 2]);
    TrueTracks::Seen seen;
    seen.thing = c.thing;
    seen.in_camera_m = {static_cast<double>(p->x), static_cast<double>(p->y), static_cast<double>(p->z)};
    seen.extent_m = {static_cast<float>(box.width) * p->z / rig.focal_px,
                     static_cast<float>(box.height) * p->z / rig.focal_px, 0.2F};
    seen.look = c.look;
    seen.is_cut = box.x == 0 || box.y == 0 || box.x + box.width == view.things.width() ||
                  box.y + box.height == view.things.height();
    seen.height_over_floor_m = static_cast<float>(map_from_camera(seen.in_camera_m).z);
    all.push_back(seen);
  }
  return all;
}

}  // namespace cairn::support
