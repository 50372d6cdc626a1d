// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <CLI/CLI.hpp>
#include <cairn/core/error.hpp>
#include <iostream>
#include <memory>

#include "app.hpp"

namespace cairn::cli {

Work declare_help(CLI::App& app) {
  auto name = std::make_shared<std::string>();
  app.add_option("COMMAND", *name, "command to describe; default: list of all commands")->type_name("");
  return [name] {
    // A fresh one: CLI11 would print the help of a chosen subcommand.
    const CommandLine line = declare_command_line(declare_any);
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
