// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/pipeline/config.hpp>
#include <string_view>

#include "facts.hpp"

namespace cairn::cli {
namespace {

/// Text as roff prints it unchanged: hyphens that can be copied, no escape, no line that is a request.
std::string roff(std::string_view text) {
  std::string all;
  bool line_start = true;
  for (const char c : text) {
    if (line_start && (c == '.' || c == '\'')) all += "\\&";
    if (c == '\\') {
      all += "\\e";
    } else if (c == '-') {
      all += "\\-";
    } else {
      all += c;
    }
    line_start = c == '\n';
  }
  return all;
}

std::string bold(std::string_view text) {
  return "\\fB" + roff(text) + "\\fR";
}
std::string italic(std::string_view text) {
  return "\\fI" + roff(text) + "\\fR";
}

std::string head(const std::string& title, const char* section, const std::string& name,
                 const std::string& what) {
  return "'\\\" -*- coding: utf-8 -*-\n.TH \"" + title + "\" " + section +
         " \"\" \"cairn " CAIRN_VERSION "\" \"cairn\"\n.nh\n.ad l\n.SH NAME\n" + roff(name) + " \\- " +
         roff(what) + "\n";
}

/// A text with its line ends, wrapped where a line is too long for the page.
std::string as_lines(std::string_view text) {
  std::string all;
  for (const char c : roff(text)) all += c == '\n' ? std::string("\n.br\n") : std::string(1, c);
  return all + "\n";
}

std::string usage(const CommandFacts& command) {
  std::string line = bold("cairn");
  if (command.name.empty()) return line + " " + italic("COMMAND") + " [" + italic("OPTION") + "]...\n";
  line += " " + bold(command.name) + " [" + italic("OPTION") + "]...";
  for (const OptionFacts& option : command.options) {
    if (!option.positional) continue;
    const std::string name = italic(option.names.front());
    line += option.required ? " " + name : " [" + name + "]";
  }
  return line + "\n";
}

std::string limits(const OptionFacts& option) {
  std::string text;
  if (!option.domain.empty()) text += "range: " + option.domain;
  if (!option.standard.empty()) text += (text.empty() ? "default: " : "; default: ") + option.standard;
  return text.empty() ? "" : " (" + text + ")";
}

std::string entry(const OptionFacts& option) {
  std::string tag;
  for (const std::string& name : option.names) {
    tag += (tag.empty() ? "" : ", ") + (option.positional ? italic(name) : bold(name));
  }
  if (!option.value.empty()) tag += " " + italic(option.value);
  return ".TP\n" + tag + "\n" + roff(option.help + limits(option)) + "\n";
}

std::string entries(const CommandFacts& command, bool positional) {
  std::string all;
  for (const OptionFacts& option : command.options) {
    if (option.positional == positional) all += entry(option);
  }
  return all;
}

std::string see_also(const std::vector<CommandFacts>& commands, const std::string& except) {
  std::string all = ".SH SEE ALSO\n";
  for (const CommandFacts& command : commands) {
    const std::string page = command.name.empty() ? "cairn" : "cairn-" + command.name;
    if (page != except) all += bold(page) + "(1),\n";
  }
  return all + bold("cairn-options") + "(7)\n";
}

std::string command_page(const CommandFacts& command, const std::vector<CommandFacts>& commands) {
  const std::string name = "cairn-" + command.name;
  std::string page = head(name, "1", name, command.help) + ".SH SYNOPSIS\n" + usage(command);
  if (const std::string arguments = entries(command, true); !arguments.empty()) {
    page += ".SH ARGUMENTS\n" + arguments;
  }
  page += ".SH OPTIONS\n" + entries(command, false);
  if (!command.footer.empty()) page += ".SH NOTES\n" + as_lines(command.footer);
  if (!command.examples.empty()) page += ".SH EXAMPLES\n.nf\n" + roff(command.examples) + ".fi\n";
  return page + see_also(commands, name);
}

std::string main_page(const std::vector<CommandFacts>& commands) {
  const CommandFacts& cairn = commands.front();
  const std::string prefix = "cairn: ";
  const std::string what = cairn.help.starts_with(prefix) ? cairn.help.substr(prefix.size()) : cairn.help;
  std::string page = head("cairn", "1", "cairn", what) + ".SH SYNOPSIS\n" + usage(cairn) + ".SH COMMANDS\n";
  for (const CommandFacts& command : commands) {
    if (!command.name.empty()) {
      page += ".TP\n" + bold("cairn-" + command.name) + "(1)\n" + roff(command.help) + "\n";
    }
  }
  page += ".SH OPTIONS\n" + entries(cairn, false) + ".SH NOTES\n" + as_lines(cairn.footer);
  return page + see_also(commands, "cairn");
}

std::string options_page() {
  std::string page = head("cairn-options", "7", "cairn-options", "options of the stages") +
                     ".SH DESCRIPTION\nSet one with " + bold("--set") + " " + italic("NAME=VALUE") +
                     ", several in a file with " + bold("--config") + " " + italic("FILE") + ", which " +
                     bold("cairn config") + " prints.\nThe values are those of the preset default.\n";
  std::string section;
  for (const OptionInfo& option : options(Config{})) {
    const std::string stage = option.name.substr(0, option.name.find('.'));
    if (stage != section) page += ".SH \"" + roff(stage) + "\"\n";
    section = stage;
    page += ".TP\n" + bold(option.name) + " = " + italic(option.value.empty() ? "(none)" : option.value) +
            (option.unit.empty() ? "" : " " + roff(option.unit)) + "\n" + roff(option.help) + "\n";
    if (!option.needs.empty()) page += ".br\n" + roff("read while " + option.needs) + "\n";
    if (!option.domain.empty()) page += ".br\n" + roff("values: " + option.domain) + "\n";
  }
  return page + ".SH SEE ALSO\n" + bold("cairn") + "(1)\n";
}

}  // namespace

std::vector<NamedText> man_pages(const std::vector<CommandFacts>& commands) {
  std::vector<NamedText> pages{{"man1/cairn.1", main_page(commands)}};
  for (const CommandFacts& command : commands) {
    if (!command.name.empty()) {
      pages.push_back({"man1/cairn-" + command.name + ".1", command_page(command, commands)});
    }
  }
  pages.push_back({"man7/cairn-options.7", options_page()});
  return pages;
}

}  // namespace cairn::cli
