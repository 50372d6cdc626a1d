// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/live/agents.hpp>
#include <cstdint>
#include <memory>
#include <string>

#include "follow_options.hpp"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace cairn::live {
class Runner;
}

namespace cairn::cli {

/// --fleet-domain and --fleet-interface.
struct FleetInput {
  std::uint32_t id = live::FleetDomain{}.id;
  std::string interface;
};
void add_fleet_options(CLI::App& app, FleetInput& input);
live::FleetDomain domain_of(const FleetInput& input);

/// --share and the options of its domain.
struct ShareInput {
  std::string robot;  // empty: not shared
  FleetInput fleet;
  const CLI::Option* domain = nullptr;
};
void add_share_options(CLI::App& app, ShareInput& input);
/// Shares from now on; null without --share. Throws Error.
std::unique_ptr<live::Sink> make_share_sink(const ShareInput& input, const SensorInput& sensors,
                                            const live::Runner& runner, const input::Sequence& source);

}  // namespace cairn::cli
