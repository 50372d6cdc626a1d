// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/fleet/fleet_book.hpp>

#include <algorithm>
#include <cairn/core/error.hpp>
#include <cmath>
#include <iterator>
#include <type_traits>

namespace cairn::fleet {
namespace {

constexpr const char* kOriginKey = "origin";
constexpr const char* kNextKey = "next";

std::string key_of(const RobotKey& robot) {
  return digits_of(robot.map_id) + "/" + robot.name;
}
std::string key_of(const LandmarkRow& row) {
  return "landmark/" + key_of(robot_of(row)) + "/" + std::to_string(row.id);
}
std::string key_of(const FloorRow& row) {
  return "floor/" + key_of(robot_of(row)) + "/" + std::to_string(row.x) + "," + std::to_string(row.y);
}
std::string key_of(const IndexRow& row) {
  return "index/" + key_of(robot_of(row));
}
std::string key_of(const SharedIdRow& row) {
  return "shared/" + std::to_string(row.id);
}

std::optional<Pose> pose_in(const ros::Pose& pose) {
  const auto& [x, y, z] = pose.position;
  const ros::Quaternion turn = pose.orientation;
  const double length = turn.x * turn.x + turn.y * turn.y + turn.z * turn.z + turn.w * turn.w;
  if (!std::isfinite(x + y + z) || !(std::abs(length - 1) < 1e-3)) return std::nullopt;
  return pose_of({x, y, z}, {turn.x, turn.y, turn.z, turn.w});
}

PlaceRow row_of(const Pose& pose, const MapId& map_id, const std::string& robot) {
  const Point3 at = pose.translation_m;
  const auto turn = quaternion(pose);
  return {map_id, bytes_of(robot), {{at.x, at.y, at.z}, {turn[0], turn[1], turn[2], turn[3]}}};
}

template <class Row>
std::string text_of(const Row& row) {
  const ros::Bytes bytes = ros::encode(row);
  return {bytes.begin(), bytes.end()};
}

}  // namespace

FleetBook::FleetBook(const std::map<std::string, std::string>& kept) {
  for (const auto& [key, value] : kept) {
    if (key.starts_with("landmark/")) restore<LandmarkRow>(value);
    if (key.starts_with("floor/")) restore<FloorRow>(value);
    if (key.starts_with("shared/")) restore<SharedIdRow>(value);
    if (key.starts_with("place/") || key.starts_with("given/")) restore<PlaceRow>(value);
    if (key == kOriginKey) origin_ = map_id_of(value);
    if (key == kNextKey) ids_.next = std::max<std::int64_t>(1, std::strtoll(value.c_str(), nullptr, 10));
  }
  // After the rows that it lists.
  for (const auto& [key, value] : kept) {
    if (key.starts_with("index/")) restore<IndexRow>(value);
  }
  for (const auto& [own, id] : ids_.ids) ids_.next = std::max(ids_.next, number(id) + 1);
  changes_.clear();
  refused_.clear();
}

template <class Row>
void FleetBook::restore(const std::string& bytes) {
  try {
    const Row row = ros::decode<Row>({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
    if constexpr (std::is_same_v<Row, SharedIdRow>) {
      const std::size_t count = std::min({row.map_ids.size(), row.robots.size(), row.landmarks.size()});
      for (std::size_t i = 0; i < count; ++i) {
        struct {
          MapId map_id;
          NameBytes robot;
        } const of{row.map_ids[i], row.robots[i]};
        ids_.ids[{robot_of(of), LandmarkId{row.landmarks[i]}}] = LandmarkId{row.id};
      }
    } else if constexpr (std::is_same_v<Row, PlaceRow>) {
      const auto pose = pose_in(row.map_from_robot);
      if (!pose) return;
      const std::string name = robot_of(row).name;
      if (name.empty()) {
        places_[row.map_id] = *pose;
      } else {
        given_[name] = *pose;
      }
    } else {
      add(row);
    }
  } catch (const Error&) {  // its robot sends it again
  }
}

FleetBook::Outcome FleetBook::refuse(const RobotKey& sender, const std::string& why) {
  const RobotKey robot = is_robot_name(sender.name) ? sender : RobotKey{};  // foreign bytes are not repeated
  // Names are foreign, too: as many as robots are remembered.
  if (refused_.size() < kMostRobots || refused_.contains(robot)) {
    Refused& refused = refused_[robot];
    ++refused.rows;
    refused.why = why;
  }
  return Outcome::refused;
}

FleetBook::Robot* FleetBook::robot_for(const RobotKey& key) {
  const auto known = robots_.find(key);
  if (known != robots_.end()) return &known->second;
  return robots_.size() < kMostRobots ? &robots_[key] : nullptr;
}

template <class Row>
void FleetBook::note(const std::string& key, const Row& row) {
  changes_[key] = text_of(row);
}

template <class Row, class Keyed, class Key, class Listed>
FleetBook::Outcome FleetBook::add_to(const Row& row, Robot& robot, Keyed& rows, const Key& key,
                                     const Listed& listed) {
  const auto known = rows.find(key);
  if (known != rows.end() && known->second.version >= row.version) return Outcome::known;
  // Of a landmark that is not in the map any more, but was when this was sent.
  if (robot.index && row.version <= robot.index->version && !listed.contains(key)) return Outcome::known;
  if (known == rows.end() && rows.size() >= kMostRows)
    return refuse(robot_of(row), "more than " + std::to_string(kMostRows) + " rows");
  rows.insert_or_assign(key, row);
  note(key_of(row), row);
  return Outcome::changed;
}

template <class Row, class Add>
FleetBook::Outcome FleetBook::if_sound(const Row& row, const Add& add) {
  if (const std::string fault = fault_of(row); !fault.empty()) return refuse(robot_of(row), fault);
  Robot* const robot = robot_for(robot_of(row));
  if (robot == nullptr) return refuse(robot_of(row), "more than " + std::to_string(kMostRobots) + " robots");
  return add(*robot);
}

FleetBook::Outcome FleetBook::add(const LandmarkRow& row) {
  return if_sound(row,
                  [&](Robot& robot) { return add_to(row, robot, robot.landmarks, row.id, robot.listed); });
}

FleetBook::Outcome FleetBook::add(const FloorRow& row) {
  return if_sound(row, [&](Robot& robot) {
    return add_to(row, robot, robot.floor, std::pair(row.x, row.y), robot.listed_floor);
  });
}

FleetBook::Outcome FleetBook::add(const IndexRow& row) {
  return if_sound(row, [&](Robot& robot) { return add_index(row, robot); });
}

FleetBook::Outcome FleetBook::add_index(const IndexRow& row, Robot& robot) {
  if (row.landmarks.size() > kMostRows || row.tile_x.size() > kMostRows)
    return refuse(robot_of(row), "more than " + std::to_string(kMostRows) + " rows");
  if (robot.index && robot.index->version >= row.version)
    return robot.index->version > row.version ? Outcome::older : Outcome::known;
  robot.index = row;
  robot.listed = {row.landmarks.begin(), row.landmarks.end()};
  robot.listed_floor.clear();
  for (std::size_t i = 0; i < row.tile_x.size(); ++i)
    robot.listed_floor.emplace(row.tile_x[i], row.tile_y[i]);
  note(key_of(row), row);
  const auto drop = [&](auto& rows, const auto& listed) {
    std::erase_if(rows, [&](const auto& known) {
      if (known.second.version > row.version || listed.contains(known.first)) return false;
      note_dropped(key_of(known.second));
      return true;
    });
  };
  drop(robot.landmarks, robot.listed);
  drop(robot.floor, robot.listed_floor);
  return Outcome::changed;
}

std::vector<RobotMap> FleetBook::maps() const {
  std::vector<RobotMap> maps;
  for (const auto& [key, robot] : robots_) {
    RobotMap& own = maps.emplace_back();
    own.robot = key;
    for (const auto& [id, row] : robot.landmarks) {
      own.map.list.push_back(landmark_of(row));
      own.map.next = id + 1;
    }
    std::vector<FloorRow> tiles;
    for (const auto& [place, tile] : robot.floor) tiles.push_back(tile);
    own.map.floor = cells_of(tiles);
  }
  return maps;
}

int FleetBook::forget(const std::string& name, const std::vector<PlacedRobot>& placed) {
  int count = 0;
  std::set<MapId> gone;
  for (auto at = robots_.begin(); at != robots_.end();) {
    if (at->first.name != name) {
      ++at;
      continue;
    }
    for (const auto& [id, row] : at->second.landmarks) note_dropped(key_of(row));
    for (const auto& [place, row] : at->second.floor) note_dropped(key_of(row));
    if (at->second.index) note_dropped(key_of(*at->second.index));
    refused_.erase(at->first);
    gone.insert(at->first.map_id);
    at = robots_.erase(at);
    ++count;
  }
  if (given_.erase(name) > 0) note_dropped("given/" + name);
  for (const auto& [key, robot] : robots_) gone.erase(key.map_id);  // of a copy
  for (const MapId& id : gone) {
    if (places_.erase(id) > 0) note_dropped("place/" + digits_of(id));
  }
  if (origin_ && !gone.contains(*origin_)) return count;
  const bool has_given =
      std::ranges::any_of(robots_, [&](const auto& robot) { return given_.contains(robot.first.name); });
  const PlacedRobot* next = nullptr;
  for (const PlacedRobot& robot : placed) {
    if (robot.map_from_robot && robots_.contains(robot.robot) &&
        (next == nullptr || robot.landmarks > next->landmarks))
      next = &robot;
  }
  if (next != nullptr && !has_given) {
    set_origin(next->robot.map_id, *next->map_from_robot);
  } else {
    set_origin(std::nullopt, {});
  }
  return count;
}

void FleetBook::set_origin(const std::optional<MapId>& map_id, const Pose& map_from_robot) {
  origin_ = map_id;
  if (!map_id) return note_dropped(kOriginKey);
  changes_[kOriginKey] = digits_of(*map_id);
  places_[*map_id] = map_from_robot;
  note("place/" + digits_of(*map_id), row_of(map_from_robot, *map_id, ""));
}

void FleetBook::give(const std::string& robot, const Pose& map_from_robot) {
  given_[robot] = map_from_robot;
  note("given/" + robot, row_of(map_from_robot, {}, robot));
}

Placements FleetBook::placements(const std::set<RobotKey>& former) {
  if (!origin_ && given_.empty()) {
    if (const auto first = origin_of(maps())) set_origin(first, {});
  }
  Placements placements{{}, places_};
  for (const auto& [key, robot] : robots_) {
    const auto given = given_.find(key.name);
    if (given != given_.end() && !former.contains(key))
      placements.known.try_emplace(key.map_id, given->second);
  }
  if (origin_) placements.known.try_emplace(*origin_, places_[*origin_]);
  return placements;
}

void FleetBook::set_places(const std::vector<PlacedRobot>& placed) {
  constexpr double kSame_m = 0.01;
  constexpr double kSame_rad = 0.002;
  for (const PlacedRobot& robot : placed) {
    const MapId& id = robot.robot.map_id;
    if (!robot.map_from_robot || (origin_ && id == *origin_)) continue;
    const auto known = places_.find(id);
    if (known != places_.end()) {
      const Pose apart = inverse(known->second) * *robot.map_from_robot;
      if (length(apart.translation_m) < kSame_m && angle_of(apart) < kSame_rad) continue;
    }
    places_[id] = *robot.map_from_robot;
    note("place/" + digits_of(id), row_of(*robot.map_from_robot, id, ""));
  }
}

void FleetBook::set_ids(SharedIds ids) {
  if (ids == ids_) return;
  const auto rows_of = [](const SharedIds& all) {
    std::map<LandmarkId, SharedIdRow> rows;
    for (const auto& [own, id] : all.ids) {
      SharedIdRow& row = rows[id];
      row.id = number(id);
      row.map_ids.push_back(own.robot.map_id);
      row.robots.push_back(bytes_of(own.robot.name));
      row.landmarks.push_back(number(own.id));
    }
    return rows;
  };
  const auto before = rows_of(ids_);
  const auto after = rows_of(ids);
  for (const auto& [id, row] : after) {
    const auto known = before.find(id);
    if (known == before.end() || text_of(known->second) != text_of(row)) note(key_of(row), row);
  }
  for (const auto& [id, row] : before) {
    if (!after.contains(id)) note_dropped(key_of(row));
  }
  if (ids.next != ids_.next) changes_[kNextKey] = std::to_string(ids.next);
  ids_ = std::move(ids);
}

std::map<std::string, std::optional<std::string>> FleetBook::changes() {
  return std::exchange(changes_, {});
}

FleetFile open_fleet_file(const std::filesystem::path& path) {
  MapFile file = MapFile::open(path, MapMode::update);
  const std::map<std::string, std::string> kept = file.kept();
  // What an agent keeps replaces the landmarks of a file.
  if (kept.empty() && (!file.load().list.empty() || !file.runs().empty()))
    throw Error(path.string() + ": is the map of a robot, expected one of `cairn agent map`, or a new file");
  return {std::move(file), FleetBook(kept)};
}

}  // namespace cairn::fleet
