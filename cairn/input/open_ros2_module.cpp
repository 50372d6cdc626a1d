// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/input/dds/module.hpp>
#include <cairn/input/open_ros2.hpp>

/// Loads DDS only if a topic is opened.
namespace cairn::io {

std::unique_ptr<Sequence> open_ros2(const std::string& source, const SourceOptions& options,
                                    const Pool& pool) {
  const auto entry = reinterpret_cast<dds::Ros2Entry>(module_entry(dds::dds_module(dds::kRos2Entry), source));
  return std::unique_ptr<Sequence>(entry({source, options, pool}));
}

}  // namespace cairn::io
