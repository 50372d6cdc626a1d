// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "commands.hpp"

namespace cairn::cli {

/// The command line: all commands, those that `declare` knows with their options and actions.
struct CommandLine {
  std::unique_ptr<CLI::App> app;
  std::vector<std::pair<CLI::App*, Work>> commands;
};
CommandLine declare_command_line(Declare declare);

/// Parses and runs the command line. Errors become one line on stderr. Returns the exit code.
int run(int argc, const char* const* argv, Declare declare);
/// The same for memory that runs out where no exception can be caught.
void end_in_one_line_without_memory();

/// The entry of the module with the commands that main.cpp does not contain.
inline constexpr const char* kCommandsEntry = "cairn_run_command";
using CommandsEntry = int (*)(int argc, const char* const* argv);

/// "Examples:" with one line each, followed by the command's own notes in --help.
std::string examples_text(const Command& command);

/// The message for an unknown command; empty if it exists.
std::string unknown_command(const std::string& name);

}  // namespace cairn::cli
