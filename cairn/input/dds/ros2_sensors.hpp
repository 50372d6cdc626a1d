// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <memory>
#include <string>

#include <cairn/input/sensor_topics.hpp>

namespace cairn::input {

/// Subscribes to these topics and /tf_static. `camera`: the frame_id of the left images. Throws Error for names that ROS
/// does not allow.
std::unique_ptr<LiveSensors> ros2_sensors(const SensorTopicNames& names, const std::string& camera);

}  // namespace cairn::input
