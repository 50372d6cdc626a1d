// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/input/dds/module.hpp>
#include <cairn/input/open_ros2.hpp>

/// Loads DDS only if a topic is opened.
namespace cairn::input {

std::unique_ptr<Sequence> open_ros2(const std::string& source, const SourceOptions& options,
                                    const Pool& pool) {
  const auto entry = reinterpret_cast<Ros2Entry>(io::module_entry(dds_module(kRos2Entry), source));
  return std::unique_ptr<Sequence>(entry({source, options, pool}));
}

}  // namespace cairn::input
