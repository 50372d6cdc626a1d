// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <cairn/fleet/shared_map.hpp>

namespace cairn::fleet {

/// What a map agent knows: the rows of every robot, and what it has made of them. Rows may come in any order, repeated
/// or late; those that are not newer than what is known change nothing.
class FleetBook {
 public:
  FleetBook() = default;
  /// What changes() gave before; what is damaged is left out.
  explicit FleetBook(const std::map<std::string, std::string>& kept);

  enum class Taken : std::uint8_t { changed, known, refused };
  /// A row from elsewhere: refused if it is not sound (fault_of()), or one too many.
  Taken take(const LandmarkRow& row);
  Taken take(const FloorRow& row);
  Taken take(const IndexRow& row);

  /// Rows that were refused, by robot, with the reason of the last one.
  struct Refused {
    int rows = 0;
    std::string why;
  };
  [[nodiscard]] const std::map<RobotKey, Refused>& refused() const { return refused_; }

  /// Every robot, by map and name.
  [[nodiscard]] std::vector<RobotMap> maps() const;
  /// Forgets robots of this name; how many there were. `placed`: where all are; if the origin is forgotten, the map with
  /// the most landmarks of those with a place becomes the origin, so that the shared map does not move.
  int forget(const std::string& name, const std::vector<PlacedRobot>& placed);

  /// Fixed by the first call after a robot has landmarks, unless poses are given.
  std::optional<Origin> origin(bool has_poses);

  [[nodiscard]] const SharedIds& ids() const { return ids_; }
  void set_ids(SharedIds ids);

  /// What has changed since the last call, for MapFile::keep(); nullopt: to be removed.
  std::map<std::string, std::optional<std::string>> changes();

  static constexpr std::size_t kMostRobots = 64;
  static constexpr std::size_t kMostRows = 10'000;  // of landmarks, and as many of floor, of one robot

 private:
  struct Robot {
    std::map<std::int64_t, LandmarkRow> landmarks;
    std::map<std::pair<int, int>, FloorRow> floor;
    std::optional<IndexRow> index;
    std::set<std::int64_t> listed;  // of the index
    std::set<std::pair<int, int>> listed_floor;
  };
  template <class Row, class Keyed, class Key, class Listed>
  Taken take_into(const Row& row, Robot& robot, Keyed& rows, const Key& key, const Listed& listed);
  Taken refuse(const RobotKey& robot, const std::string& why);
  /// Null if there are too many.
  Robot* robot_for(const RobotKey& key);
  template <class Row>
  void restore(const std::string& bytes);
  template <class Row>
  void note(const std::string& key, const Row& row);
  void set_origin(const std::optional<Origin>& origin);
  void note_dropped(const std::string& key) { changes_[key] = std::nullopt; }

  std::map<RobotKey, Robot> robots_;
  std::map<RobotKey, Refused> refused_;
  std::optional<Origin> origin_;
  SharedIds ids_;
  std::map<std::string, std::optional<std::string>> changes_;
};

}  // namespace cairn::fleet
