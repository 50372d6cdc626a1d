// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <memory>
#include <string>
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

/// "Examples:" and a line for each; what a command's own --help says comes behind it.
std::string examples_text(const Command& command);

/// The sentence for a command that does not exist; empty where there is one of this name.
std::string unknown_command(const std::string& name);

}  // namespace cairn::cli
