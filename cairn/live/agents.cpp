// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/live/agents.hpp>

#include <cairn/core/error.hpp>
#include <cairn/fleet/fleet_book.hpp>
#include <cairn/sequence/map_file.hpp>

#include <cairn/live/dds/module.hpp>

namespace cairn::live {

std::unique_ptr<Sink> share_map(const ShareOptions& options) {
  const auto entry = CAIRN_ENTRY(CAIRN_HOW_DDS, cairn_share_map, input::kRos2Part, "--share");
  return std::unique_ptr<Sink>(entry(options));
}

void run_map_agent(const MapAgentOptions& options) {
  const auto entry = CAIRN_ENTRY(CAIRN_HOW_DDS, cairn_run_map_agent, input::kRos2Part, "agent map");
  entry(options);
}

std::unique_ptr<FleetWatch> watch_fleet(const FleetDomain& domain) {
  const auto entry = CAIRN_ENTRY(CAIRN_HOW_DDS, cairn_watch_fleet, input::kRos2Part, "agent watch");
  return std::unique_ptr<FleetWatch>(entry(domain));
}

bool forget_robot(const std::filesystem::path& path, const std::string& robot) {
  if (!std::filesystem::exists(path)) throw Error(path.string() + ": no such file");
  auto [file, book] = fleet::open_fleet_file(path);
  const auto shared_map = [&book = book] {
    return fleet::share(book.maps(), book.placements(), book.ids(), LandmarksConfig{});
  };
  if (book.forget(robot, shared_map().robots) == 0) return false;
  fleet::SharedMap shared = shared_map();
  book.set_ids(std::move(shared.ids));
  file.keep(book.changes(), shared.map);
  return true;
}

}  // namespace cairn::live
