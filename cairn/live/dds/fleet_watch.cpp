// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/core/error.hpp>
#include <cairn/fleet/rows.hpp>
#include <cmath>
#include <deque>
#include <map>
#include <tuple>

#include <cairn/live/dds/agents.hpp>

namespace cairn::live {
namespace {

using namespace std::chrono_literals;
namespace topics = fleet_topics;

constexpr std::size_t kMostAgents = 256;
/// Two of one name count as a mistake after it: one that is restarted is there before the lease of the other ends.
constexpr auto kTwice = 2 * topics::kLease;
constexpr double kMostClock_s = 0.2;
constexpr std::size_t kDelays = 10;  // words of an agent over which the shortest delay counts

Pose pose_of_robot(const fleet::KnownRobotRow& row) {
  Pose pose = rotation_about({0, 0, row.yaw});
  pose.translation_m = {row.position.x, row.position.y, row.position.z};
  return pose;
}

class Watch : public FleetWatch {
 public:
  explicit Watch(const FleetDomain& domain)
      : participant_(fleet_participant(domain)),
        reader_(participant_, topics::kAgents, topics::kReadAgents),
        wait_(participant_, {&reader_}) {}

  FleetState next(std::chrono::milliseconds timeout) override {
    if (wait_.wait(timeout)) take();
    return state();
  }

 private:
  struct Agent {
    fleet::AgentRow row;
    bool is_alive = true;
    Clock::time_point began;  // of being alive
    Clock::time_point heard;
    std::deque<double> delays_s;  // from its clock to ours
  };

  void take() {
    while (const auto change = reader_.take_change()) {
      try {
        const fleet::MapId id = agent_of(change->bytes);
        if (change->has_message) hear(id, ros::decode<fleet::AgentRow>(change->bytes));
        const auto known = agents_.find(id);
        if (change->is_alive || known == agents_.end()) continue;
        known->second.is_alive = false;
        drop_former(known->second.row);
      } catch (const Error&) {  // of another cairn
      }
    }
  }

  /// An agent that is not alive while another of its name is: the former one of it, which was started again.
  void drop_former(const fleet::AgentRow& row) {
    const auto is_of_it = [&](const auto& one) {
      return one.second.row.role == row.role && one.second.row.name == row.name;
    };
    const bool is_there =
        std::ranges::any_of(agents_, [&](const auto& one) { return is_of_it(one) && one.second.is_alive; });
    if (is_there)
      std::erase_if(agents_, [&](const auto& one) { return is_of_it(one) && !one.second.is_alive; });
  }

  void hear(const fleet::MapId& id, fleet::AgentRow row) {
    if (!fleet::fault_of(row).empty() || (agents_.size() >= kMostAgents && !agents_.contains(id))) return;
    const auto now = Clock::now();
    Agent& agent = agents_[id];
    if (!agent.is_alive || agent.row.role.empty()) agent.began = now;
    agent.delays_s.push_back(seconds_between(ros::stamp_of(row.stamp), ros::stamp_of(wall_clock())));
    if (agent.delays_s.size() > kDelays) agent.delays_s.pop_front();
    agent.is_alive = !row.has_ended;
    agent.heard = now;
    agent.row = std::move(row);
    drop_former(agents_[id].row);
  }

  [[nodiscard]] FleetState state() const {
    const auto now = Clock::now();
    FleetState state;
    const fleet::AgentRow* map = nullptr;
    for (const auto& [id, agent] : agents_) {
      const fleet::AgentRow& row = agent.row;
      AgentState& shown = state.agents.emplace_back();
      shown.role = row.role;
      shown.name = row.name;
      shown.host = row.host;
      shown.process = row.process;
      shown.is_alive = agent.is_alive;
      shown.has_ended = row.has_ended;
      shown.silent_s = std::chrono::duration<double>(now - agent.heard).count();
      shown.level = row.level;
      shown.message = row.message;
      shown.rate_hz = row.rate_hz;
      shown.reliability = row.reliability;
      shown.weakest = row.weakest;
      shown.frames = row.frames;
      shown.objects = row.objects;
      shown.tracks = row.tracks;
      shown.landmarks = row.landmarks;
      const double delay =
          *std::ranges::min_element(agent.delays_s, {}, [](double seconds) { return std::abs(seconds); });
      if (std::abs(delay) > kMostClock_s) {
        shown.clock_s = -delay;
        std::array<char, 96> text{};
        std::snprintf(text.data(), text.size(), ": its clock is %.1f s %s this computer's", std::abs(delay),
                      delay < 0 ? "ahead of" : "behind");
        state.warnings.push_back(row.role + " " + row.name + text.data());
      }
      if (row.role == "map" && agent.is_alive) map = &row;
    }
    std::ranges::sort(state.agents, {}, [](const AgentState& agent) {
      return std::tuple(agent.role, agent.name, agent.process);
    });
    warn_of_twins(state, now);
    if (map == nullptr) return state;
    for (const fleet::KnownRobotRow& row : map->robots) {
      RobotState& robot = state.robots.emplace_back();
      robot.name = row.name;
      robot.landmarks = row.landmarks;
      if (row.is_located) robot.map_from_robot = pose_of_robot(row);
      robot.pairs = row.pairs;
      robot.refusal = row.refusal;
      robot.heard_s_ago = row.heard_s_ago;
      robot.ignored = row.ignored;
      if (row.ignored == 0) continue;
      state.warnings.push_back("robot " + row.name + ": the map agent ignores " +
                               std::to_string(row.ignored) + " rows");
    }
    std::ranges::stable_sort(state.robots, {}, &RobotState::name);
    return state;
  }

  void warn_of_twins(FleetState& state, Clock::time_point now) const {
    std::map<std::pair<std::string, std::string>, int> counts;
    for (const auto& [id, agent] : agents_) {
      if (agent.is_alive && now - agent.began > kTwice) ++counts[{agent.row.role, agent.row.name}];
    }
    for (const auto& [who, count] : counts) {
      if (count < 2) continue;
      state.warnings.push_back(who.first + " " + who.second + ": " + std::to_string(count) +
                               " processes of this name");
    }
  }

  ros::Participant participant_;
  ros::Reader<fleet::AgentRow> reader_;
  ros::ReaderWait wait_;
  std::map<fleet::MapId, Agent> agents_;  // by process
};

}  // namespace

std::unique_ptr<FleetWatch> fleet_watch(const FleetDomain& domain) {
  return std::make_unique<Watch>(domain);
}

}  // namespace cairn::live
