// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <algorithm>
#include <cairn/sequence/landmarks.hpp>
#include <cmath>
#include <map>
#include <random>
#include <vector>

/// Tracks as a perfect tracker would make them from known masks.
namespace cairn::support {

/// sRGB as CIE L*a*b* (D65), in the bins of a ColourHistogram.
inline void count_colour(ColourHistogram& histogram, Rgb colour) {
  const auto linear = [](std::uint8_t v) {
    const double c = v / 255.0;
    return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
  };
  const double r = linear(colour.r);
  const double g = linear(colour.g);
  const double b = linear(colour.b);
  const auto f = [](double t) { return t > 0.008856 ? std::cbrt(t) : 7.787 * t + 16.0 / 116; };
  const double x = f((0.4124 * r + 0.3576 * g + 0.1805 * b) / 0.9505);
  const double y = f(0.2126 * r + 0.7152 * g + 0.0722 * b);
  const double z = f((0.0193 * r + 0.1192 * g + 0.9505 * b) / 1.089);
  const auto bin = [](double v, double low, double width) {
    return static_cast<std::size_t>(std::clamp(std::floor((v - low) / width), 0.0, 7.0));
  };
  histogram[bin(116 * y - 16, 0, 12.5)] += 1;
  histogram[8 + 8 * bin(500 * (x - y), -64, 16) + bin(200 * (y - z), -64, 16)] += 1;
}

inline void normalise(ColourHistogram& histogram, double count) {
  for (float& bin : histogram) bin = static_cast<float>(static_cast<double>(bin) / std::max(1.0, count));
}

/// Follows objects by their true ids; a track ends when the object is out of sight for more than 10 s.
class TrueTracks {
 public:
  struct Seen {
    int thing = 0;
    Point3 in_camera_m;
    Vec3 extent_m;
    ColourHistogram look{};
    bool is_moving = false;
    bool is_cut = false;
    float height_over_floor_m = 0;
  };

  Tracks tracks;
  std::vector<TrackId> cut;
  std::map<TrackId, int> thing_of;

  /// `seen`: in any order; index + 1 becomes the ObjectId.
  void next(const std::vector<Seen>& seen, const Pose& map_from_camera, const StereoRig& rig, Stamp now) {
    constexpr double kHidden_s = 10;
    constexpr double kDisparitySigma = 0.35;
    cut.clear();
    std::erase_if(tracks.list, [&](const Track& t) { return seconds_between(t.last, now) > kHidden_s; });
    for (Track& track : tracks.list) {
      track.object = ObjectId::none;
      if (track.state == TrackState::confirmed) track.state = TrackState::out_of_view;
    }
    for (std::size_t i = 0; i < seen.size(); ++i) {
      const Seen& s = seen[i];
      auto at = std::find_if(tracks.list.begin(), tracks.list.end(),
                             [&](const Track& t) { return thing_of.at(t.id) == s.thing; });
      const Point3 position = map_from_camera(s.in_camera_m);
      constexpr double kOther_m = 0.6;  // beyond any tracker's gate
      if (at != tracks.list.end() && !s.is_moving && length(at->position_m - position) > kOther_m) {
        tracks.list.erase(at);
        at = tracks.list.end();
      }
      const double z = s.in_camera_m.z;
      const double depth = z * z * kDisparitySigma / static_cast<double>(rig.focal_px * rig.baseline_m) / 2;
      const double side = 0.15 * static_cast<double>(s.extent_m.x);
      const Covariance3 noise =
          rotated(map_from_camera, {side * side, 0, 0, 0, side * side, 0, 0, 0, depth * depth});
      if (at == tracks.list.end()) {
        Track fresh;
        fresh.id = TrackId{tracks.next++};
        thing_of[fresh.id] = s.thing;
        fresh.first = now;
        fresh.position_m = position;
        fresh.covariance_m2 = noise;
        fresh.extent_m = s.extent_m;
        fresh.look = s.look;
        tracks.list.push_back(fresh);
        at = tracks.list.end() - 1;
      } else if (s.is_moving) {
        at->position_m = position;
        at->covariance_m2 = noise;
      } else {
        // An exponential filter, as smooth as a real one.
        const double gain = trace(at->covariance_m2) / (trace(at->covariance_m2) + trace(noise));
        at->position_m = at->position_m + gain * (position - at->position_m);
        for (std::size_t k = 0; k < 9; ++k) {
          at->covariance_m2[k] *= 1 - gain;
          if (k % 4 == 0) at->covariance_m2[k] += 1e-4;
        }
      }
      constexpr float kNew = 0.2F;
      const auto blend = [](float& old, float value) { old += kNew * (value - old); };
      if (!s.is_cut) {
        blend(at->extent_m.x, s.extent_m.x);
        blend(at->extent_m.y, s.extent_m.y);
        blend(at->extent_m.z, s.extent_m.z);
        for (std::size_t k = 0; k < at->look.size(); ++k) blend(at->look[k], s.look[k]);
      }
      at->height_over_floor_m = s.height_over_floor_m;
      at->object = ObjectId{static_cast<std::int32_t>(i + 1)};
      at->is_moving = s.is_moving;
      at->last = now;
      at->confidence = 0.9F;
      ++at->hits;
      at->state = at->hits >= 3 ? TrackState::confirmed : TrackState::tentative;
      if (s.is_cut) cut.push_back(at->id);
    }
  }

 private:
  static double trace(const Covariance3& c) { return c[0] + c[4] + c[8]; }
};

}  // namespace cairn::support
