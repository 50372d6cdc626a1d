// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/live/dds/module.hpp>

/// Loads DDS only if something is published.
namespace cairn::live {

std::unique_ptr<Sink> publish_ros2(const Ros2Options& options, const std::optional<StereoRig>& rig) {
  const auto entry =
      reinterpret_cast<Ros2SinkEntry>(io::module_entry(input::dds_module(kRos2SinkEntry), "--ros2"));
  return std::unique_ptr<Sink>(entry(options, rig));
}

}  // namespace cairn::live
