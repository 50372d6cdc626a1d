// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <string>
#include <vector>

#include "app.hpp"

namespace cairn::cli {

/// The completion that a shell offers for a word.
enum class Expects { nothing, file, folder, one_of, assignment, text };

/// One option or positional, for manual pages and completions.
struct OptionFacts {
  std::vector<std::string> names;  // "-o", "--output"; of a positional "LEFT"
  std::string value;               // "FILE"; empty for a flag and for a positional
  Expects expects = Expects::text;
  std::vector<std::string> words;  // of one_of
  std::string domain;              // "0 - 1024"; may be empty
  std::string standard;            // the default; may be empty
  std::string help;
  bool positional = false;
  bool required = false;

  [[nodiscard]] bool is_flag() const { return !positional && value.empty(); }
};

struct CommandFacts {
  std::string name;  // empty: cairn itself
  std::string help;
  std::string examples;  // shell lines; may be empty
  std::string footer;    // notes of the command; may be empty
  std::vector<OptionFacts> options;
};

/// cairn itself, then each command.
std::vector<CommandFacts> facts_of(const CLI::App& app);

/// The manual pages in section 1 of each command and cairn-options(7), in roff, each with its file name.
struct NamedText {
  std::string name;
  std::string text;
};
std::vector<NamedText> man_pages(const std::vector<CommandFacts>& commands);

std::string bash_completion(const std::vector<CommandFacts>& commands);
std::string zsh_completion(const std::vector<CommandFacts>& commands);
std::string fish_completion(const std::vector<CommandFacts>& commands);

}  // namespace cairn::cli
