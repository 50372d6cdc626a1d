// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/input/open_parts.hpp>
#include <cairn/live/agents.hpp>
#include <cairn/live/ros2.hpp>

/// The entries of the part for ROS 2 topics and agents; the caller owns the results.
extern "C" {
CAIRN_EXPORT cairn::live::Sink* cairn_publish_ros2(const cairn::live::Ros2Options& options,
                                                   const std::optional<cairn::StereoRig>& rig);
CAIRN_EXPORT cairn::live::Sink* cairn_share_map(const cairn::live::ShareOptions& options);
CAIRN_EXPORT void cairn_run_map_agent(const cairn::live::MapAgentOptions& options);
CAIRN_EXPORT cairn::live::FleetWatch* cairn_watch_fleet(const cairn::live::FleetDomain& domain);
}
