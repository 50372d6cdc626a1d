// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <unistd.h>

#include <algorithm>
#include <cairn/core/error.hpp>
#include <cairn/fleet/rows.hpp>
#include <cairn/io/names_and_numbers.hpp>
#include <chrono>
#include <random>

#include <cairn/live/dds/agents.hpp>

namespace cairn::live {
namespace {

fleet::MapId random_id() {
  std::random_device device;
  fleet::MapId id{};
  for (std::uint8_t& byte : id) byte = static_cast<std::uint8_t>(device());
  return id;
}

}  // namespace

ros::Participant fleet_participant(const FleetDomain& domain) {
  return ros::Participant(ros::domain_of_fleet(domain.id, domain.interface));
}

AgentVoice::AgentVoice(const ros::Participant& participant, const std::string& role, const std::string& name,
                       const fleet::MapId& map_id)
    : writer_(participant, fleet_topics::kAgents, fleet_topics::kAgentRow),
      diagnostics_(participant, "/diagnostics") {
  row.agent = random_id();
  row.role = role;
  row.name = name;
  row.host = io::host_name();
  row.process = ::getpid();
  row.map_id = map_id;
}

ros::Time wall_clock() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return ros::time_of({std::chrono::duration_cast<std::chrono::nanoseconds>(now).count()});
}

fleet::MapId agent_of(const ros::Bytes& row) {
  constexpr std::size_t kHeader = 4;
  fleet::MapId agent{};
  if (row.size() < kHeader + agent.size()) throw Error("a row of an agent without its key");
  std::copy_n(row.begin() + kHeader, agent.size(), agent.begin());
  return agent;
}

void AgentVoice::end(ros::DiagnosticStatus status) {
  constexpr auto kPatience = std::chrono::seconds(1);
  row.has_ended = true;
  status.level = ros::DiagnosticStatus::kOk;
  status.message = "ended";
  send(std::move(status));
  if (writer_.has_reader()) writer_.wait_for_readers(kPatience);
}

void AgentVoice::send(ros::DiagnosticStatus status) {
  row.stamp = wall_clock();
  row.level = std::to_integer<std::uint8_t>(status.level);
  row.message = status.message;
  writer_.write(row);
  if (!diagnostics_.has_reader()) return;
  status.hardware_id = row.host;
  diagnostics_.write({{row.stamp, ""}, {std::move(status)}});
}

}  // namespace cairn::live
