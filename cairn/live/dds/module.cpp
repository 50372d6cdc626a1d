// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/live/dds/module.hpp>

#include <cairn/input/dds/ros2_sensors.hpp>
#include <cairn/input/dds/ros2_sequence.hpp>
#include <cairn/live/dds/agents.hpp>
#include <cairn/live/dds/ros2_sink.hpp>

cairn::input::Sequence* cairn_open_ros2(const cairn::input::Ros2Request& request) {
  return cairn::input::ros2_sequence(request.source, request.options, request.pool).release();
}

cairn::input::LiveSensors* cairn_open_sensor_topics(const cairn::input::SensorTopicNames& names,
                                                    const std::string& camera) {
  return cairn::input::ros2_sensors(names, camera).release();
}

cairn::live::Sink* cairn_publish_ros2(const cairn::live::Ros2Options& options,
                                      const std::optional<cairn::StereoRig>& rig) {
  return cairn::live::ros2_sink(options, rig).release();
}

cairn::live::Sink* cairn_share_map(const cairn::live::ShareOptions& options) {
  return cairn::live::share_sink(options).release();
}

void cairn_run_map_agent(const cairn::live::MapAgentOptions& options) {
  cairn::live::map_agent(options);
}

cairn::live::FleetWatch* cairn_watch_fleet(const cairn::live::FleetDomain& domain) {
  return cairn::live::fleet_watch(domain).release();
}
