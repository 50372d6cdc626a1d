// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/live/live_frame.hpp>
#include <memory>
#include <string>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace cairn::cli {

/// --ros2 and its options.
struct Ros2CommandOptions {
  const CLI::Option* is_wanted = nullptr;
  std::string name_space;  // "" if --ros2 has no value
  std::string holes;
  std::string frame;
};
void add_ros2_options(CLI::App& app, Ros2CommandOptions& options);
/// Publishes from now on; null without --ros2. Throws Error.
std::unique_ptr<live::Sink> make_ros2_sink(const Ros2CommandOptions& options, const input::Sequence& source);

}  // namespace cairn::cli
