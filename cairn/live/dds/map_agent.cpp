// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/core/error.hpp>
#include <cairn/fleet/fleet_book.hpp>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <future>
#include <numbers>
#include <set>
#include <utility>

#include <cairn/live/dds/agents.hpp>
#include <cairn/ros/from_step.hpp>

namespace cairn::live {
namespace {

using namespace std::chrono_literals;
namespace topics = fleet_topics;

constexpr auto kInterval = 1s;        // between two words of the agent, and between two shared maps
constexpr auto kTransforms = 500ms;   // between two messages of /tf
constexpr auto kBetweenWrites = 10s;  // to the file
constexpr int kRestAfterSharing = 4;  // times as long as sharing took

std::string pose_text(const Pose& pose) {
  std::array<char, 96> text{};
  std::snprintf(text.data(), text.size(), "x %.2f m, y %.2f m, %.1f degrees", pose.translation_m.x,
                pose.translation_m.y, yaw_of(pose) * 180 / std::numbers::pi);
  return text.data();
}

class MapAgent {
 public:
  explicit MapAgent(const MapAgentOptions& options)
      : options_(options),
        kept_(fleet::open_fleet_file(options.file)),
        participant_(fleet_participant(options.domain)),
        landmarks_(participant_, topics::kLandmarks, topics::kReadRows),
        floor_(participant_, topics::kFloor, topics::kReadRows),
        index_(participant_, topics::kIndex, topics::kReadRows),
        agents_(participant_, topics::kAgents, topics::kReadAgents),
        map_(participant_, topics::kMapLandmarks, topics::kRows),
        transforms_(participant_, "/tf"),
        voice_(participant_, "map", "map", fleet::map_id_of(kept_.file.map_id()).value_or(fleet::MapId{})),
        wait_(participant_, {&landmarks_, &floor_, &index_, &agents_}) {
    for (const auto& [robot, pose] : options.given) kept_.book.give(robot, pose);
    begin_sharing();
  }

  void run() {
    while (!options_.is_ended()) {
      wait_.wait(100ms);
      // While maps are merged, which is not here, the agent still hears and says.
      voice_.assert_alive();
      hear_rows();
      hear_agents();
      const auto now = Clock::now();
      if (sharing_.valid() && sharing_.wait_for(0s) == std::future_status::ready) finish_sharing();
      if (has_changed_ && !sharing_.valid() && now >= next_share_) begin_sharing();
      if (is_unwritten_ && now - written_ >= kBetweenWrites) write();
      if (now - said_ >= kInterval) {
        said_ = now;
        voice_.send(status());
      }
      if (now - transformed_ >= kTransforms) transform();
    }
    if (sharing_.valid()) finish_sharing();
    hear_rows();
    begin_sharing();
    finish_sharing();
    write();
    map_.wait_for_readers(kInterval);
    voice_.end(status());
  }

 private:
  using Outcome = fleet::FleetBook::Outcome;

  template <class Row>
  void hear_rows_of(ros::Reader<Row>& reader) {
    while (const auto bytes = reader.BytesReader::take()) {
      try {
        const auto row = ros::decode<Row>(*bytes);
        const Outcome outcome = kept_.book.add(row);
        has_changed_ |= outcome == Outcome::changed;
        if (outcome == Outcome::older) {
          say_once(
              robot_of(row).name +
              ": its map is older than what it has shared before, as if it was restored from a copy; what "
              "it shares is not taken until it is forgotten (--forget)");
        }
      } catch (const Error&) {  // not such a message: whose it is cannot be told
        ++undecoded_;
        say_once("rows that cannot be read are ignored: is another version of cairn in this domain?");
      }
    }
  }
  void hear_rows() {
    hear_rows_of(landmarks_);
    hear_rows_of(floor_);
    hear_rows_of(index_);
    for (const auto& [robot, refused] : kept_.book.refused()) {
      say_once((robot.name.empty() ? "a robot without a valid name" : robot.name) +
               ": rows are ignored: " + refused.why);
    }
  }

  void say_once(const std::string& line) {
    constexpr std::size_t kMostLines = 1000;
    if (said_once_.size() < kMostLines && said_once_.insert(line).second) options_.say(line);
  }

