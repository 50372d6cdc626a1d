// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "facts.hpp"

#include <algorithm>
#include <cairn/core/target.hpp>
#include <cairn/pipeline/config.hpp>
#include <cairn/tuning/tunable.hpp>
#include <string_view>

namespace cairn::cli {
namespace {

std::vector<std::string> target_names() {
  std::vector<std::string> names{"best"};
  for (const Target target : compiled_targets()) names.emplace_back(name(target));
  return names;
}

std::vector<std::string> tunable_names() {
  std::vector<std::string> names;
  for (const Tunable& tunable : tunables()) {
    const std::string section = tunable.name.substr(0, tunable.name.find('.')) + ".*";
    if (names.empty() || std::find(names.begin(), names.end(), section) == names.end())
      names.push_back(section);
    names.push_back(tunable.name);
  }
  return names;
}

std::vector<std::string> command_names() {
  std::vector<std::string> names;
  names.reserve(kCommands.size());
  for (const Command& command : kCommands) names.emplace_back(command.name);
  return names;
}

/// The words of CLI::IsMember, which describes itself as "{a,b}".
std::vector<std::string> members(std::string_view domain) {
  std::vector<std::string> words;
  if (!domain.starts_with('{') || !domain.ends_with('}')) return words;
  domain = domain.substr(1, domain.size() - 2);
  while (!domain.empty()) {
    const std::size_t comma = domain.find(',');
    words.emplace_back(domain.substr(0, comma));
    domain = comma == std::string_view::npos ? std::string_view{} : domain.substr(comma + 1);
  }
  return words;
}

/// "INT in [0 - 1024]" is "0 - 1024" for readers.
std::string readable(const std::string& domain) {
  const std::size_t open = domain.find("in [");
  if (open == std::string::npos) return domain;
  return domain.substr(open + 4, domain.rfind(']') - open - 4);
}

Expects expects(const OptionFacts& option) {
  if (option.is_flag()) return Expects::nothing;
  if (!option.words.empty()) return Expects::one_of;
  if (option.value == "NAME=VALUE") return Expects::assignment;
  if (option.value == "DIR") return Expects::folder;
  // Positionals are pictures and folders in every command.
  return option.positional || option.value == "FILE" || option.value == "PATH" ? Expects::file
                                                                               : Expects::text;
}

OptionFacts facts_of(const CLI::Option& option) {
  OptionFacts facts;
  facts.positional = option.get_positional();
  facts.required = option.get_required();
  facts.help = option.get_description();
  facts.standard = option.get_default_str();
  if (facts.positional) {
    facts.names.push_back(option.get_name(true));
  } else {
    for (const std::string& name : option.get_snames()) facts.names.push_back("-" + name);
    for (const std::string& name : option.get_lnames()) facts.names.push_back("--" + name);
  }
  const bool takes_value = option.get_items_expected_max() > 0;
  const std::string type = takes_value ? option.get_type_name() : "";
  const std::size_t colon = type.find(':');
  if (!facts.positional) facts.value = type.substr(0, colon);
  const std::string domain = colon == std::string::npos ? "" : type.substr(colon + 1);
  facts.words = members(domain.empty() ? type : domain);
  if (facts.words.empty()) facts.domain = readable(domain);
  // Their names are the library's, and --help tells them in words.
  if (facts.names.back() == "--preset") facts.words = preset_names();
  if (facts.names.back() == "--target") facts.words = target_names();
  if (facts.names.back() == "--options") facts.words = tunable_names();
  if (facts.names.back() == "COMMAND") facts.words = command_names();
  facts.expects = expects(facts);
  return facts;
}

CommandFacts command_facts(const CLI::App& app) {
  CommandFacts facts{app.get_name(), app.get_description(), {}, app.get_footer(), {}};
  if (app.get_parent() == nullptr) facts.name.clear();
  for (const Command& command : kCommands) {
    if (facts.name != command.name) continue;
    facts.examples = command.examples;
    facts.footer.erase(0, std::min(facts.footer.size(), examples_text(command).size() + 1));
  }
  for (const CLI::Option* option : app.get_options()) facts.options.push_back(facts_of(*option));
  return facts;
}

}  // namespace

std::vector<CommandFacts> facts_of(const CLI::App& app) {
  std::vector<CommandFacts> all{command_facts(app)};
  for (const CLI::App* sub : app.get_subcommands([](const CLI::App*) { return true; })) {
    all.push_back(command_facts(*sub));
  }
  return all;
}

}  // namespace cairn::cli
