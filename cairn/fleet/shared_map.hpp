// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include <cairn/fleet/rows.hpp>

/// One map from those of several robots. (docs/agents.md)
namespace cairn::fleet {

/// What a robot has seen itself.
struct RobotMap {
  RobotKey robot;
  LandmarkMap map;
};

/// Where maps are in the shared one.
struct Placements {
  std::map<MapId, Pose> known;
  std::map<MapId, Pose> last;  // where others were before: fewer landmarks confirm these
};
/// The map whose frame becomes that of the shared one where no place is known: the one with the most landmarks; nullopt if
/// none has any.
std::optional<MapId> origin_of(const std::vector<RobotMap>& robots);

/// A landmark of a robot's own map.
struct OwnLandmark {
  RobotKey robot;
  LandmarkId id = LandmarkId::none;
  friend auto operator<=>(const OwnLandmark&,
                          const OwnLandmark&) = default;  // NOLINT(modernize-use-nullptr): its 0 is none
};
/// The landmarks of the shared map by those that they are made of. A landmark keeps its id as long as one of them is
/// in it; an id is not used again.
struct SharedIds {
  std::map<OwnLandmark, LandmarkId> ids;
  std::int64_t next = 1;
  friend bool operator==(const SharedIds&, const SharedIds&) = default;
};

struct PlacedRobot {
  RobotKey robot;
  std::optional<Pose> map_from_robot;  // nullopt: unknown
  std::size_t pairs = 0;               // landmarks that others have seen, too
  RecognitionRefusal refusal = RecognitionRefusal::none;
  std::size_t landmarks = 0;
};

/// What one landmark of the shared map is made of.
struct SharedLandmark {
  LandmarkId id = LandmarkId::none;
  std::vector<OwnLandmark> of;            // ascending
  LandmarkId part_of = LandmarkId::none;  // another landmark in its place, better seen by other robots
};

struct SharedMap {
  LandmarkMap map;                        // by id, ascending
  std::vector<SharedLandmark> landmarks;  // as in the map
  std::vector<PlacedRobot> robots;        // by map and name
  SharedIds ids;
};

/// Merges the maps of robots: a function of its arguments alone, so the order in which maps grew does not matter. Copies
/// of one map are merged first (merge_copies()); then all as merge_all() does, so the result is that of `cairn map merge`
/// but for ids and crops. A robot whose place is unknown is left out. `before`: the ids of the last result; those of what is
/// no longer in a robot's map are dropped.
SharedMap share(std::vector<RobotMap> robots, const Placements& placements, const SharedIds& before,
                const LandmarksConfig& config);

}  // namespace cairn::fleet
