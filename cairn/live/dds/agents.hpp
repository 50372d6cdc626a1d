// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <memory>
#include <string>

#include <cairn/fleet/messages.hpp>
#include <cairn/live/agents.hpp>
#include <cairn/ros/dds/participant.hpp>

namespace cairn::live {

/// Like share_map(), run_map_agent() and watch_fleet().
std::unique_ptr<Sink> share_sink(const ShareOptions& options);
void map_agent(const MapAgentOptions& options);
std::unique_ptr<FleetWatch> fleet_watch(const FleetDomain& domain);

/// The topics of agents, and how they are sent.
namespace fleet_topics {

inline constexpr const char* kLandmarks = "/cairn/landmarks";
inline constexpr const char* kFloor = "/cairn/floor";
inline constexpr const char* kIndex = "/cairn/index";
inline constexpr const char* kAgents = "/cairn/agents";
inline constexpr const char* kEvents = "/cairn/events";
inline constexpr const char* kMapLandmarks = "/cairn/map/landmarks";

/// Readers that come later get the last row of each key.
inline constexpr ros::WriterQos kRows{.latched = true, .depth = 1};
inline constexpr ros::ReaderQos kReadRows{.reliable = true, .depth = 1, .latched = true};
inline constexpr ros::WriterQos kLastEvents{.latched = true, .depth = 100};
/// After which an agent that says nothing counts as not alive. On a loaded computer, a process may sleep for a quarter
/// of it.
inline constexpr std::chrono::nanoseconds kLease = std::chrono::seconds(1);
/// Not latched: the last row of one that hangs would say that it is well.
inline constexpr ros::WriterQos kAgentRow{.depth = 1, .lease = kLease};
inline constexpr ros::ReaderQos kReadAgents{.reliable = true, .depth = 1};

}  // namespace fleet_topics

ros::Participant fleet_participant(const FleetDomain& domain);

/// Now, by the clock of this computer.
ros::Time wall_clock();

/// The key of a row of an agent. Throws Error if there is none.
fleet::MapId agent_of(const ros::Bytes& row);

/// The row of an agent, which says once a second how it is, also as /diagnostics for people.
class AgentVoice {
 public:
  AgentVoice(const ros::Participant& participant, const std::string& role, const std::string& name,
             const fleet::MapId& map_id);
  /// From any thread, often: the work goes on.
  void assert_alive() const { writer_.assert_alive(); }
  /// What it says, but for its level and message.
  fleet::AgentRow row;
  /// Sends the row and the status with the present time.
  void send(ros::DiagnosticStatus status);
  /// The last word: the agent ends in good order. Waits until others have it, for a second at most.
  void end(ros::DiagnosticStatus status);

 private:
  ros::Writer<fleet::AgentRow> writer_;
  ros::Writer<ros::DiagnosticArray> diagnostics_;
};

}  // namespace cairn::live
