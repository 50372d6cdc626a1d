// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "app.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cairn/core/nearest.hpp>
#include <string>
#include <string_view>

namespace cairn::cli {

std::string examples_text(const Command& command) {
  std::string text = "Examples:";
  for (std::string_view rest = command.examples; !rest.empty(); rest.remove_prefix(rest.find('\n') + 1))
    text += "\n  " + std::string(rest.substr(0, rest.find('\n')));
  return text + "\n";
}

std::string unknown_command(const std::string& name) {
  std::vector<std::string> names;
  names.reserve(kCommands.size());
  for (const Command& command : kCommands) names.emplace_back(command.name);
  if (std::find(names.begin(), names.end(), name) != names.end()) return {};
  const std::string close = nearest(name, names);
  return "unknown command '" + name + "'" +
         (close.empty() ? "; cairn --help lists them" : ", did you mean '" + close + "'?");
}

CommandLine declare_command_line(Declare declare) {
  CommandLine line;
  line.app = std::make_unique<CLI::App>(
      "cairn: objects from a rectified stereo pair, with a reason for every rejected pixel", "cairn");
  line.app->set_version_flag("--version", std::string("cairn ") + CAIRN_VERSION);
  line.app->require_subcommand(0, 1);
  line.app->footer(
      "cairn help COMMAND describes each command, with examples.\n"
      "Exit codes: 0 success, 1 the work failed or cairn doctor found a fault, 2 bad usage, file or option (one\n"
      "line on stderr), 3 the source ended early or results are missing, 130 interrupted (except cairn live: 0).");
  for (const Command& command : kCommands) {
    CLI::App* sub = line.app->add_subcommand(command.name, command.help);
    sub->footer("");  // without the parent's footer
    line.commands.emplace_back(sub, declare(command.name, *sub));
    sub->footer(examples_text(command) + (sub->get_footer().empty() ? "" : "\n" + sub->get_footer()));
  }
  return line;
}

}  // namespace cairn::cli
