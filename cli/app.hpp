// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "commands.hpp"

namespace cairn::cli {

/// The whole command line: every command with its options, and what each does.
struct CommandLine {
  std::unique_ptr<CLI::App> app;
  std::vector<std::pair<CLI::App*, Work>> commands;
};
CommandLine declare_command_line();

}  // namespace cairn::cli
