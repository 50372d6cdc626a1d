// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/live/dds/module.hpp>

namespace cairn::live {

std::unique_ptr<Sink> publish_ros2(const Ros2Options& options, const std::optional<StereoRig>& rig) {
  const auto entry = CAIRN_ENTRY(CAIRN_HOW_DDS, cairn_publish_ros2, input::kRos2Part, "--ros2");
  return std::unique_ptr<Sink>(entry(options, rig));
}

}  // namespace cairn::live
