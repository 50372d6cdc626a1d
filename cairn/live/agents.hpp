// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/fleet/shared_map.hpp>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <cairn/live/live_frame.hpp>

/// Processes that share what they know: robots their landmarks, a map agent the map of all, a watch what is there
/// (docs/agents.md). Through a module with Cyclone DDS (dds/).
namespace cairn::live {

/// Where agents meet. It opens sockets on this computer only, unless an interface is named.
struct FleetDomain {
  std::uint32_t id = 40;  // 0 … 232, of DDS
  std::string interface;  // "wlan0"; empty: this computer only
};

struct ShareOptions {
  std::string robot;   // its name: checked_robot()
  std::string map_id;  // of its map file
  std::optional<StereoRig> rig;
  FleetDomain domain;
};
/// Shares landmarks, free floor, tracks and pose of a run with other agents. Throws Error on failure, also in a build
/// without Cyclone DDS.
std::unique_ptr<Sink> share_map(const ShareOptions& options);

struct MapAgentOptions {
  std::filesystem::path file;         // created if absent
  std::map<std::string, Pose> given;  // known places of robots in the shared map
  FleetDomain domain;
  std::function<bool()> is_ended;
  std::function<void(const std::string&)> say;  // a line about what has changed
};
/// Gathers what robots share until is_ended: keeps their rows and the shared map in the file, and publishes the map.
/// Throws Error.
void run_map_agent(const MapAgentOptions& options);
/// Removes a robot from the file of a map agent that does not run; false if it knows none of this name. Throws Error.
bool forget_robot(const std::filesystem::path& path, const std::string& robot);

/// A robot or a map agent, as seen by a watch.
struct AgentState {
  std::string role;  // "perception" or "map"
  std::string name;
  std::string host;
  int process = 0;
  bool is_alive = true;
  bool has_ended = false;  // in good order
  double silent_s = 0;     // since its last word
  int level = 0;           // as in diagnostics: 0 ok, 1 warning, 2 error
  std::string message;
  double rate_hz = 0;
  double reliability = -1;  // −1: unknown
  std::string weakest;
  std::uint64_t frames = 0;
  int objects = 0;
  int tracks = 0;
  int landmarks = 0;
  double clock_s = 0;  // how far its clock is ahead of ours, at least; 0 within 0.2 s
};
/// A robot in the shared map.
struct RobotState {
  std::string name;
  int landmarks = 0;
  std::optional<Pose> map_from_robot;
  int pairs = 0;
  std::string refusal;
  double heard_s_ago = -1;
  int ignored = 0;
};
struct FleetState {
  std::vector<AgentState> agents;  // by role, name and process
  std::vector<RobotState> robots;  // of the map agent; by name
  std::vector<std::string> warnings;
};
/// Sees which agents there are.
class FleetWatch {
 public:
  FleetWatch() = default;
  virtual ~FleetWatch() = default;
  FleetWatch(const FleetWatch&) = delete;
  FleetWatch& operator=(const FleetWatch&) = delete;
  /// Waits for news up to so long, then says what is there.
  virtual FleetState next(std::chrono::milliseconds timeout) = 0;
};
/// Throws Error.
std::unique_ptr<FleetWatch> watch_fleet(const FleetDomain& domain);

}  // namespace cairn::live
