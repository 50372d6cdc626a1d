// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "app.hpp"

#include <string>

namespace cairn::cli {

CommandLine declare_command_line() {
  CommandLine line;
  line.app = std::make_unique<CLI::App>(
      "cairn: objects from a rectified stereo pair, with a reason for every pixel that was refused", "cairn");
  line.app->set_version_flag("--version", std::string("cairn ") + CAIRN_VERSION);
  line.app->require_subcommand(0, 1);
  line.app->footer(
      "cairn COMMAND --help tells more of each.\n"
      "Exit codes: 0 done, 1 the work failed, 2 bad usage, file or option (one line on stderr).");
  for (const Command& command : kCommands) {
    CLI::App* sub = line.app->add_subcommand(command.name, command.help);
    line.commands.emplace_back(sub, command.declare(*sub));
  }
  return line;
}

}  // namespace cairn::cli
