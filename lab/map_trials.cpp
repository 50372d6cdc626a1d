// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/sequence/landmarks.hpp>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <random>

/// How often merge() joins two maps rightly, wrongly or not at all: maps of one room that share some objects, and maps
/// of two rooms that have nothing in common. map_trials [TRIALS]; the table of docs/stages/landmarks.md.
namespace cairn {
namespace {

constexpr double kNoise_m = 0.05;
constexpr double kArea_m2 = 2.5;  // of the floor, per object
constexpr double kSight_m = 2.5;  // radius of floor seen from a place

struct Room {
  int objects = 10;
  int colours = 9;
};

struct Counts {
  int right = 0;
  int wrong = 0;
  int refused = 0;
};

class Trials {
 public:
  Trials(unsigned seed, bool has_floor) : random_(seed), has_floor_(has_floor) {}

  static double side_of(Room room) { return std::sqrt(kArea_m2 * room.objects); }

  /// Objects in a square room, at least 0.4 m apart.
  std::vector<Landmark> objects_of(Room room) {
    const double side = side_of(room);
    std::vector<Landmark> all;
    while (static_cast<int>(all.size()) < room.objects) {
      Landmark l;
      l.size.narrowest_m = uniform(0.15, 0.8);
      l.size.widest_m = l.size.narrowest_m * uniform(1, 1.5);
      l.size.height_m = uniform(0.2, 1.2);
      l.height_over_floor_m = l.size.height_m / 2;
      l.position_m = {uniform(0, side), uniform(0, side), l.height_over_floor_m};
      const bool is_free = std::none_of(all.begin(), all.end(), [&](const Landmark& o) {
        return std::hypot(o.position_m.x - l.position_m.x, o.position_m.y - l.position_m.y) < 0.4;
      });
      if (!is_free) continue;
      LandmarkLook look;
      const auto colour = static_cast<std::size_t>(uniform(0, room.colours));
      look.colours[colour % 8] = 1;
      look.colours[8 + 5 * colour] = 1;
      look.pixels = 1000;
      l.looks = {look};
      all.push_back(l);
    }
    return all;
  }

  /// As a robot maps it that starts anywhere; free floor around three
  /// places from x = `low` to `high` of the room.
  LandmarkMap seen(const std::vector<Landmark>& objects, double low, double high, double side,
                   const Pose& map_from_room) {
    LandmarkMap map;
    if (has_floor_) map.floor = floor_of(objects, low, high, side, map_from_room);
    for (Landmark l : objects) {
      l.id = LandmarkId{map.next++};
      l.position_m = map_from_room(l.position_m) + Point3{noise(), noise(), 0.3 * noise()};
      const double variance = kNoise_m * kNoise_m;
      l.covariance_m2 = {variance, 0, 0, 0, variance, 0, 0, 0, variance};
      l.size.height_m *= uniform(0.9, 1.1);
      map.list.push_back(l);
    }
    return map;
  }

  std::vector<FloorCell> floor_of(const std::vector<Landmark>& objects, double low, double high, double side,
                                  const Pose& map_from_room) {
    const Pose room_from_map = inverse(map_from_room);
    std::vector<Point3> stops;  // of the robot
    for (int k = 0; k < 3; ++k) stops.push_back({uniform(low, high), uniform(0, side), 0});
    std::vector<FloorCell> cells;
    constexpr int kReach = 150;
    for (int x = -kReach; x < kReach; ++x) {
      for (int y = -kReach; y < kReach; ++y) {
        const Point3 at = room_from_map({(x + 0.5) * kFloorCell_m, (y + 0.5) * kFloorCell_m, 0});
        if (at.x < low || at.x > high || at.y < 0 || at.y > side) continue;
        const auto is_near = [at](Point3 other, double reach_m) {
          return std::hypot(other.x - at.x, other.y - at.y) < reach_m;
        };
        const bool is_seen =
            std::any_of(stops.begin(), stops.end(), [&](Point3 stop) { return is_near(stop, kSight_m); });
        const bool is_free = std::none_of(objects.begin(), objects.end(), [&](const Landmark& l) {
          return is_near(l.position_m, l.size.narrowest_m / 2);
        });
        if (is_seen && is_free) cells.push_back({x, y, 20});
      }
    }
    return cells;
  }

