// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "live_share.hpp"

#include <CLI/CLI.hpp>
#include <cairn/core/error.hpp>
#include <cairn/live/runner.hpp>

namespace cairn::cli {

void add_fleet_options(CLI::App& app, FleetInput& input) {
  app.add_option("--fleet-domain", input.id, "DDS domain in which agents meet")
      ->type_name("N")
      ->capture_default_str();
  app.add_option("--fleet-interface", input.interface,
                 "network interface of that domain, such as wlan0 (default: this computer only)")
      ->type_name("NAME");
}

live::FleetDomain domain_of(const FleetInput& input) {
  return {input.id, input.interface};
}

void add_share_options(CLI::App& app, ShareInput& input) {
  app.add_option(
         "--share", input.robot,
         "share landmarks, tracks and pose with other agents (cairn agent) under this name; needs --map")
      ->type_name("ROBOT");
  add_fleet_options(app, input.fleet);
  input.domain = app.get_option("--fleet-domain");
}

std::unique_ptr<live::Sink> make_share_sink(const ShareInput& input, const SensorInput& sensors,
                                            const live::Runner& runner, const input::Sequence& source) {
  if (input.robot.empty()) {
    if (input.domain->count() > 0) throw Error("--fleet-domain: needs --share");
    if (!input.fleet.interface.empty()) throw Error("--fleet-interface: needs --share");
    return nullptr;
  }
  if (sensors.map.empty()) throw Error("--share: needs --map FILE.db, whose landmarks it shares");
  if (sensors.map_read_only) {
    throw Error(
        "--share: found --read-only as well, with which nothing tells this run's landmarks from another's");
  }
  return live::share_map({input.robot, runner.map_id(), source.rig(), domain_of(input.fleet)});
}

}  // namespace cairn::cli
