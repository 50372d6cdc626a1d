// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "commands.hpp"

namespace cairn::cli {

/// The command line: all commands with their options and actions.
struct CommandLine {
  std::unique_ptr<CLI::App> app;
  std::vector<std::pair<CLI::App*, Work>> commands;
};
CommandLine declare_command_line();

/// "Examples:" with one line each, followed by the command's own notes in --help.
std::string examples_text(const Command& command);

/// The message for an unknown command; empty if it exists.
std::string unknown_command(const std::string& name);

}  // namespace cairn::cli