  struct Heard {
    fleet::RobotKey robot;
    bool is_alive = true;
    Clock::time_point at;
  };
  void hear_agents() {
    while (const auto change = agents_.take_change()) {
      try {
        const fleet::MapId agent = agent_of(change->bytes);
        if (change->has_message) hear_agent(agent, ros::decode<fleet::AgentRow>(change->bytes));
        const auto known = heard_.find(agent);
        if (change->is_alive || known == heard_.end() || !known->second.is_alive) continue;
        known->second.is_alive = false;
        options_.say(known->second.robot.name + ": silent");
      } catch (const Error&) {
        ++undecoded_;
      }
    }
  }
  void hear_agent(const fleet::MapId& agent, const fleet::AgentRow& row) {
    if (row.role != "perception" || !fleet::fault_of(row).empty()) return;
    const fleet::RobotKey robot{row.map_id, row.name};
    const auto known = heard_.find(agent);
    const bool was_alive = known != heard_.end() && known->second.is_alive;
    if (known == heard_.end()) {
      // The former process of the robot.
      std::erase_if(heard_,
                    [&](const auto& one) { return !one.second.is_alive && one.second.robot == robot; });
      if (heard_.size() >= kMostHeard)
        std::erase_if(heard_, [](const auto& one) { return !one.second.is_alive; });
      if (heard_.size() >= kMostHeard) return;
    }
    if (was_alive == row.has_ended) options_.say(robot.name + (row.has_ended ? ": ended" : ": there"));
    heard_[agent] = {robot, !row.has_ended, Clock::now()};
    fleet::MapId& current = current_[robot.name];
    if (current == robot.map_id) return;
    current = robot.map_id;
    has_changed_ = true;  // what is given for the name is meant for this map
  }

  /// Robots whose name is that of another map now: their map file was deleted.
  [[nodiscard]] bool is_former(const fleet::RobotKey& robot) const {
    const auto current = current_.find(robot.name);
    return current != current_.end() && current->second != robot.map_id;
  }

  void begin_sharing() {
    has_changed_ = false;
    std::vector<fleet::RobotMap> maps = kept_.book.maps();
    std::set<fleet::RobotKey> former;
    for (const fleet::RobotMap& map : maps) {
      if (is_former(map.robot)) former.insert(map.robot);
    }
    fleet::Placements placements = kept_.book.placements(former);
    if (!maps.empty() && placements.known.empty())
      say_once("no robot whose place is given (--at) has shared anything yet: all places are unknown");
    began_sharing_ = Clock::now();
    sharing_ = std::async(std::launch::async, [maps = std::move(maps), placements = std::move(placements),
                                               ids = kept_.book.ids()]() mutable {
      return fleet::share(std::move(maps), placements, ids, LandmarksConfig{});
    });
  }
  void finish_sharing() {
    fleet::SharedMap shared = sharing_.get();
    next_share_ = Clock::now() +
                  std::max<Clock::duration>(kInterval, kRestAfterSharing * (Clock::now() - began_sharing_));
    kept_.book.set_ids(shared.ids);
    kept_.book.set_places(shared.robots);
    report(shared);
    shared_ = std::move(shared);
    is_unwritten_ = true;
    publish();
  }

  /// Says which robots have found their place, or lost it.
  void report(const fleet::SharedMap& now) const {
    for (const fleet::PlacedRobot& robot : now.robots) {
      const auto before = std::ranges::find(shared_.robots, robot.robot, &fleet::PlacedRobot::robot);
      const bool was_there = before != shared_.robots.end();
      const bool was_located = was_there && before->map_from_robot;
      if (robot.map_from_robot && !was_located) {
        options_.say(robot.robot.name + ": located at " + pose_text(*robot.map_from_robot) + ", " +
                     std::to_string(robot.pairs) + " common landmarks");
      } else if (!robot.map_from_robot && (was_located || !was_there)) {
        options_.say(robot.robot.name +
                     ": place unknown: " + std::string(choice_name(robot.refusal, kRecognitionRefusals)));
      }
    }
  }

  /// The view for people: without what is in the place of another landmark.
  void publish() {
    std::vector<Landmark> shown;
    for (std::size_t i = 0; i < shared_.landmarks.size(); ++i) {
      if (shared_.landmarks[i].part_of == LandmarkId::none) shown.push_back(shared_.map.list[i]);
    }
    map_.write(ros::landmarks_of({wall_clock(), "map"}, shown));
  }

  void transform() {
    transformed_ = Clock::now();
    ros::TFMessage message;
    for (const fleet::PlacedRobot& robot : shared_.robots) {
      if (!robot.map_from_robot || is_former(robot.robot)) continue;
      const Point3 at = robot.map_from_robot->translation_m;
      const auto turn = quaternion(*robot.map_from_robot);
      message.transforms.push_back({{wall_clock(), "map"},
                                    robot.robot.name + "/map",
                                    {{at.x, at.y, at.z}, {turn[0], turn[1], turn[2], turn[3]}}});
    }
    if (!message.transforms.empty() && transforms_.has_reader()) transforms_.write(message);
  }

  void write() {
    kept_.file.keep(kept_.book.changes(), shared_.map);
    written_ = Clock::now();
    is_unwritten_ = false;
  }

