// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <algorithm>
#include <cairn/core/error.hpp>
#include <cairn/fleet/fleet_book.hpp>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <set>
#include <variant>

#include "support/landmark_rooms.hpp"
#include "support/temporary_folder.hpp"

/// What robots share: rows, and one map made of them, whatever the order in which they come.
namespace cairn::fleet {
namespace {

RobotKey robot(std::uint8_t map, const std::string& name) {
  return {{map, 1, 2}, name};
}

// ---- rows ----

void expect_equal(const Landmark& a, const Landmark& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.is_gone, b.is_gone);
  EXPECT_EQ(a.position_m, b.position_m);
  EXPECT_EQ(a.covariance_m2, b.covariance_m2);
  EXPECT_EQ(a.size.narrowest_m, b.size.narrowest_m);
  EXPECT_EQ(a.size.widest_m, b.size.widest_m);
  EXPECT_EQ(a.size.height_m, b.size.height_m);
  EXPECT_EQ(a.height_over_floor_m, b.height_over_floor_m);
  EXPECT_EQ(a.log_odds, b.log_odds);
  EXPECT_EQ(a.seen, b.seen);
  EXPECT_EQ(a.expected, b.expected);
  EXPECT_EQ(a.seen_through, b.seen_through);
  EXPECT_EQ(a.open_share, b.open_share);
  EXPECT_EQ(a.first, b.first);
  EXPECT_EQ(a.last, b.last);
  ASSERT_EQ(a.looks.size(), b.looks.size());
  for (std::size_t i = 0; i < a.looks.size(); ++i) {
    EXPECT_EQ(a.looks[i].octant, b.looks[i].octant);
    EXPECT_EQ(a.looks[i].pixels, b.looks[i].pixels);
    EXPECT_EQ(a.looks[i].colours, b.looks[i].colours);
  }
}

TEST(FleetRows, HoldAllOfALandmarkButItsCrop) {
  Landmark landmark = room_of(1, 3)[0];
  landmark.name = "cup";
  landmark.is_gone = true;
  landmark.seen_through = 4;
  landmark.open_share = 0.25;
  landmark.looks[0].crop_png = "png";
  const LandmarkRow row = row_of(landmark, robot(1, "a"), 7);
  EXPECT_EQ(fault_of(row), "");
  EXPECT_EQ(robot_of(row), robot(1, "a"));
  const Landmark back = landmark_of(ros::decode<LandmarkRow>(ros::encode(row)));
  expect_equal(landmark, back);
  EXPECT_EQ(back.id, landmark.id);
  EXPECT_EQ(back.run, landmark.run);
  EXPECT_EQ(back.looks[0].crop_png, "");
}

TEST(FleetRows, FloorIsTheSameFromItsTiles) {
  const LandmarkMap map = map_of({}, 0, 0, {});
  const std::vector<FloorRow> tiles = rows_of(map.floor, robot(1, "a"), 1);
  EXPECT_EQ(tiles.size(), 9U);  // x from -3 to 11, y from -2 to 8
  for (const FloorRow& tile : tiles) EXPECT_EQ(fault_of(tile), "");
  EXPECT_EQ(cells_of(tiles), map.floor);
}

TEST(FleetRows, AreCheckedAsForeignBytes) {
  const LandmarkRow good = row_of(room_of(1, 3)[0], robot(1, "a"), 1);
  const auto fault = [&](const auto& change) {
    LandmarkRow row = good;
    change(row);
    return fault_of(row);
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(fault([](LandmarkRow&) {}), "");
  EXPECT_NE(fault([](LandmarkRow& r) { r.robot = {}; }), "");
  EXPECT_NE(fault([](LandmarkRow& r) { r.robot[0] = 'A'; }), "");
  EXPECT_NE(fault([](LandmarkRow& r) { r.robot[5] = 'x'; }), "");  // after its end
  EXPECT_NE(fault([](LandmarkRow& r) { r.id = 0; }), "");
  EXPECT_NE(fault([](LandmarkRow& r) { r.id = std::numeric_limits<std::int64_t>::max(); }), "");
  EXPECT_NE(fault([](LandmarkRow& r) { r.name = std::string(65, 'x'); }), "");
  EXPECT_NE(fault([](LandmarkRow& r) { r.name = "a\nb"; }), "");
  EXPECT_NE(fault([](LandmarkRow& r) { r.position.y = kNan; }), "");
  EXPECT_NE(fault([](LandmarkRow& r) { r.position.z = 1e5; }), "");
  EXPECT_NE(fault([](LandmarkRow& r) { r.covariance[1] = 0.1; }), "");
  EXPECT_NE(fault([](LandmarkRow& r) { r.covariance[4] = -1; }), "");
  EXPECT_NE(fault([](LandmarkRow& r) { r.covariance = {}; }), "");
  EXPECT_NE(fault([](LandmarkRow& r) { r.covariance = {1e-103, 0, 0, 0, 1e-103, 0, 0, 0, 1e-103}; }), "");
  EXPECT_NE(fault([](LandmarkRow& r) { r.covariance = {1, 1, 0, 1, 1, 0, 0, 0, 1}; }), "");
  EXPECT_NE(fault([](LandmarkRow& r) { r.seen = std::numeric_limits<std::int32_t>::max(); }), "");
  EXPECT_NE(fault([](LandmarkRow& r) { r.widest = -1; }), "");
  EXPECT_NE(fault([](LandmarkRow& r) { r.height_over_floor = kNan; }), "");
  EXPECT_NE(fault([](LandmarkRow& r) { r.log_odds = 6; }), "");
  EXPECT_NE(fault([](LandmarkRow& r) { r.expected = -1; }), "");
  EXPECT_NE(fault([](LandmarkRow& r) { r.open_share = 1.5; }), "");
  EXPECT_NE(fault([](LandmarkRow& r) { r.looks.resize(9, r.looks[0]); }), "");
  EXPECT_NE(fault([](LandmarkRow& r) { r.looks.resize(2, r.looks[0]); }), "");  // one octant twice
  EXPECT_NE(fault([](LandmarkRow& r) { r.looks[0].octant = 8; }), "");
  EXPECT_NE(fault([](LandmarkRow& r) { r.looks[0].colours[70] = 0.5; }), "");
  EXPECT_NE(fault([](LandmarkRow& r) { r.looks[0].pixels = -1; }), "");
  FloorRow tile = rows_of({{0, 0, 3}}, robot(1, "a"), 1)[0];
  tile.frames[7] = -1;
  EXPECT_NE(fault_of(tile), "");
  tile.frames[7] = 0;
  tile.x = std::numeric_limits<std::int32_t>::min();
  EXPECT_NE(fault_of(tile), "");
  IndexRow index;
  index.robot = bytes_of("a");
  EXPECT_EQ(fault_of(index), "");
  index.tile_x = {1};
  EXPECT_NE(fault_of(index), "");
  AgentRow agent;
  agent.role = "perception";
  agent.name = "a";
  EXPECT_EQ(fault_of(agent), "");
  agent.message = "\nWATCHDOG=trigger";
  EXPECT_NE(fault_of(agent), "");
  agent.message = "";
  agent.name = "map";
  EXPECT_NE(fault_of(agent), "");
  agent.role = "map";
  EXPECT_EQ(fault_of(agent), "");
  agent.robots.resize(1);
  EXPECT_NE(fault_of(agent), "");
}

TEST(FleetRows, NamesAndIdentitiesAreChecked) {
  EXPECT_EQ(checked_robot("robot_2", "--share"), "robot_2");
  for (const char* const wrong :
       {"", "2", "A", "map", "a-b", "_a", "a b", "a23456789012345678901234567890123"})
    EXPECT_THROW(checked_robot(wrong, "--share"), Error) << wrong;
  const std::string digits = "00112233445566778899aabbccddeeff";
  EXPECT_EQ(digits_of(map_id_of(digits).value()), digits);
  EXPECT_FALSE(map_id_of(digits + "0"));
  EXPECT_FALSE(map_id_of("0011223344556677 899aabbccddeeff"));
}

TEST(FleetRows, OnlyWhatChangedIsSent) {
  LandmarkMap map = map_of(room_of(5, 1), 0, 5, {});
  RowDifferences differences(robot(1, "a"));
  differences.begin_run(2);
  const auto first = differences.next(map);
  EXPECT_EQ(first.landmarks.size(), 5U);
  EXPECT_EQ(first.floor.size(), 9U);
  ASSERT_TRUE(first.index);
  EXPECT_EQ(first.index->landmarks.size(), 5U);
  EXPECT_GE(first.landmarks[0].version, std::uint64_t{2} << 32U);

  // What could not be sent comes again.
  differences.is_unsent(first.landmarks[1]);
  differences.is_unsent(first.floor[2]);
  const auto again = differences.next(map);
  ASSERT_EQ(again.landmarks.size(), 1U);
  EXPECT_EQ(again.landmarks[0].id, first.landmarks[1].id);
  ASSERT_EQ(again.floor.size(), 1U);
  EXPECT_EQ(again.floor[0].x, first.floor[2].x);
  EXPECT_TRUE(again.index);
  const auto same = differences.next(map);
  EXPECT_TRUE(same.landmarks.empty() && same.floor.empty() && !same.index);

  map.list[3].seen++;
  map.floor[0].frames++;
  const auto changed = differences.next(map);
  ASSERT_EQ(changed.landmarks.size(), 1U);
  EXPECT_EQ(changed.landmarks[0].id, number(map.list[3].id));
  EXPECT_GT(changed.landmarks[0].version, first.landmarks[3].version);
  EXPECT_EQ(changed.floor.size(), 1U);
  EXPECT_FALSE(changed.index);

  map.list.erase(map.list.begin());
  const auto fewer = differences.next(map);
  EXPECT_TRUE(fewer.landmarks.empty());
  ASSERT_TRUE(fewer.index);
  EXPECT_EQ(fewer.index->landmarks.size(), 4U);
  map.list.push_back(room_of(6, 1)[5]);  // one more needs no index
  const auto more = differences.next(map);
  EXPECT_EQ(more.landmarks.size(), 1U);
  EXPECT_FALSE(more.index);
}

// ---- the shared map ----

class SharedMaps : public testing::Test {
 protected:
  static Placements at(const MapId& origin) { return {{{origin, Pose{}}}, {}}; }
  const std::vector<Landmark> room_ = room_of(20, 11);
  const std::vector<RobotMap> robots_{{robot(3, "a"), map_of(room_, 0, 12, {})},
                                      {robot(2, "b"), map_of(room_, 4, 16, turned_by(1.1, 3, -2))},
                                      {robot(1, "c"), map_of(room_, 10, 20, turned_by(-2, -1, 4))}};
  const LandmarksConfig config_;
};

TEST_F(SharedMaps, AreThoseOfMergedFiles) {
  const auto origin = origin_of(robots_);
  ASSERT_TRUE(origin);
  EXPECT_EQ(*origin, robots_[1].robot.map_id);  // as many landmarks as a, and a lower identity
  const Placements placements = at(robots_[0].robot.map_id);
  const SharedMap shared = share(robots_, placements, {}, config_);
  MapsMerge merged =
      merge_all(robots_[0].map, {{robots_[2].map, false, {}}, {robots_[1].map, false, {}}}, config_);
  ASSERT_EQ(shared.map.list.size(), room_.size());
  ASSERT_EQ(merged.map.list.size(), room_.size());
  for (std::size_t i = 0; i < room_.size(); ++i) expect_equal(shared.map.list[i], merged.map.list[i]);
  EXPECT_EQ(shared.map.floor, merged.map.floor);
  for (const PlacedRobot& placed : shared.robots) EXPECT_TRUE(placed.map_from_robot) << placed.robot.name;
  // Each landmark says of whom it is.
  std::size_t members = 0;
  for (std::size_t i = 0; i < shared.landmarks.size(); ++i) {
    EXPECT_EQ(shared.landmarks[i].id, shared.map.list[i].id);
    members += shared.landmarks[i].of.size();
  }
  EXPECT_EQ(members, 34U);
}

TEST_F(SharedMaps, KeepTheirIds) {
  const Placements placements = at(robots_[0].robot.map_id);
  // b is there later than a and c, c gets more landmarks, then b leaves.
  std::vector<RobotMap> now{robots_[0], {robots_[2].robot, map_of(room_, 10, 16, turned_by(-2, -1, 4))}};
  SharedMap shared = share(now, placements, {}, config_);
  std::map<std::int64_t, Point3> places;
  const auto note = [&] {
    for (const Landmark& landmark : shared.map.list) {
      const auto [known, is_new] = places.emplace(number(landmark.id), landmark.position_m);
      EXPECT_LT(std::hypot(known->second.x - landmark.position_m.x, known->second.y - landmark.position_m.y),
                0.2)
          << number(landmark.id);
    }
  };
  note();
  now = robots_;
  shared = share(now, placements, shared.ids, config_);
  note();
  EXPECT_EQ(shared.map.list.size(), room_.size());
  now.erase(now.begin() + 1);
  shared = share(now, placements, shared.ids, config_);
  note();
  EXPECT_LT(shared.map.list.size(), room_.size() + 1);
  EXPECT_EQ(share(now, placements, shared.ids, config_).ids, shared.ids);
  const SharedMap again = share(robots_, placements, shared.ids, config_);
  EXPECT_EQ(again.map.list.size(), room_.size());
}

TEST_F(SharedMaps, AnotherRoomStaysUnknownAndAGivenPlaceIsTaken) {
  std::vector<RobotMap> robots = robots_;
  robots.push_back({robot(9, "elsewhere"), map_of(room_of(8, 99), 0, 8, {})});
  const Placements unknown = at(robots[0].robot.map_id);
  const SharedMap without = share(robots, unknown, {}, config_);
  const PlacedRobot& lost = without.robots.back();
  EXPECT_EQ(lost.robot.name, "elsewhere");
  EXPECT_FALSE(lost.map_from_robot);
  EXPECT_NE(lost.refusal, RecognitionRefusal::none);
  EXPECT_EQ(without.map.list.size(), room_.size());
  Placements given = unknown;
  given.known[robots.back().robot.map_id] = turned_by(0, 100, 0);
  const SharedMap with = share(robots, given, without.ids, config_);
  EXPECT_TRUE(with.robots.back().map_from_robot);
  EXPECT_EQ(with.map.list.size(), room_.size() + 8);
}

TEST_F(SharedMaps, CopiesOfOneMapAreMergedByTheirIds) {
  // b started with a's map and went on.
  RobotMap copy = robots_[0];
  copy.robot.name = "b";
  copy.map.list[2].seen += 10;
  copy.map.list[2].last.ns += 1000;
  copy.map.list[2].position_m.x += 2;  // carried away
  const SharedMap shared = share({robots_[0], copy}, at(copy.robot.map_id), {}, config_);
  EXPECT_EQ(shared.map.list.size(), robots_[0].map.list.size());
  EXPECT_EQ(shared.map.list[2].position_m.x, copy.map.list[2].position_m.x);
  EXPECT_EQ(shared.landmarks[2].of.size(), 2U);
}

TEST_F(SharedMaps, WhatTwoRobotsCutDifferentlyIsListedOnce) {
  std::vector<RobotMap> robots{robots_[0], robots_[1]};
  // To b, the thing has other colours, so it is not recognised.
  Landmark& theirs = robots[1].map.list[0];
  theirs.looks[0].colours = {};
  theirs.looks[0].colours[7] = 1;
  theirs.looks[0].colours[71] = 1;
  theirs.seen = 5;
  const SharedMap shared = share(robots, at(robots[0].robot.map_id), {}, config_);
  EXPECT_EQ(shared.map.list.size(), 17U);
  const auto part = std::ranges::find_if(
      shared.landmarks, [](const SharedLandmark& landmark) { return landmark.part_of != LandmarkId::none; });
  ASSERT_NE(part, shared.landmarks.end());
  EXPECT_EQ(part->of.front().robot.name, "b");
  EXPECT_EQ(
      std::ranges::count_if(shared.landmarks, [](const auto& l) { return l.part_of != LandmarkId::none; }),
      1);
}

// ---- the book ----

using AnyRow = std::variant<LandmarkRow, FloorRow, IndexRow>;

/// The rows that a robot sends while its map grows.
std::vector<AnyRow> history_of(const RobotMap& robot) {
  RowDifferences differences(robot.robot);
  differences.begin_run(1);
  std::vector<AnyRow> rows;
  LandmarkMap map;
  const auto add = [&] {
    const auto changes = differences.next(map);
    rows.insert(rows.end(), changes.landmarks.begin(), changes.landmarks.end());
    rows.insert(rows.end(), changes.floor.begin(), changes.floor.end());
    if (changes.index) rows.emplace_back(*changes.index);
  };
  for (const Landmark& landmark : robot.map.list) {
    map.list.push_back(landmark);
    map.list.back().seen = 1;
    add();
    if (map.list.size() == 5) {  // a new beginning in a segment of its own
      map.list.clear();
      map.floor = {{50, 50, 1}};
      add();
      map.floor.clear();
    }
  }
  map = robot.map;
  add();
  return rows;
}

FleetBook::Outcome add(FleetBook& book, const AnyRow& row) {
  return std::visit([&](const auto& one) { return book.add(one); }, row);
}

TEST_F(SharedMaps, AreTheSameForAnyOrderOfRows) {
  std::vector<AnyRow> rows;
  for (const RobotMap& robot : robots_) {
    for (AnyRow& row : history_of(robot)) rows.push_back(std::move(row));
  }
  const Placements placements = at(robots_[0].robot.map_id);
  const SharedMap expected = share(robots_, placements, {}, config_);
  std::mt19937 random(5);
  for (int trial = 0; trial < 100; ++trial) {
    std::vector<AnyRow> sent = rows;
    for (std::size_t i = 0; i < rows.size() / 3; ++i)
      sent.push_back(rows[random() % rows.size()]);  // repeated
    std::ranges::shuffle(sent, random);
    FleetBook book;
    for (std::size_t i = 0; i < sent.size(); ++i) {
      EXPECT_NE(add(book, sent[i]), FleetBook::Outcome::refused);
      // What was lost on the way is sent again, as durability does: the last row of each key.
      if (trial % 4 == 0 && i % 3 == 0) add(book, sent[random() % (i + 1)]);
    }
    const std::vector<RobotMap> maps = book.maps();
    ASSERT_EQ(maps.size(), robots_.size());
    const SharedMap shared = share(maps, placements, {}, config_);
    ASSERT_EQ(shared.map.list.size(), expected.map.list.size()) << trial;
    for (std::size_t i = 0; i < expected.map.list.size(); ++i)
      expect_equal(shared.map.list[i], expected.map.list[i]);
    EXPECT_EQ(shared.map.floor, expected.map.floor);
    EXPECT_EQ(shared.ids, expected.ids);
  }
}

TEST_F(SharedMaps, ComeBackFromAFile) {
  FleetBook book;
  for (const RobotMap& robot : robots_) {
    for (const AnyRow& row : history_of(robot)) add(book, row);
  }
  std::map<std::string, std::string> kept;
  const auto keep = [&] {
    for (const auto& [key, value] : book.changes()) {
      if (value) {
        kept[key] = *value;
      } else {
        kept.erase(key);
      }
    }
  };
  const auto shared_of = [&](FleetBook& from) {
    return share(from.maps(), from.placements(), from.ids(), config_);
  };
  SharedMap shared = shared_of(book);
  book.set_ids(shared.ids);
  book.set_places(shared.robots);
  keep();
  EXPECT_TRUE(book.changes().empty());
  FleetBook again(kept);
  EXPECT_EQ(again.ids(), book.ids());
  EXPECT_EQ(again.placements().known.begin()->first, book.placements().known.begin()->first);
  EXPECT_EQ(again.placements().last.size(), 3U);
  SharedMap back = shared_of(again);
  ASSERT_EQ(back.map.list.size(), shared.map.list.size());
  for (std::size_t i = 0; i < back.map.list.size(); ++i) {
    expect_equal(back.map.list[i], shared.map.list[i]);
    EXPECT_EQ(back.map.list[i].id, shared.map.list[i].id);
  }
  // Rows that arrive again change nothing, and damage loses only what it hits.
  for (const AnyRow& row : history_of(robots_[0])) EXPECT_NE(add(again, row), FleetBook::Outcome::changed);
  EXPECT_TRUE(again.changes().empty());
  for (auto& [key, value] : kept) value.resize(value.size() / 2);
  kept["landmark/x"] = "nonsense";
  EXPECT_NO_THROW(FleetBook{kept});
}

TEST_F(SharedMaps, DoNotMoveWhenTheirOriginIsForgotten) {
  FleetBook book;
  for (const RobotMap& robot : robots_) {
    for (const AnyRow& row : history_of(robot)) add(book, row);
  }
  const auto shared_of = [&] { return share(book.maps(), book.placements(), book.ids(), config_); };
  SharedMap before = shared_of();
  book.set_ids(before.ids);
  const std::string first = "b";  // the one with the lowest identity among the largest
  EXPECT_TRUE(book.placements().known.contains(robots_[1].robot.map_id));
  EXPECT_EQ(book.forget("nobody", before.robots), 0);
  EXPECT_EQ(book.forget(first, before.robots), 1);
  EXPECT_EQ(book.maps().size(), 2U);
  EXPECT_FALSE(book.placements().known.contains(robots_[1].robot.map_id));
  const SharedMap after = shared_of();
  for (const Landmark& landmark : after.map.list) {
    const Landmark* const was = find(before.map, landmark.id);
    ASSERT_NE(was, nullptr);
    EXPECT_LT(length(was->position_m - landmark.position_m), 0.1);
  }
}

/// What was found once needs less to be confirmed: a growing map does not lose its place.
TEST_F(SharedMaps, KeepTheirPlacesWithFewerCommonLandmarks) {
  std::vector<RobotMap> robots{robots_[0], {robots_[1].robot, map_of(room_, 9, 20, turned_by(1.1, 3, -2))}};
  const Placements placements = at(robots[0].robot.map_id);
  EXPECT_FALSE(share(robots, placements, {}, config_).robots[0].map_from_robot);  // three in common
  Placements known_before = placements;
  known_before.last[robots[1].robot.map_id] = inverse(turned_by(1.1, 3, -2));
  const SharedMap shared = share(robots, known_before, {}, config_);
  EXPECT_EQ(shared.robots[0].robot.name, "b");
  ASSERT_TRUE(shared.robots[0].map_from_robot);
  EXPECT_EQ(shared.robots[0].pairs, 3U);
  // But not against all evidence.
  known_before.last[robots[1].robot.map_id] = turned_by(0, 9, 9);
  EXPECT_FALSE(share(robots, known_before, {}, config_).robots[0].map_from_robot);
}

TEST_F(SharedMaps, GivenPlacesAreKeptAndMeanThePresentMapOfARobot) {
  FleetBook book;
  for (const RobotMap& robot : robots_) {
    for (const AnyRow& row : history_of(robot)) add(book, row);
  }
  book.give("c", turned_by(1, 5, 6));
  Placements placements = book.placements();
  EXPECT_EQ(placements.known.size(), 1U);
  EXPECT_EQ(placements.known.at(robots_[2].robot.map_id).translation_m.x, 5);
  EXPECT_TRUE(book.placements({robots_[2].robot}).known.empty());
  std::map<std::string, std::string> kept;
  for (const auto& [key, value] : book.changes()) kept[key] = value.value_or("");
  EXPECT_EQ(FleetBook(kept).given().at("c").translation_m.y, 6);
  EXPECT_EQ(book.forget("c", {}), 1);
  EXPECT_TRUE(book.given().empty());
}

TEST_F(SharedMaps, AnOlderIndexIsNoticed) {
  FleetBook book;
  const std::vector<AnyRow> rows = history_of(robots_[0]);
  for (const AnyRow& row : rows) add(book, row);
  IndexRow older;
  older.map_id = robots_[0].robot.map_id;
  older.robot = bytes_of("a");
  older.version = 1;
  EXPECT_EQ(book.add(older), FleetBook::Outcome::older);
  EXPECT_EQ(book.maps()[0].map.list.size(), robots_[0].map.list.size());
}

TEST(FleetFile, IsNotTheMapOfARobot) {
  const support::TemporaryFolder folder;
  const std::filesystem::path own = folder.path() / "a.db";
  MapFile::open(own, MapMode::update).replace(map_of(room_of(5, 1), 0, 5, {}));
  try {
    open_fleet_file(own);
    ADD_FAILURE() << "taken";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("is the map of a robot"), std::string::npos) << error.what();
  }
  EXPECT_EQ(MapFile::open(own, MapMode::read_only).load().list.size(), 5U);
  EXPECT_NO_THROW(open_fleet_file(folder.path() / "new.db"));
  EXPECT_NO_THROW(open_fleet_file(folder.path() / "new.db"));
}

TEST(FleetBook, RefusesWhatIsNotSoundAndTooMuch) {
  FleetBook book;
  LandmarkRow bad = row_of(room_of(1, 3)[0], robot(1, "a"), 1);
  bad.position.x = 1e9;
  EXPECT_EQ(book.add(bad), FleetBook::Outcome::refused);
  EXPECT_EQ(book.add(bad), FleetBook::Outcome::refused);
  EXPECT_EQ(book.refused().at(robot(1, "a")).rows, 2);
  EXPECT_TRUE(book.maps().empty());
  for (int i = 0; i < 200; ++i) {
    const LandmarkRow row = row_of(room_of(1, 3)[0], robot(static_cast<std::uint8_t>(i), "a"), 1);
    book.add(row);
  }
  EXPECT_EQ(book.maps().size(), FleetBook::kMostRobots);
  EXPECT_LE(book.refused().size(), FleetBook::kMostRobots + 1);
}

}  // namespace
}  // namespace cairn::fleet
