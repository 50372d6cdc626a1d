// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/input/dds/ros2_sequence.hpp>
#include <cairn/input/open_ros2.hpp>

/// Linked directly, without a module: sanitizers need one program.
namespace cairn::input {

std::unique_ptr<Sequence> open_ros2(const std::string& source, const SourceOptions& options,
                                    const Pool& pool) {
  return ros2_sequence(source, options, pool);
}

}  // namespace cairn::input