  /// A robot as others see it; `placed`: null if it has no row that is sound.
  fleet::KnownRobotRow row_of(const fleet::RobotKey& robot, const fleet::PlacedRobot* placed) const {
    fleet::KnownRobotRow row;
    row.name = robot.name;
    row.map_id = robot.map_id;
    if (placed != nullptr && placed->map_from_robot) {
      row.is_located = true;
      const Point3 at = placed->map_from_robot->translation_m;
      row.position = {at.x, at.y, at.z};
      row.yaw = yaw_of(*placed->map_from_robot);
    } else if (placed != nullptr) {
      row.refusal = choice_name(placed->refusal, kRecognitionRefusals);
    } else {
      row.refusal = "rows ignored";
    }
    if (placed != nullptr) {
      row.landmarks = static_cast<std::int32_t>(placed->landmarks);
      row.pairs = static_cast<std::int32_t>(placed->pairs);
    }
    if (is_former(robot)) row.refusal = "a former map of this robot";
    for (const auto& [agent, heard] : heard_) {
      if (heard.robot != robot) continue;
      const double ago = std::chrono::duration<double>(Clock::now() - heard.at).count();
      row.heard_s_ago = row.heard_s_ago < 0 ? ago : std::min(row.heard_s_ago, ago);
    }
    const auto refused = kept_.book.refused().find(robot);
    if (refused != kept_.book.refused().end()) row.ignored = refused->second.rows;
    return row;
  }

  /// Sets the robots of the row, too.
  ros::DiagnosticStatus status() {
    voice_.row.landmarks = static_cast<std::int32_t>(shared_.map.list.size());
    voice_.row.robots.clear();
    for (const fleet::PlacedRobot& placed : shared_.robots)
      voice_.row.robots.push_back(row_of(placed.robot, &placed));
    for (const auto& [robot, refused] : kept_.book.refused()) {
      const bool is_listed =
          std::ranges::find(shared_.robots, robot, &fleet::PlacedRobot::robot) != shared_.robots.end();
      if (!is_listed && !robot.name.empty()) voice_.row.robots.push_back(row_of(robot, nullptr));
    }
    ros::DiagnosticStatus status;
    status.name = "cairn: map";
    std::size_t lost = 0;
    int ignored = undecoded_;
    for (const fleet::KnownRobotRow& row : voice_.row.robots) {
      lost += row.is_located || is_former({row.map_id, row.name}) ? 0 : 1;
      ignored += row.ignored;
      status.values.push_back({"robot " + row.name, row.is_located ? "located" : row.refusal});
    }
    status.values.push_back({"landmarks", std::to_string(voice_.row.landmarks)});
    status.message =
        std::to_string(shared_.robots.size()) + (shared_.robots.size() == 1 ? " robot" : " robots");
    const bool is_ignoring = ignored > ignored_before_;
    ignored_before_ = ignored;
    if (is_ignoring) {
      status.level = ros::DiagnosticStatus::kWarn;
      status.message = std::to_string(ignored) + " rows ignored";
    } else if (lost > 0) {
      status.level = ros::DiagnosticStatus::kWarn;
      status.message = "the place of " + std::to_string(lost) + " of " +
                       std::to_string(voice_.row.robots.size()) + " robots is unknown";
    }
    return status;
  }

  static constexpr std::size_t kMostHeard = 4 * fleet::FleetBook::kMostRobots;

  const MapAgentOptions& options_;
  fleet::FleetFile kept_;
  ros::Participant participant_;
  ros::Reader<fleet::LandmarkRow> landmarks_;
  ros::Reader<fleet::FloorRow> floor_;
  ros::Reader<fleet::IndexRow> index_;
  ros::Reader<fleet::AgentRow> agents_;
  ros::Writer<ros::Detection3DArray> map_;
  ros::Writer<ros::TFMessage> transforms_;
  AgentVoice voice_;
  ros::ReaderWait wait_;
  std::map<fleet::MapId, Heard> heard_;          // by process
  std::map<std::string, fleet::MapId> current_;  // by name: the map that was heard last
  std::set<std::string> said_once_;
  int undecoded_ = 0;
  int ignored_before_ = 0;
  fleet::SharedMap shared_;
  std::future<fleet::SharedMap> sharing_;
  bool has_changed_ = false;
  bool is_unwritten_ = false;
  Clock::time_point began_sharing_;
  Clock::time_point next_share_;
  Clock::time_point written_;
  Clock::time_point said_;
  Clock::time_point transformed_;
};

}  // namespace

void map_agent(const MapAgentOptions& options) {
  MapAgent(options).run();
}

}  // namespace cairn::live
