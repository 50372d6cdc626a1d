// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <algorithm>
#include <compare>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <cairn/fleet/messages.hpp>
#include <cairn/sequence/landmarks.hpp>

/// Landmarks and floor of a robot's own map as rows for others, and back.
namespace cairn::fleet {

/// A robot with a map of its own. Copies of one map file have one id, hence the name.
struct RobotKey {
  MapId map_id{};
  std::string name;
  friend auto operator<=>(const RobotKey&,
                          const RobotKey&) = default;  // NOLINT(modernize-use-nullptr): its 0 is none
};

/// Of 32 hexadecimal digits (MapFile::map_id()); nullopt for anything else.
std::optional<MapId> map_id_of(const std::string& digits);
std::string digits_of(const MapId& id);
/// Whether it is [a-z][a-z0-9_]{0,31}, and not "map", the name of map agents.
bool is_robot_name(const std::string& name);
/// The name. Throws Error naming `option` unless is_robot_name().
std::string checked_robot(const std::string& name, const std::string& option);
NameBytes bytes_of(const std::string& robot);

template <class Row>
RobotKey robot_of(const Row& row) {
  std::string name;
  for (const std::uint8_t byte : row.robot) {
    if (byte == 0) break;
    name += static_cast<char>(byte);
  }
  return {row.map_id, name};
}

/// What is wrong with a row from elsewhere, such as "a position of more than 10 km"; empty if it is sound.
std::string fault_of(const LandmarkRow& row);
std::string fault_of(const FloorRow& row);
std::string fault_of(const IndexRow& row);
std::string fault_of(const AgentRow& row);

/// Without its crop.
LandmarkRow row_of(const Landmark& landmark, const RobotKey& robot, std::uint64_t version);
/// Of a sound row.
Landmark landmark_of(const LandmarkRow& row);
/// By x, then y.
std::vector<FloorRow> rows_of(const std::vector<FloorCell>& floor, const RobotKey& robot,
                              std::uint64_t version);
/// Those that are known to be free, by x, then y.
std::vector<FloorCell> cells_of(const std::vector<FloorRow>& tiles);

/// The rows of a robot's map that differ from those sent before.
class RowDifferences {
 public:
  explicit RowDifferences(RobotKey robot) : robot_(std::move(robot)) {}

  /// Versions grow from run to run of the map file.
  void begin_run(std::int64_t run) { version_ = std::max(version_, static_cast<std::uint64_t>(run) << 32U); }

  struct Changes {
    std::vector<LandmarkRow> landmarks;
    std::vector<FloorRow> floor;
    std::optional<IndexRow> index;  // to be sent after them; nullopt: no row has left the map
  };
  Changes next(const LandmarkMap& map);
  /// A row of next() that could not be sent: it comes again.
  void is_unsent(const LandmarkRow& row);
  void is_unsent(const FloorRow& row);
  void is_unsent(const IndexRow& /*row*/) { has_sent_index_ = false; }

 private:
  RobotKey robot_;
  std::uint64_t version_ = 0;
  std::vector<LandmarkRow> landmarks_;  // as sent, by id
  std::vector<FloorRow> floor_;         // by x, then y
  bool has_sent_index_ = false;
};

}  // namespace cairn::fleet
