// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <cairn/ros/messages.hpp>

/// The messages between agents (docs/agents.md). kKeyMembers: number of leading members that are the key of the DDS topic.
namespace cairn::fleet {

/// Of a map file and its copies.
using MapId = std::array<std::uint8_t, 16>;
/// Of a robot, filled up with zeros.
using NameBytes = std::array<std::uint8_t, 32>;

struct LookRow {
  static constexpr std::string_view kType = "cairn_msgs/msg/LandmarkLook";
  std::uint8_t octant = 0;
  std::int32_t pixels = 0;
  std::array<float, 72> colours{};
  static void each(auto& m, auto&& visit) {
    visit("octant", m.octant);
    visit("pixels", m.pixels);
    visit("colours", m.colours);
  }
};

/// A landmark of a robot's own map, in the frame of that map. See Landmark for the members.
struct LandmarkRow {
  static constexpr std::string_view kType = "cairn_msgs/msg/Landmark";
  static constexpr int kKeyMembers = 3;
  MapId map_id{};
  NameBytes robot{};
  std::int64_t id = 0;
  std::uint64_t version = 0;  // of the robot's rows: grows with each that is sent
  std::string name;
  bool is_gone = false;
  ros::Point position;  // m
  std::array<double, 9> covariance{};
  double narrowest = 0;  // m
  double widest = 0;
  double height = 0;
  double height_over_floor = 0;
  double log_odds = 0;
  std::int32_t seen = 0;
  std::int32_t expected = 0;
  std::int32_t seen_through = 0;
  double open_share = 0;
  std::int64_t first_ns = 0;
  std::int64_t last_ns = 0;
  std::int64_t run = 0;
  std::vector<LookRow> looks;
  static void each(auto& m, auto&& visit) {
    visit("map_id", m.map_id);
    visit("robot", m.robot);
    visit("id", m.id);
    visit("version", m.version);
    visit("name", m.name);
    visit("is_gone", m.is_gone);
    visit("position", m.position);
    visit("covariance", m.covariance);
    visit("narrowest", m.narrowest);
    visit("widest", m.widest);
    visit("height", m.height);
    visit("height_over_floor", m.height_over_floor);
    visit("log_odds", m.log_odds);
    visit("seen", m.seen);
    visit("expected", m.expected);
    visit("seen_through", m.seen_through);
    visit("open_share", m.open_share);
    visit("first_ns", m.first_ns);
    visit("last_ns", m.last_ns);
    visit("run", m.run);
    visit("looks", m.looks);
  }
};

/// Free floor of a robot's own map: kTile × kTile cells of kFloorCell_m.
struct FloorRow {
  static constexpr std::string_view kType = "cairn_msgs/msg/FloorTile";
  static constexpr int kKeyMembers = 4;
  static constexpr int kTile = 8;
  MapId map_id{};
  NameBytes robot{};
  std::int32_t x = 0;  // of the cell / kTile, rounded down
  std::int32_t y = 0;
  std::uint64_t version = 0;
  std::array<std::int32_t, 64> frames{};  // of each cell, by y, then x; 0: not known to be free
  static void each(auto& m, auto&& visit) {
    visit("map_id", m.map_id);
    visit("robot", m.robot);
    visit("x", m.x);
    visit("y", m.y);
    visit("version", m.version);
    visit("frames", m.frames);
  }
};

/// All rows that a robot's map has: others are no longer in it.
struct IndexRow {
  static constexpr std::string_view kType = "cairn_msgs/msg/MapIndex";
  static constexpr int kKeyMembers = 2;
  MapId map_id{};
  NameBytes robot{};
  std::uint64_t version = 0;  // rows of a later version are newer than this list
  std::vector<std::int64_t> landmarks;
  std::vector<std::int32_t> tile_x;
  std::vector<std::int32_t> tile_y;
  static void each(auto& m, auto&& visit) {
    visit("map_id", m.map_id);
    visit("robot", m.robot);
    visit("version", m.version);
    visit("landmarks", m.landmarks);
    visit("tile_x", m.tile_x);
    visit("tile_y", m.tile_y);
  }
};

/// A robot as the map agent knows it.
struct KnownRobotRow {
  static constexpr std::string_view kType = "cairn_msgs/msg/KnownRobot";
  std::string name;
  MapId map_id{};
  std::int32_t landmarks = 0;
  bool is_located = false;
  ros::Point position;  // of its map in the shared one, m
  double yaw = 0;       // rad
  std::int32_t pairs = 0;
  std::string refusal;       // why it is not located
  double heard_s_ago = -1;   // −1: not since the map agent began
  std::int32_t ignored = 0;  // rows that were refused
  static void each(auto& m, auto&& visit) {
    visit("name", m.name);
    visit("map_id", m.map_id);
    visit("landmarks", m.landmarks);
    visit("is_located", m.is_located);
    visit("position", m.position);
    visit("yaw", m.yaw);
    visit("pairs", m.pairs);
    visit("refusal", m.refusal);
    visit("heard_s_ago", m.heard_s_ago);
    visit("ignored", m.ignored);
  }
};

/// What an agent says of itself, once a second.
struct AgentRow {
  static constexpr std::string_view kType = "cairn_msgs/msg/Agent";
  static constexpr int kKeyMembers = 1;
  MapId agent{};     // of this process
  std::string role;  // "perception" or "map"
  std::string name;  // of the robot; of a map agent "map"
  std::string host;
  std::int32_t process = 0;
  MapId map_id{};
  ros::Time stamp;         // when it was sent, by the clock of its computer
  std::uint8_t level = 0;  // as in diagnostics: 0 ok, 1 warning, 2 error
  std::string message;
  bool has_ended = false;  // in good order: its last word
  double rate_hz = 0;
  double reliability = -1;  // −1: unknown
  std::string weakest;      // witness of the reliability
  std::uint64_t frames = 0;
  std::int32_t objects = 0;
  std::int32_t tracks = 0;
  std::int32_t landmarks = 0;
  std::vector<KnownRobotRow> robots;  // of a map agent
  static void each(auto& m, auto&& visit) {
    visit("agent", m.agent);
    visit("role", m.role);
    visit("name", m.name);
    visit("host", m.host);
    visit("process", m.process);
    visit("map_id", m.map_id);
    visit("stamp", m.stamp);
    visit("level", m.level);
    visit("message", m.message);
    visit("has_ended", m.has_ended);
    visit("rate_hz", m.rate_hz);
    visit("reliability", m.reliability);
    visit("weakest", m.weakest);
    visit("frames", m.frames);
    visit("objects", m.objects);
    visit("tracks", m.tracks);
    visit("landmarks", m.landmarks);
    visit("robots", m.robots);
  }
};

/// Where a map is in the shared one: kept in the file of a map agent.
struct PlaceRow {
  static constexpr std::string_view kType = "cairn_msgs/msg/Place";
  MapId map_id{};     // of a place that was found
  NameBytes robot{};  // of a place that was given
  ros::Pose map_from_robot;
  static void each(auto& m, auto&& visit) {
    visit("map_id", m.map_id);
    visit("robot", m.robot);
    visit("map_from_robot", m.map_from_robot);
  }
};

/// A landmark of the shared map, and those of robots' maps that it is made of: kept in the file of a map agent, so that
/// ids stay.
struct SharedIdRow {
  static constexpr std::string_view kType = "cairn_msgs/msg/SharedId";
  std::int64_t id = 0;
  std::vector<MapId> map_ids;
  std::vector<NameBytes> robots;
  std::vector<std::int64_t> landmarks;
  static void each(auto& m, auto&& visit) {
    visit("id", m.id);
    visit("map_ids", m.map_ids);
    visit("robots", m.robots);
    visit("landmarks", m.landmarks);
  }
};

}  // namespace cairn::fleet
