// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/fleet/shared_map.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <set>
#include <utility>

namespace cairn::fleet {
namespace {

/// The copies of one map, merged, and which landmarks of which robots are in each landmark of it.
struct Copies {
  MapId map_id{};
  std::vector<std::size_t> robots;  // which of the arguments
  LandmarkMap map;
  std::map<LandmarkId, std::vector<OwnLandmark>> of;
  std::optional<Pose> place;
  std::optional<Pose> guess;
};

std::vector<Copies> copies_of(const std::vector<RobotMap>& robots, const Placements& placements,
                              const LandmarksConfig& config) {
  std::vector<Copies> all;
  const auto place_in = [](const std::map<MapId, Pose>& places, const MapId& id) {
    const auto at = places.find(id);
    return at == places.end() ? std::nullopt : std::optional(at->second);
  };
  for (std::size_t i = 0; i < robots.size(); ++i) {
    const auto& [robot, map] = robots[i];
    const bool is_copy = !all.empty() && all.back().map_id == robot.map_id;
    if (!is_copy) {
      Copies& first = all.emplace_back();
      first.map_id = robot.map_id;
      first.map = map;
      first.place = place_in(placements.known, robot.map_id);
      first.guess = place_in(placements.last, robot.map_id);
      for (const Landmark& landmark : map.list) first.of[landmark.id] = {{robot, landmark.id}};
    }
    Copies& copies = all.back();
    copies.robots.push_back(i);
    if (is_copy) {
      MapMerge merged = merge_copies(std::move(copies.map), map, config);
      copies.map = std::move(merged.map);
      for (const LandmarkPair& pair : merged.landmarks)
        copies.of[pair.landmark].push_back({robot, LandmarkId{number(pair.track)}});
    }
  }
  return all;
}

/// Gives landmarks the ids that they had.
SharedIds ids_for(std::vector<SharedLandmark>& landmarks, const SharedIds& before,
                  const std::set<OwnLandmark>& there) {
  SharedIds after{{}, before.next};
  std::set<LandmarkId> taken;
  for (SharedLandmark& landmark : landmarks) {
    landmark.id = LandmarkId::none;
    for (const OwnLandmark& own : landmark.of) {
      const auto known = before.ids.find(own);
      if (known == before.ids.end() || taken.contains(known->second)) continue;
      if (landmark.id == LandmarkId::none || known->second < landmark.id) landmark.id = known->second;
    }
    if (landmark.id != LandmarkId::none) taken.insert(landmark.id);
  }
  for (SharedLandmark& landmark : landmarks) {
    if (landmark.id == LandmarkId::none) landmark.id = LandmarkId{after.next++};
    for (const OwnLandmark& own : landmark.of) after.ids[own] = landmark.id;
  }
  // Robots that are left out now keep theirs for later.
  for (const auto& [own, id] : before.ids) {
    if (there.contains(own)) after.ids.try_emplace(own, id);
  }
  return after;
}

/// Two robots may cut one thing differently, or disagree about its colours. Where the centre of one landmark is nearer
/// to another than half of its width, no robot sees both, and one stands on the floor as the other does, planners would
/// meet the thing twice.
void find_parts(const LandmarkMap& map, std::vector<SharedLandmark>& landmarks) {
  const auto are_of_other_robots = [](const SharedLandmark& a, const SharedLandmark& b) {
    return std::ranges::none_of(a.of, [&](const OwnLandmark& own) {
      return std::ranges::any_of(b.of, [&](const OwnLandmark& other) { return own.robot == other.robot; });
    });
  };
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    const Landmark& part = map.list[i];
    double nearest = 1;
    for (std::size_t j = 0; j < landmarks.size() && !part.is_gone; ++j) {
      const Landmark& whole = map.list[j];
      if (i == j || whole.is_gone || std::pair(whole.seen, j) < std::pair(part.seen, i)) continue;
      const double half = (whole.size.narrowest_m + whole.size.widest_m) / 4;
      const double distance =
          std::hypot(whole.position_m.x - part.position_m.x, whole.position_m.y - part.position_m.y);
      const double height = std::abs(whole.position_m.z - part.position_m.z);
      if (distance >= half || height > (whole.size.height_m + part.size.height_m) / 2) continue;
      if (distance / half >= nearest || !are_of_other_robots(landmarks[i], landmarks[j])) continue;
      nearest = distance / half;
      landmarks[i].part_of = landmarks[j].id;
    }
  }
}

}  // namespace

std::optional<MapId> origin_of(const std::vector<RobotMap>& robots) {
  const auto best = std::ranges::min_element(robots, {}, [](const RobotMap& robot) {
    return std::pair(-static_cast<std::ptrdiff_t>(robot.map.list.size()), robot.robot);
  });
  if (best == robots.end() || best->map.list.empty()) return std::nullopt;
  return best->robot.map_id;
}

SharedMap share(std::vector<RobotMap> robots, const Placements& placements, const SharedIds& before,
                const LandmarksConfig& config) {
  std::ranges::sort(robots, {}, &RobotMap::robot);
  std::vector<Copies> all = copies_of(robots, placements, config);
  std::vector<MapToMerge> maps;
  maps.reserve(all.size());
  for (const Copies& copies : all) maps.push_back({copies.map, false, copies.place, copies.guess});
  MapsMerge merged = merge_all({}, maps, config);

  SharedMap shared;
  shared.map = std::move(merged.map);
  std::map<LandmarkId, SharedLandmark> by_id;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const PlacedMap& placed = merged.placed[i];
    for (const std::size_t which : all[i].robots) {
      shared.robots.push_back({robots[which].robot, placed.map_from_other, placed.pairs.size(),
                               placed.refusal, robots[which].map.list.size()});
    }
    for (const LandmarkPair& pair : placed.landmarks) {
      const std::vector<OwnLandmark>& of = all[i].of[LandmarkId{number(pair.track)}];
      SharedLandmark& landmark = by_id[pair.landmark];
      landmark.of.insert(landmark.of.end(), of.begin(), of.end());
    }
  }
  for (const Landmark& landmark : shared.map.list) {
    shared.landmarks.push_back(std::move(by_id[landmark.id]));
    std::ranges::sort(shared.landmarks.back().of);
  }
  std::set<OwnLandmark> there;
  for (const RobotMap& robot : robots) {
    for (const Landmark& landmark : robot.map.list) there.insert({robot.robot, landmark.id});
  }
  shared.ids = ids_for(shared.landmarks, before, there);
  find_parts(shared.map, shared.landmarks);
  for (std::size_t i = 0; i < shared.landmarks.size(); ++i) shared.map.list[i].id = shared.landmarks[i].id;
  std::ranges::sort(shared.map.list, {}, &Landmark::id);
  std::ranges::sort(shared.landmarks, {}, &SharedLandmark::id);
  shared.map.next = shared.ids.next;
  return shared;
}

}  // namespace cairn::fleet
