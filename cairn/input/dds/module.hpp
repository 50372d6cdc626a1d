// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <string>

#include <cairn/input/sequence.hpp>
#include <cairn/io/load_module.hpp>

/// The interface between the libraries and the module for ROS 2 topics. All belong to one build.
namespace cairn::input {

/// `entry`: the function wanted from the module.
constexpr io::ModuleNames dds_module(const char* entry) {
  return {"cairn-dds.so", entry, "topics of ROS 2 need", "Cyclone DDS (libddsc0debian)",
          "package cairn-ros2; it is built where cyclonedds-dev is"};
}

struct Ros2Request {
  std::string source;
  SourceOptions options;
  Pool pool;
};
inline constexpr const char* kRos2Entry = "cairn_open_ros2";
/// The function of that name: the caller owns the result. Throws Error.
using Ros2Entry = Sequence* (*)(const Ros2Request&);

}  // namespace cairn::input
