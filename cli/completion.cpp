// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/pipeline/config.hpp>
#include <string_view>

#include "facts.hpp"

namespace cairn::cli {
namespace {

std::string joined(const std::vector<std::string>& words, std::string_view separator = " ") {
  std::string all;
  for (const std::string& word : words) all += (all.empty() ? "" : std::string(separator)) + word;
  return all;
}

/// As one word of any of the three shells.
std::string shell_word(std::string_view text) {
  std::string all = "'";
  for (const char c : text) {
    if (c == '\'') {
      all += R"('\'')";
    } else {
      all += c;
    }
  }
  return all + "'";
}

std::vector<std::string> words_of(const OptionInfo& option) {
  if (option.type == "bool") return {"false", "true"};
  std::vector<std::string> words;
  if (option.type != "choice") return words;
  for (std::size_t at = 0; at < option.domain.size();) {
    const std::size_t bar = std::min(option.domain.find('|', at), option.domain.size());
    words.push_back(option.domain.substr(at, bar - at));
    at = bar + 1;
  }
  return words;
}

/// "match.window_size=", and "match.method=window" for each word of a choice.
std::vector<std::string> assignments() {
  std::vector<std::string> all;
  for (const OptionInfo& option : options(Config{})) {
    const std::vector<std::string> words = words_of(option);
    if (words.empty()) all.push_back(option.name + "=");
    for (const std::string& word : words) all.push_back(option.name + "=" + word);
  }
  return all;
}

std::vector<std::string> command_names(const std::vector<CommandFacts>& commands) {
  std::vector<std::string> names;
  for (const CommandFacts& command : commands) {
    if (!command.name.empty()) names.push_back(command.name);
  }
  return names;
}

std::vector<std::string> option_names(const CommandFacts& command) {
  std::vector<std::string> names;
  for (const OptionFacts& option : command.options) {
    if (!option.positional) names.insert(names.end(), option.names.begin(), option.names.end());
  }
  return names;
}

/// The first positional; nullptr where there is none.
const OptionFacts* positional_of(const CommandFacts& command) {
  const auto found = std::find_if(command.options.begin(), command.options.end(),
                                  [](const OptionFacts& option) { return option.positional; });
  return found == command.options.end() ? nullptr : &*found;
}

// ---- bash ----

/// What follows an option, in the script's own words.
std::string bash_word(const OptionFacts& option) {
  switch (option.expects) {
    case Expects::nothing:
      return {};
    case Expects::file:
      return "@file";
    case Expects::folder:
      return "@folder";
    case Expects::one_of:
      return joined(option.words);
    case Expects::assignment:
      return "@assignment";
    case Expects::text:
      break;
  }
  return "@text";
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

// ---- zsh ----

/// Text inside the brackets of an _arguments specification.
std::string zsh_text(std::string_view text) {
  std::string all;
  for (const char c : text) {
    if (c == '[' || c == ']' || c == ':' || c == '\\') all += '\\';
    all += c;
  }
  return all;
}

std::string zsh_action(const OptionFacts& option) {
  switch (option.expects) {
    case Expects::nothing:
      return {};
    case Expects::file:
      return "_files";
    case Expects::folder:
      return "_files -/";
    case Expects::one_of:
      return "(" + joined(option.words) + ")";
    case Expects::assignment:
      return "_cairn_assignments";
    case Expects::text:
      break;
  }
  return " ";
}

/// One specification for each name, as _arguments wants it.
std::string zsh_specifications(const OptionFacts& option, int& position) {
  if (option.positional) {
    return " \\\n      " + shell_word(std::to_string(++position) + (option.required ? ":" : "::") +
                                      zsh_text(option.names.front()) + ":" + zsh_action(option));
  }
  std::string all;
  for (const std::string& name : option.names) {
    std::string spec = option.expects == Expects::assignment ? "*" : "(" + joined(option.names) + ")";
    spec += name;
    if (!option.is_flag()) spec += name.starts_with("--") ? "=" : "+";
    spec += "[" + zsh_text(option.help) + "]";
    if (!option.is_flag()) spec += ":" + zsh_text(option.value) + ":" + zsh_action(option);
    all += " \\\n      " + shell_word(spec);
  }
  return all;
}

std::string zsh_arguments(const CommandFacts& command) {
  std::string all;
  int position = 0;
  for (const OptionFacts& option : command.options) all += zsh_specifications(option, position);
  return all;
}

// ---- fish ----

std::string fish_action(const OptionFacts& option) {
  switch (option.expects) {
    case Expects::nothing:
      return {};
    case Expects::file:
      return " -r -F";
    case Expects::folder:
      return " -x -a '(__fish_complete_directories)'";
    case Expects::one_of:
      return " -x -a " + shell_word(joined(option.words));
    case Expects::assignment:
      return " -x -a " + shell_word(joined(assignments()));
    case Expects::text:
      break;
  }
  return " -x";
}

std::string fish_line(const std::string& condition, const OptionFacts& option) {
  std::string names;
  for (const std::string& name : option.names) {
    names += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
  }
  return "complete -c cairn -n " + shell_word(condition) + names + fish_action(option) + " -d " +
         shell_word(option.help) + "\n";
}

}  // namespace

std::string bash_completion(const std::vector<CommandFacts>& commands) {
  std::string names;
  std::string expected;
  std::string positionals;
  for (const CommandFacts& command : commands) {
    names +=
        "    " + shell_word(command.name) + ") echo " + shell_word(joined(option_names(command))) + " ;;\n";
    if (const OptionFacts* first = positional_of(command))
      positionals += "    " + shell_word(command.name) + ") echo " + shell_word(bash_word(*first)) + " ;;\n";
    for (const OptionFacts& option : command.options) {
      const std::string word = bash_word(option);
      if (option.positional || word.empty()) continue;
      for (const std::string& name : option.names) {
        expected += "    " + shell_word(command.name + " " + name) + ") echo " + shell_word(word) + " ;;\n";
      }
    }
  }
  std::string assigned;
  std::vector<std::string> assignable;
  for (const OptionInfo& option : options(Config{})) {
    assignable.push_back(option.name + "=");
    const std::vector<std::string> words = words_of(option);
    if (!words.empty()) assigned += "    " + option.name + ") echo " + shell_word(joined(words)) + " ;;\n";
  }
  const auto function = [](const char* name, const std::string& cases) {
    return std::string(name) + "() {\n  case $1 in\n" + cases + "  esac\n}\n";
  };
  return "# bash completion of cairn, written from what the command declares.\n"
         "_cairn_commands() { echo " +
         shell_word(joined(command_names(commands))) + "; }\n_cairn_names() { echo " +
         shell_word(joined(assignable)) + "; }\n" + function("_cairn_options", names) +
         function("_cairn_positionals", positionals) + function("_cairn_expected", expected) +
         function("_cairn_values", assigned) + kBashFunction;
}

std::string zsh_completion(const std::vector<CommandFacts>& commands) {
  std::string described;
  std::string cases;
  for (const CommandFacts& command : commands) {
    if (command.name.empty()) continue;
    described += "      " + shell_word(command.name + ":" + zsh_text(command.help)) + "\n";
    cases += "    " + command.name + ")\n      _arguments" + zsh_arguments(command) + "\n      ;;\n";
  }
  return "#compdef cairn\n"
         "# zsh completion of cairn, written from what the command declares.\n"
         "_cairn_assignments() {\n  compadd -S '' -- " +
         joined(assignments()) +
         "\n}\n\n_cairn() {\n  local context state state_descr line\n  typeset -A opt_args\n  _arguments -C" +
         zsh_arguments(commands.front()) +
         " \\\n      '1:command:->command' \\\n      '*::argument:->argument'\n"
         "  case $state in\n  command)\n    local -a commands=(\n" +
         described + "    )\n    _describe command commands\n    ;;\n  argument)\n    case $line[1] in\n" +
         cases + "    esac\n    ;;\n  esac\n}\n\n_cairn \"$@\"\n";
}

std::string fish_completion(const std::vector<CommandFacts>& commands) {
  std::string all = "# fish completion of cairn, written from what the command declares.\n";
  for (const CommandFacts& command : commands) {
    const bool top = command.name.empty();
    if (!top) {
      all += "complete -c cairn -n __fish_use_subcommand -f -a " + command.name + " -d " +
             shell_word(command.help) + "\n";
    }
    const std::string condition =
        top ? "__fish_use_subcommand" : "__fish_seen_subcommand_from " + command.name;
    for (const OptionFacts& option : command.options) {
      if (!option.positional) all += fish_line(condition, option);
    }
    const OptionFacts* first = positional_of(command);
    if (!top && (first == nullptr || first->expects == Expects::one_of)) {
      all += "complete -c cairn -n " + shell_word(condition) + " -f" +
             (first == nullptr ? "" : " -a " + shell_word(joined(first->words))) + "\n";
    }
  }
  return all;
}

}  // namespace cairn::cli