  Pose anywhere() {
    Pose pose = rotation_about({0, 0, uniform(0, 2 * std::numbers::pi)});
    pose.translation_m = {uniform(-9, 9), uniform(-9, 9), 0};
    return pose;
  }

  /// Two maps, each of half the room and `common` objects.
  Counts same_room(Room room, int common, int trials) {
    Counts counts;
    for (int k = 0; k < trials; ++k) {
      std::vector<Landmark> all = objects_of(room);
      std::sort(all.begin(), all.end(),
                [](const Landmark& a, const Landmark& b) { return a.position_m.x < b.position_m.x; });
      const double side = side_of(room);
      const auto half = (room.objects - common) / 2;
      const Pose a = anywhere(), b = anywhere();
      const LandmarkMap first = seen({all.begin(), all.begin() + half + common}, 0,
                                     all[static_cast<std::size_t>(half + common - 1)].position_m.x, side, a);
      const LandmarkMap second = seen({all.begin() + half, all.end()},
                                      all[static_cast<std::size_t>(half)].position_m.x, side, side, b);
      const MapMerge merged = merge(first, second, std::nullopt, LandmarksConfig{});
      if (!merged.map_from_other) {
        ++counts.refused;
        continue;
      }
      const Point3 middle = all[static_cast<std::size_t>(half)].position_m;
      const bool is_right = length((*merged.map_from_other)(b(middle)) - a(middle)) < 0.3;
      ++(is_right ? counts.right : counts.wrong);
    }
    return counts;
  }

  /// How many of the maps of two rooms are joined; each has half as many objects as the rooms above.
  int other_rooms(Room room, int trials) {
    int joined = 0;
    room.objects /= 2;
    for (int k = 0; k < trials; ++k) {
      const double side = side_of(room);
      const LandmarkMap first = seen(objects_of(room), 0, side, side, anywhere());
      const LandmarkMap second = seen(objects_of(room), 0, side, side, anywhere());
      joined += merge(first, second, std::nullopt, LandmarksConfig{}).map_from_other ? 1 : 0;
    }
    return joined;
  }

 private:
  double uniform(double low, double high) { return std::uniform_real_distribution<>(low, high)(random_); }
  double noise() { return std::normal_distribution<>(0, kNoise_m)(random_); }

  std::mt19937 random_;
  bool has_floor_;
};

void print_rows(Room room, bool has_floor, int trials) {
  using Clock = std::chrono::steady_clock;
  Trials draw(1, has_floor);
  const int joined = draw.other_rooms(room, 5 * trials);
  for (const int common : {3, 4, 6}) {
    const auto begin = Clock::now();
    const Counts counts = draw.same_room(room, common, trials);
    const std::chrono::duration<double, std::milli> took = Clock::now() - begin;
    const auto percent = [&](int count) { return 100.0 * count / trials; };
    std::printf("| %s | %d | %d | %d | %.1f %% | %.1f %% | %.1f %% | %d of %d | %.1f |\n",
                has_floor ? "partly seen" : "unknown", room.objects, room.colours, common,
                percent(counts.right), percent(counts.wrong), percent(counts.refused), joined, 5 * trials,
                took.count() / trials);
  }
}

void run(int trials) {
  std::printf(
      "| floor | objects a room | colours | common | right | wrong | refused | other rooms joined | ms a merge |\n"
      "|---|---:|---:|---:|---:|---:|---:|---:|---:|\n");
  for (const bool has_floor : {false, true}) {
    for (const Room room : {Room{10}, Room{20}, Room{20, 3}, Room{30}, Room{60}, Room{60, 3}, Room{100}})
      print_rows(room, has_floor, trials);
  }
}

}  // namespace
}  // namespace cairn

int main(int argc, char** argv) {
  cairn::run(argc > 1 ? std::max(1, std::atoi(argv[1])) : 400);
}
