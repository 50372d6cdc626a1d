// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <CLI/CLI.hpp>
#include <cairn/core/error.hpp>
#include <cairn/fleet/rows.hpp>
#include <cairn/live/agents.hpp>
#include <cairn/live/service_notice.hpp>
#include <cairn/output/json.hpp>
#include <chrono>
#include <cmath>
#include <iostream>
#include <numbers>

#include "commands.hpp"
#include "follow_options.hpp"
#include "interrupt.hpp"
#include "live_share.hpp"
#include "terminal.hpp"

namespace cairn::cli {
namespace {

using output::Json;

struct AgentOptions {
  std::string action;
  std::string file;
  std::vector<std::string> places;  // --at: NAME=x,y,deg
  std::string forgotten;
  FleetInput fleet;
  bool json_lines = false;
  bool once = false;
  double wait_s = 2;
  bool has_wait = false;
  double duration_s = 0;
  std::vector<std::string> expected;
};

using Deadline = std::optional<live::Clock::time_point>;

Deadline deadline_of(double duration_s) {
  if (!(duration_s >= 0 && duration_s <= 1e9)) {
    throw Error("--duration: found " + text_of("%g", duration_s) +
                ", expected s, 0 ... 1e9 (0: until Ctrl-C)");
  }
  if (duration_s == 0) return std::nullopt;
  return live::Clock::now() +
         std::chrono::duration_cast<live::Clock::duration>(std::chrono::duration<double>(duration_s));
}

bool is_over(const Deadline& deadline) {
  return is_interrupted() || (deadline && live::Clock::now() >= *deadline);
}

int keep_map(const AgentOptions& options) {
  if (options.file.empty()) throw Error("agent map: found no file, expected FILE.db");
  if (!options.forgotten.empty()) {
    if (!options.places.empty()) throw Error("--at: found --forget as well, after which nothing is gathered");
    if (options.duration_s != 0)
      throw Error("--duration: found --forget as well, after which nothing is gathered");
    if (!live::forget_robot(options.file, options.forgotten))
      throw Error("--forget " + options.forgotten + ": " + options.file + " has no such robot");
    std::cout << options.file << ": robot " << options.forgotten << " forgotten\n";
    return 0;
  }
  live::MapAgentOptions how;
  how.file = options.file;
  how.domain = domain_of(options.fleet);
  for (const std::string& text : options.places) {
    const auto [name, pose] = named_pose(text);
    if (!how.given.emplace(fleet::checked_robot(name, "--at"), pose).second)
      throw Error("--at " + text + ": the second pose of this robot, expected one");
  }
  live::ServiceNotice notice;
  const Deadline deadline = deadline_of(options.duration_s);
  how.is_ended = [&] {
    notice.ready();
    notice.note_alive();
    return is_over(deadline);
  };
  how.say = [&](const std::string& line) {
    std::cerr << on_one_line(line) << "\n";
    notice.status(line);
  };
  catch_interrupts();
  live::run_map_agent(how);
  notice.finish();
  return 0;
}

// ---- watch ----

constexpr std::array kLevels{"ok", "warning", "error"};

std::string state_of(const live::AgentState& agent) {
  if (!agent.is_alive) return agent.has_ended ? "ended" : "SILENT";
  return kLevels.at(static_cast<std::size_t>(std::clamp(agent.level, 0, 2)));
}

Json json_of(const live::FleetState& state) {
  Json agents = Json::array();
  for (const live::AgentState& agent : state.agents) {
    Json& j = agents.emplace_back(Json{{"role", agent.role},
                                       {"name", agent.name},
                                       {"host", agent.host},
                                       {"process", agent.process},
                                       {"state", state_of(agent)},
                                       {"silent_s", agent.silent_s},
                                       {"message", agent.message},
                                       {"landmarks", agent.landmarks}});
    if (agent.role != "perception") continue;
    j["rate_hz"] = agent.rate_hz;
    j["reliability"] = agent.reliability < 0 ? Json() : Json(agent.reliability);
    j["weakest"] = agent.weakest;
    j["frames"] = agent.frames;
    j["objects"] = agent.objects;
    j["tracks"] = agent.tracks;
  }
  Json robots = Json::array();
  for (const live::RobotState& robot : state.robots) {
    Json& j = robots.emplace_back(Json{{"name", robot.name},
                                       {"landmarks", robot.landmarks},
                                       {"located", robot.map_from_robot.has_value()},
                                       {"common", robot.pairs},
                                       {"ignored", robot.ignored}});
    j["heard_s_ago"] = robot.heard_s_ago < 0 ? Json() : Json(robot.heard_s_ago);
    if (robot.map_from_robot) {
      const Pose& pose = *robot.map_from_robot;
      j["x_m"] = pose.translation_m.x;
      j["y_m"] = pose.translation_m.y;
      j["yaw_deg"] = yaw_of(pose) * 180 / std::numbers::pi;
    }
    if (!robot.refusal.empty()) j["refusal"] = robot.refusal;
  }
  return {{"agents", std::move(agents)}, {"robots", std::move(robots)}, {"warnings", state.warnings}};
}

std::string table_of(const live::FleetState& state) {
  Table agents({"agent", "name", "host", "process", "state", "silent s", "Hz", "reliability", "objects",
                "tracks", "landmarks", "message"});
  for (const live::AgentState& agent : state.agents) {
    const bool sees = agent.role == "perception";
    agents.add({agent.role, agent.name, agent.host, std::to_string(agent.process), state_of(agent),
                text_of("%.1f", agent.silent_s), sees ? text_of("%.1f", agent.rate_hz) : "",
                sees && agent.reliability >= 0 ? text_of("%.2f", agent.reliability) : "",
                sees ? std::to_string(agent.objects) : "", sees ? std::to_string(agent.tracks) : "",
                std::to_string(agent.landmarks), agent.message});
  }
  std::string text = state.agents.empty() ? "no agents\n" : agents.text();
  if (!state.robots.empty()) {
    Table robots(
        {"robot in the map", "landmarks", "common", "x m", "y m", "degrees", "heard s ago", "why unknown"});
    for (const live::RobotState& robot : state.robots) {
      const auto& pose = robot.map_from_robot;
      robots.add({robot.name, std::to_string(robot.landmarks), std::to_string(robot.pairs),
                  pose ? text_of("%.2f", pose->translation_m.x) : "",
                  pose ? text_of("%.2f", pose->translation_m.y) : "",
                  pose ? text_of("%.1f", yaw_of(*pose) * 180 / std::numbers::pi) : "",
                  robot.heard_s_ago < 0 ? "never" : text_of("%.0f", robot.heard_s_ago), robot.refusal});
    }
    text += "\n" + robots.text();
  }
  for (const std::string& warning : state.warnings) text += "\n" + warning + "\n";
  return text;
}

/// Those of `expected` that are not there, or in trouble.
std::vector<std::string> missing_of(const live::FleetState& state, const std::vector<std::string>& expected) {
  std::vector<std::string> missing;
  for (const std::string& name : expected) {
    const bool is_there = std::ranges::any_of(state.agents, [&](const live::AgentState& agent) {
      return agent.name == name && agent.is_alive && agent.level < 2;
    });
    if (!is_there) missing.push_back(name);
  }
  for (const live::AgentState& agent : state.agents) {
    const bool is_expected = std::ranges::find(expected, agent.name) != expected.end();
    const bool is_well = agent.is_alive ? agent.level < 2 : agent.has_ended;
    if (!is_expected && !is_well) missing.push_back(agent.name);
  }
  return missing;
}

int watch(const AgentOptions& options) {
  if (!(options.wait_s >= 0 && options.wait_s <= 3600))
    throw Error("--wait: found " + text_of("%g", options.wait_s) + ", expected s, 0 ... 3600");
  if (!options.once && !options.expected.empty()) throw Error("--expect: needs --once");
  if (!options.once && options.has_wait) throw Error("--wait: needs --once");
  if (options.once && options.duration_s != 0)
    throw Error("--duration: found --once as well, which ends by itself");
  const Deadline deadline = deadline_of(options.once ? options.wait_s : options.duration_s);
  const auto fleet = live::watch_fleet(domain_of(options.fleet));
  catch_interrupts();
  using namespace std::chrono_literals;
  live::FleetState state;
  live::Clock::time_point shown;
  std::vector<std::string> shown_states;
  const auto show = [&] {
    if (options.json_lines) {
      Json line = json_of(state);
      line["time_s"] =
          std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
      std::cout << output::json_text(line) << std::endl;
    } else {
      std::cout << table_of(state) << std::flush;
    }
  };
  while (!is_over(deadline) && std::cout) {
    state = fleet->next(100ms);
    if (options.once && !options.expected.empty() && missing_of(state, options.expected).empty()) break;
    std::vector<std::string> states;
    for (const live::AgentState& agent : state.agents)
      states.push_back(agent.name + " " + std::to_string(agent.process) + " " + state_of(agent));
    if (options.once || (states == shown_states && live::Clock::now() - shown < 1s)) continue;
    if (!options.json_lines && shown != live::Clock::time_point()) std::cout << "\n";
    shown = live::Clock::now();
    shown_states = std::move(states);
    show();
  }
  if (!options.once) return 0;
  show();
  const std::vector<std::string> missing = missing_of(state, options.expected);
  for (const std::string& name : missing) std::cerr << "cairn: " << name << ": missing or in trouble\n";
  return missing.empty() ? 0 : 3;
}

}  // namespace

Work declare_agent(CLI::App& app) {
  auto options = std::make_shared<AgentOptions>();
  app.add_option("ACTION", options->action,
                 "map: gather the landmarks of all robots in one map; watch: show which agents there are")
      ->required()
      ->check(CLI::IsMember({"map", "watch"}).name(""))
      ->type_name("");
  app.add_option("FILE", options->file, "map: file of the shared map, created if absent")->type_name("");
  app.add_option(
         "--at", options->places,
         "map: pose of a robot's map in the shared one: m and degrees counter-clockwise; may be repeated "
         "(default: by common landmarks)")
      ->type_name("NAME=X,Y,DEG")
      ->allow_extra_args(false);
  app.add_option("--forget", options->forgotten, "map: remove a robot from FILE, and end")->type_name("NAME");
  add_fleet_options(app, options->fleet);
  app.add_flag("--json-lines", options->json_lines,
               "watch: one line of JSON per second, and whenever the state of an agent changes");
  app.add_flag(
      "--once", options->once,
      "watch: one table after --wait, or as soon as all of --expect are there; exit code 3 if one is missing "
      "or in trouble");
  app.add_option("--expect", options->expected, "watch: names that must be there; may be repeated")
      ->type_name("NAME")
      ->allow_extra_args(false);
  app.add_option("--wait", options->wait_s, "watch: how long --once waits")
      ->type_name("S")
      ->capture_default_str();
  app.add_option("--duration", options->duration_s, "duration; 0: until Ctrl-C")
      ->type_name("S")
      ->capture_default_str();
  return [options, &app] {
    const bool is_map = options->action == "map";
    options->has_wait = app.count("--wait") > 0;
    for (const char* const option : {"--json-lines", "--once", "--expect", "--wait"}) {
      if (is_map && app.count(option) > 0)
        throw Error(std::string(option) + ": is for agent watch, not for agent map");
    }
    for (const char* const option : {"--at", "--forget", "FILE"}) {
      if (!is_map && app.count(option) > 0)
        throw Error(std::string(option) + ": is for agent map, not for agent watch");
    }
    return is_map ? keep_map(*options) : watch(*options);
  };
}

}  // namespace cairn::cli
