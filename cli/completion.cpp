// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cairn/core/target.hpp>
#include <cairn/pipeline/config.hpp>
#include <cairn/tuning/tunable.hpp>
#include <iostream>
#include <string_view>

#include "app.hpp"

namespace cairn::cli {
namespace {

std::string joined(const std::vector<std::string>& words) {
  std::string all;
  for (const std::string& word : words) all += (all.empty() ? "" : " ") + word;
  return all;
}

/// Splits "a|b" or "a,b" into words.
std::string apart(std::string words, char separator) {
  std::replace(words.begin(), words.end(), separator, ' ');
  return words;
}

std::string shell_word(std::string_view text) {
  std::string all = "'";
  for (const char c : text) all += c == '\'' ? std::string(R"('\'')") : std::string(1, c);
  return all + "'";
}

std::string target_names() {
  std::string names = "best";
  for (const Target target : compiled_targets()) names += " " + std::string(name(target));
  return names;
}

std::string tunable_names() {
  std::vector<std::string> names;
  for (const Tunable& tunable : tunables()) {
    const std::string section = tunable.name.substr(0, tunable.name.find('.')) + ".*";
    if (std::find(names.begin(), names.end(), section) == names.end()) names.push_back(section);
    names.push_back(tunable.name);
  }
  return joined(names);
}

std::string command_names() {
  std::string names;
  for (const Command& command : kCommands) names += (names.empty() ? "" : " ") + std::string(command.name);
  return names;
}

std::vector<std::string> names_of(const CLI::Option& option) {
  std::vector<std::string> names;
  for (const std::string& name : option.get_snames()) names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) names.push_back("--" + name);
  return names;
}

/// The shell words that complete an option's value or a positional; empty for a flag.
std::string expected_by(const CLI::Option& option) {
  const bool positional = option.get_positional();
  if (!positional && option.get_items_expected_max() == 0) return {};
  // These words come from the library; --help describes them.
  if (option.check_lname("preset")) return joined(preset_names());
  if (option.check_lname("target")) return target_names();
  if (option.check_lname("options")) return tunable_names();
  if (positional && option.get_name(true) == "COMMAND") return command_names();
  const std::string type = option.get_type_name();
  // CLI::IsMember describes itself as "{a,b}".
  if (const std::size_t open = type.find('{'); open != std::string::npos && type.ends_with('}'))
    return apart(type.substr(open + 1, type.size() - open - 2), ',');
  const std::string value = type.substr(0, type.find(':'));
  if (value == "NAME=VALUE") return "@assignment";
  if (value == "DIR") return "@folder";
  // Positionals are images and folders in every command.
  return positional || value == "FILE" || value == "PATH" ? "@file" : "@text";
}

constexpr const char* kBashFunction = R"TEXT(
_cairn() {
  local cur=${COMP_WORDS[COMP_CWORD]} at=$((COMP_CWORD - 1)) command=${COMP_WORDS[1]} expected=
  # Readline parts words at '='.
  if [[ $cur == = ]]; then
    cur=
  elif [[ ${COMP_WORDS[at]} == = ]]; then
    at=$((at - 1))
  fi
  local key=${COMP_WORDS[at]}

  COMPREPLY=()
  if ((COMP_CWORD == 1)); then
    expected="$(_cairn_commands) $(_cairn_options '')"
  elif [[ $key == -* ]]; then
    expected=$(_cairn_expected "$command $key")
  elif ((at < COMP_CWORD - 1)) || [[ ${COMP_WORDS[COMP_CWORD]} == = ]]; then
    expected=$(_cairn_values "$key")
    expected=${expected:-@text}
  fi
  if [[ -z $expected && $cur == -* ]]; then
    expected=$(_cairn_options "$command")
  fi
  expected=${expected:-$(_cairn_positionals "$command")}

  case $expected in
    @file) compopt -o filenames 2>/dev/null; mapfile -t COMPREPLY < <(compgen -f -- "$cur") ;;
    @folder) compopt -o filenames 2>/dev/null; mapfile -t COMPREPLY < <(compgen -d -- "$cur") ;;
    @assignment) compopt -o nospace 2>/dev/null; mapfile -t COMPREPLY < <(compgen -W "$(_cairn_names)" -- "$cur") ;;
    @text) ;;
    *) mapfile -t COMPREPLY < <(compgen -W "$expected" -- "$cur") ;;
  esac
}
complete -F _cairn cairn
)TEXT";

/// A shell function that prints the words of each case.
std::string function(const char* name, const std::string& cases) {
  return std::string(name) + "() {\n  case $1 in\n" + cases + "  esac\n}\n";
}

std::string one_case(const std::string& key, const std::string& words) {
  return words.empty() ? "" : "    " + shell_word(key) + ") echo " + shell_word(words) + " ;;\n";
}

std::string bash_completion(const CLI::App& cairn) {
  std::string options_of;
  std::string positional_of;
  std::string expected;
  std::vector<const CLI::App*> apps = cairn.get_subcommands([](const CLI::App*) { return true; });
  apps.insert(apps.begin(), &cairn);
  for (const CLI::App* app : apps) {
    const std::string command = app == &cairn ? "" : app->get_name();
    std::vector<std::string> names;
    std::string positional;
    for (const CLI::Option* option : app->get_options()) {
      if (option->get_positional() && positional.empty()) positional = expected_by(*option);
      for (const std::string& name : names_of(*option)) {
        names.push_back(name);
        expected += one_case(std::string(command).append(" ").append(name), expected_by(*option));
      }
    }
    options_of += one_case(command, joined(names));
    positional_of += one_case(command, positional);
  }
  std::string assignable;
  std::string values;
  for (const OptionInfo& option : options(Config{})) {
    assignable += (assignable.empty() ? "" : " ") + option.name + "=";
    if (option.type == "bool") values += one_case(option.name, "false true");
    if (option.type == "choice") values += one_case(option.name, apart(option.domain, '|'));
  }
  return "# bash completion of cairn, written from what the command declares.\n"
         "_cairn_commands() { echo " +
         shell_word(command_names()) + "; }\n_cairn_names() { echo " + shell_word(assignable) + "; }\n" +
         function("_cairn_options", options_of) + function("_cairn_positionals", positional_of) +
         function("_cairn_expected", expected) + function("_cairn_values", values) + kBashFunction;
}

}  // namespace
}  // namespace cairn::cli

/// Prints the completion for bash.
int main() {
  std::cout << cairn::cli::bash_completion(*cairn::cli::declare_command_line(cairn::cli::declare_any).app);
  return std::cout.flush() ? 0 : 1;
}
