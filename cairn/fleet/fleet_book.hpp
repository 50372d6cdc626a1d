// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <cairn/fleet/shared_map.hpp>
#include <cairn/sequence/map_file.hpp>

namespace cairn::fleet {

/// What a map agent knows: the rows of every robot, and what it has made of them. Rows may come in any order, repeated
/// or late; those that are not newer than what is known change nothing.
class FleetBook {
 public:
  FleetBook() = default;
  /// What changes() gave before; what is damaged is left out.
  explicit FleetBook(const std::map<std::string, std::string>& kept);

  /// older: an index of before the one that is known, from a map that was restored from a copy.
  enum class Outcome : std::uint8_t { changed, known, older, refused };
  /// A row from elsewhere: refused if it is not sound (fault_of()), or one too many.
  Outcome add(const LandmarkRow& row);
  Outcome add(const FloorRow& row);
  Outcome add(const IndexRow& row);

  /// Rows that were refused, by robot, with the reason of the last one. A robot without a valid name has none.
  struct Refused {
    int rows = 0;
    std::string why;
  };
  [[nodiscard]] const std::map<RobotKey, Refused>& refused() const { return refused_; }

  /// Every robot, by map and name.
  [[nodiscard]] std::vector<RobotMap> maps() const;
  /// Forgets robots of this name, and a place that was given for it; how many there were. `placed`: where all are; if no
  /// known place is left, the map with the most landmarks keeps its place, so that the shared map does not move.
  int forget(const std::string& name, const std::vector<PlacedRobot>& placed);

  /// Places that are given, by the name of a robot; they are kept.
  void give(const std::string& robot, const Pose& map_from_robot);
  [[nodiscard]] const std::map<std::string, Pose>& given() const { return given_; }
  /// What is known of places. `former`: robots whose name belongs to another map now, which a given place does not
  /// mean. Where no place is given, the first map with landmarks becomes the origin.
  Placements placements(const std::set<RobotKey>& former = {});
  /// Where robots are now.
  void set_places(const std::vector<PlacedRobot>& placed);

  [[nodiscard]] const SharedIds& ids() const { return ids_; }
  void set_ids(SharedIds ids);

  /// What has changed since the last call, for MapFile::keep(); nullopt: to be removed.
  std::map<std::string, std::optional<std::string>> changes();

  static constexpr std::size_t kMostRobots = 64;
  static constexpr std::size_t kMostRows = 100'000;  // of landmarks, and as many of floor, of one robot

 private:
  struct Robot {
    std::map<std::int64_t, LandmarkRow> landmarks;
    std::map<std::pair<int, int>, FloorRow> floor;
    std::optional<IndexRow> index;
    std::set<std::int64_t> listed;  // of the index
    std::set<std::pair<int, int>> listed_floor;
  };
  /// add(robot) for a sound row of a robot that there is room for.
  template <class Row, class Add>
  Outcome if_sound(const Row& row, const Add& add);
  template <class Row, class Keyed, class Key, class Listed>
  Outcome add_to(const Row& row, Robot& robot, Keyed& rows, const Key& key, const Listed& listed);
  Outcome add_index(const IndexRow& row, Robot& robot);
  Outcome refuse(const RobotKey& sender, const std::string& why);
  /// Null if there are too many.
  Robot* robot_for(const RobotKey& key);
  template <class Row>
  void restore(const std::string& bytes);
  template <class Row>
  void note(const std::string& key, const Row& row);
  void set_origin(const std::optional<MapId>& map_id, const Pose& map_from_robot);
  void note_dropped(const std::string& key) { changes_[key] = std::nullopt; }

  std::map<RobotKey, Robot> robots_;
  std::map<RobotKey, Refused> refused_;
  std::optional<MapId> origin_;
  std::map<MapId, Pose> places_;  // the last ones; that of the origin is fixed
  std::map<std::string, Pose> given_;
  SharedIds ids_;
  std::map<std::string, std::optional<std::string>> changes_;
};

/// The file of a map agent, created if absent. Throws Error like MapFile::open(), and for the map of a robot.
struct FleetFile {
  MapFile file;
  FleetBook book;
};
FleetFile open_fleet_file(const std::filesystem::path& path);

}  // namespace cairn::fleet
