// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/core/error.hpp>
#include <cairn/core/nearest.hpp>
#include <iostream>
#include <memory>

#include "app.hpp"

namespace cairn::cli {

std::string unknown_command(const std::string& name) {
  std::vector<std::string> names;
  names.reserve(kCommands.size());
  for (const Command& command : kCommands) names.emplace_back(command.name);
  if (std::find(names.begin(), names.end(), name) != names.end()) return {};
  const std::string close = nearest(name, names);
  return "unknown command '" + name + "'" +
         (close.empty() ? "; cairn --help lists them" : ", did you mean '" + close + "'?");
}

Work declare_help(CLI::App& app) {
  auto name = std::make_shared<std::string>();
  app.add_option("COMMAND", *name, "command to describe; default: list of all commands")->type_name("");
  return [name] {
    const CommandLine line =
        declare_command_line();  // a fresh one: CLI11 would print the help of a chosen subcommand
    if (name->empty()) {
      std::cout << line.app->help();
      return 0;
    }
    if (const std::string sentence = unknown_command(*name); !sentence.empty()) throw Error(sentence);
    std::cout << line.app->get_subcommand(*name)->help("cairn");
    return 0;
  };
}

}  // namespace cairn::cli
