// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <CLI/CLI.hpp>
#include <cairn/io/config_files.hpp>
#include <iostream>

#include "commands.hpp"
#include "common.hpp"

namespace cairn::cli {
namespace {

struct ShowOptions {
  ConfigOptions config;
  bool markdown = false;
  bool changed = false;
  bool sequence = false;
};

std::string escaped(std::string_view cell) {
  std::string text;
  for (const char c : cell) text += c == '|' ? std::string("\\|") : std::string(1, c);
  return text;
}

std::string markdown(const std::vector<OptionInfo>& options) {
  std::string all =
      "| option | default | unit | values | meaning | read while |\n|---|---|---|---|---|---|\n";
  for (const OptionInfo& o : options) {
    all += "| `" + o.name + "` | " + (o.value.empty() ? "" : "`" + escaped(o.value) + "`") + " | " +
           escaped(o.unit) + " | " + escaped(o.domain) + " | " + escaped(o.help) + " |" +
           (o.needs.empty() ? "" : " `" + o.needs + "`") + " |\n";
  }
  return all;
}

}  // namespace

Work declare_config(CLI::App& app) {
  auto show = std::make_shared<ShowOptions>();
  add_config_options(app, show->config);
  app.add_flag("--markdown", show->markdown,
               "table of all options, including those without effect, instead of YAML");
  app.add_flag("--changed", show->changed, "only the preset and the options that differ from it")
      ->excludes("--markdown");
  app.add_flag("--sequence", show->sequence, "only the options that `cairn follow` adds for sequences")
      ->excludes("--changed");
  return [show] {
    if (show->sequence) {
      const std::vector<OptionInfo> all = sequence_options(show->config);
      std::cout << (show->markdown ? markdown(all) : io::options_yaml(all));
      return 0;
    }
    const ResolvedConfig resolved = resolve(show->config);
    if (show->changed) {
      std::cout << io::changed_config_yaml(resolved.preset, resolved.config);
    } else {
      std::cout << (show->markdown ? markdown(options(resolved.config)) : io::config_yaml(resolved.config));
    }
    return 0;
  };
}

}  // namespace cairn::cli
