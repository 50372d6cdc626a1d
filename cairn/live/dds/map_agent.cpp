// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/core/error.hpp>
#include <cairn/fleet/fleet_book.hpp>
#include <cairn/sequence/map_file.hpp>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <tuple>
#include <utility>

#include <cairn/live/dds/agents.hpp>
#include <cairn/ros/from_step.hpp>

namespace cairn::live {
namespace {

using namespace std::chrono_literals;
namespace topics = fleet_topics;

constexpr auto kInterval = 1s;        // between two words of the agent, and between two shared maps
constexpr auto kTransforms = 500ms;   // between two messages of /tf
constexpr auto kBetweenWrites = 2s;   // to the file
constexpr int kRestAfterSharing = 4;  // times as long as sharing took

/// The yaw, in rad.
double yaw_of(const Pose& pose) {
  return std::atan2(pose.rotation[3], pose.rotation[0]);
}

std::string pose_text(const Pose& pose) {
  std::array<char, 96> text{};
  std::snprintf(text.data(), text.size(), "x %.2f m, y %.2f m, %.1f degrees", pose.translation_m.x,
                pose.translation_m.y, yaw_of(pose) * 180 / std::numbers::pi);
  return text.data();
}

ros::Time wall_clock() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return ros::time_of({std::chrono::duration_cast<std::chrono::nanoseconds>(now).count()});
}

class MapAgent {
 public:
  explicit MapAgent(const MapAgentOptions& options)
      : options_(options),
        file_(MapFile::open(options.file, MapMode::update)),
        book_(file_.kept()),
        participant_(fleet_participant(options.domain)),
        landmarks_(participant_, topics::kLandmarks, topics::kReadRows),
        floor_(participant_, topics::kFloor, topics::kReadRows),
        index_(participant_, topics::kIndex, topics::kReadRows),
        agents_(participant_, topics::kAgents, topics::kReadRows),
        map_(participant_, topics::kMapLandmarks, topics::kRows),
        transforms_(participant_, "/tf"),
        voice_(participant_, "map", "map", fleet::map_id_of(file_.map_id()).value_or(fleet::MapId{})),
        wait_(participant_, {&landmarks_, &floor_, &index_, &agents_}) {
    share();
  }

  void run() {
    while (!options_.is_ended()) {
      wait_.wait(100ms);
      voice_.assert_alive();
      take_rows();
      take_agents();
      const auto now = Clock::now();
      if (has_changed_ && now >= next_share_) share();
      if (is_unwritten_ && now - written_ >= kBetweenWrites) write();
      if (now - said_ >= kInterval) say("");
      if (now - transformed_ >= kTransforms) transform();
    }
    share();
    write();
    say(kEnded);
  }

 private:
  template <class Row>
  void take(ros::Reader<Row>& reader) {
    while (const auto bytes = reader.BytesReader::take()) {
      try {
        has_changed_ |= book_.take(ros::decode<Row>(*bytes)) == fleet::FleetBook::Taken::changed;
      } catch (const Error&) {  // not such a message: whose it is cannot be told
        ++undecoded_;
      }
    }
  }
  void take_rows() {
    take(landmarks_);
    take(floor_);
    take(index_);
    for (const auto& [robot, refused] : book_.refused()) {
      int& told = refusals_told_[robot];
      if (told == 0) options_.say(robot.name + ": rows are ignored: " + refused.why);
      told = refused.rows;
    }
  }

  struct Heard {
    fleet::RobotKey robot;
    bool is_alive = true;
    Clock::time_point at;
  };
  void take_agents() {
    while (const auto change = agents_.take_change()) {
      fleet::MapId agent{};
      if (change->bytes.size() < 4 + agent.size()) continue;
      std::copy_n(change->bytes.begin() + 4, agent.size(), agent.begin());
      const auto known = heard_.find(agent);
      if (!change->is_alive) {
        if (known == heard_.end() || !known->second.is_alive) continue;
        known->second.is_alive = false;
        options_.say(known->second.robot.name + ": silent");
        continue;
      }
      try {
        const auto row = ros::decode<fleet::AgentRow>(change->bytes);
        if (row.role != "perception") continue;
        const fleet::RobotKey robot{row.map_id, fleet::checked_robot(row.name, "")};
        const bool has_ended = row.message == kEnded;
        const bool was_alive = known != heard_.end() && known->second.is_alive;
        if (was_alive == has_ended) options_.say(robot.name + (has_ended ? ": ended" : ": there"));
        if (heard_.size() < kMostHeard || known != heard_.end())
          heard_[agent] = {robot, !has_ended, Clock::now()};
      } catch (const Error&) {
        ++undecoded_;
      }
    }
  }

