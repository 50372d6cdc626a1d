// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <algorithm>
#include <cairn/sequence/landmarks.hpp>
#include <cmath>
#include <random>
#include <vector>

/// Rooms full of landmarks, and maps of them.
namespace cairn {

/// Objects of a room, at least 0.5 m apart.
inline std::vector<Landmark> room_of(int objects, unsigned seed) {
  std::mt19937 random(seed);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  const double side = std::sqrt(2.5 * objects);
  std::vector<Landmark> all;
  while (static_cast<int>(all.size()) < objects) {
    Landmark l;
    l.id = LandmarkId{static_cast<std::int64_t>(all.size()) + 1};
    const double width = uniform(0.2, 0.7);
    l.size = {width, width * 1.2, uniform(0.2, 1.2)};
    l.height_over_floor_m = l.size.height_m / 2;
    l.position_m = {uniform(0, side), uniform(0, side), l.height_over_floor_m};
    if (std::any_of(all.begin(), all.end(), [&](const Landmark& o) {
          return std::hypot(o.position_m.x - l.position_m.x, o.position_m.y - l.position_m.y) < 0.5;
        }))
      continue;
    l.covariance_m2 = {0.0009, 0, 0, 0, 0.0009, 0, 0, 0, 0.0009};
    l.seen = 20 + static_cast<int>(uniform(0, 50));
    l.expected = l.seen + 3;
    l.log_odds = uniform(1, 4);
    l.first = {static_cast<std::int64_t>(all.size()) * 1000};
    l.last = {l.first.ns + 500};
    l.run = 1;
    LandmarkLook look;
    look.octant = static_cast<int>(uniform(0, 8)) % 8;
    const auto colour = static_cast<std::size_t>(uniform(0, 9));
    look.colours[colour % 8] = 1;
    look.colours[8 + 5 * colour] = 1;
    look.pixels = 1000;
    l.looks = {look};
    all.push_back(l);
  }
  return all;
}

/// Some of them (first … last), as a robot maps them from its own start.
inline LandmarkMap map_of(const std::vector<Landmark>& room, std::size_t first, std::size_t last,
                          const Pose& robot_from_room) {
  LandmarkMap map;
  for (std::size_t i = first; i < std::min(last, room.size()); ++i) {
    Landmark l = room[i];
    l.id = LandmarkId{map.next++};
    l.position_m = robot_from_room(l.position_m);
    l.covariance_m2 = rotated(robot_from_room, l.covariance_m2);
    map.list.push_back(l);
  }
  for (int x = -3; x < 12; ++x) {
    for (int y = -2; y < 9; ++y) map.floor.push_back({x, y, 4 + (x + y) % 3});
  }
  return map;
}

inline Pose turned_by(double yaw_rad, double x_m, double y_m) {
  Pose pose = rotation_about({0, 0, yaw_rad});
  pose.translation_m = {x_m, y_m, 0};
  return pose;
}

}  // namespace cairn