  void share() {
    const auto began = Clock::now();
    const fleet::Placements placements{options_.given, book_.origin(!options_.given.empty())};
    fleet::SharedMap shared = fleet::share(book_.maps(), placements, book_.ids(), config_);
    book_.set_ids(shared.ids);
    report(shared);
    shared_ = std::move(shared);
    has_changed_ = false;
    is_unwritten_ = true;
    next_share_ =
        Clock::now() + std::max<Clock::duration>(kInterval, kRestAfterSharing * (Clock::now() - began));
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
      if (!robot.map_from_robot) continue;
      const Point3 at = robot.map_from_robot->translation_m;
      const auto turn = quaternion(*robot.map_from_robot);
      message.transforms.push_back({{wall_clock(), "map"},
                                    robot.robot.name + "/map",
                                    {{at.x, at.y, at.z}, {turn[0], turn[1], turn[2], turn[3]}}});
    }
    if (!message.transforms.empty() && transforms_.has_reader()) transforms_.write(message);
  }

  void write() {
    file_.keep(book_.changes(), shared_.map);
    written_ = Clock::now();
    is_unwritten_ = false;
  }

  void say(const std::string& last_words) {
    said_ = Clock::now();
    voice_.row.landmarks = static_cast<std::int32_t>(shared_.map.list.size());
    voice_.row.robots.clear();
    ros::DiagnosticStatus status;
    status.name = "cairn: map";
    std::size_t lost = 0;
    int ignored_of_all = undecoded_;
    for (const fleet::PlacedRobot& robot : shared_.robots) {
      fleet::KnownRobotRow& row = voice_.row.robots.emplace_back();
      row.name = robot.robot.name;
      row.map_id = robot.robot.map_id;
      row.landmarks = static_cast<std::int32_t>(robot.landmarks);
      row.is_located = robot.map_from_robot.has_value();
      if (row.is_located) {
        const Point3 at = robot.map_from_robot->translation_m;
        row.position = {at.x, at.y, at.z};
        row.yaw = yaw_of(*robot.map_from_robot);
      } else {
        row.refusal = choice_name(robot.refusal, kRecognitionRefusals);
        ++lost;
      }
      row.pairs = static_cast<std::int32_t>(robot.pairs);
      for (const auto& [agent, heard] : heard_) {
        if (heard.robot != robot.robot) continue;
        const double ago = std::chrono::duration<double>(Clock::now() - heard.at).count();
        row.heard_s_ago = row.heard_s_ago < 0 ? ago : std::min(row.heard_s_ago, ago);
      }
      const auto refused = book_.refused().find(robot.robot);
      if (refused != book_.refused().end()) row.ignored = refused->second.rows;
      ignored_of_all += row.ignored;
      status.values.push_back({"robot " + row.name, row.is_located ? "located" : row.refusal});
    }
    status.values.push_back({"landmarks", std::to_string(voice_.row.landmarks)});
    status.message = std::to_string(shared_.robots.size()) + " robots";
    if (ignored_of_all > 0) {
      status.level = ros::DiagnosticStatus::kWarn;
      status.message = std::to_string(ignored_of_all) + " rows ignored";
    } else if (lost > 0) {
      status.level = ros::DiagnosticStatus::kWarn;
      status.message = "the place of " + std::to_string(lost) + " of " +
                       std::to_string(shared_.robots.size()) + " robots is unknown";
    }
    if (!last_words.empty()) status.message = last_words;
    voice_.send(std::move(status));
  }

  static constexpr std::size_t kMostHeard = 4 * fleet::FleetBook::kMostRobots;

  const MapAgentOptions& options_;
  MapFile file_;
  fleet::FleetBook book_;
  LandmarksConfig config_;
  ros::Participant participant_;
  ros::Reader<fleet::LandmarkRow> landmarks_;
  ros::Reader<fleet::FloorRow> floor_;
  ros::Reader<fleet::IndexRow> index_;
  ros::Reader<fleet::AgentRow> agents_;
  ros::Writer<ros::Detection3DArray> map_;
  ros::Writer<ros::TFMessage> transforms_;
  AgentVoice voice_;
  ros::ReaderWait wait_;
  std::map<fleet::MapId, Heard> heard_;  // by process
  std::map<fleet::RobotKey, int> refusals_told_;
  int undecoded_ = 0;
  fleet::SharedMap shared_;
  bool has_changed_ = false;
  bool is_unwritten_ = false;
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
