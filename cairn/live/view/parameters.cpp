// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/live/view/parameters.hpp>

#include <algorithm>
#include <cairn/core/error.hpp>
#include <cairn/core/number_text.hpp>
#include <cairn/io/config_files.hpp>
#include <cairn/output/json.hpp>
#include <cairn/output/json_line.hpp>
#include <charconv>
#include <cmath>
#include <utility>

namespace cairn::live {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kPause = "live.pause";
constexpr std::string_view kStep = "live.step";
constexpr std::string_view kRecord = "live.record";

Json json_value(const OptionInfo& option) {
  if (option.type == "bool") return option.value == "true";
  const char* const end = option.value.data() + option.value.size();
  if (std::int64_t whole = 0;
      option.type == "int" && std::from_chars(option.value.data(), end, whole).ptr == end)
    return whole;
  if (double number = 0;
      option.type == "float" && std::from_chars(option.value.data(), end, number).ptr == end)
    return number;
  return option.value;
}

[[noreturn]] void refuse(const std::string& name, const nlohmann::json& found, const std::string& expected) {
  throw Error("option " + name + ": found " + output::shown(found) + ", expected " + expected);
}

/// The value as text for set(). JavaScript has one number type: 3.0 is an integer.
std::string text_of(const OptionInfo& option, const nlohmann::json& value) {
  if (option.type == "bool") {
    if (!value.is_boolean()) refuse(option.name, value, "true or false");
    return value.get<bool>() ? "true" : "false";
  }
  if (option.type == "choice") {
    if (!value.is_string()) refuse(option.name, value, "one of " + option.domain);
    return value.get<std::string>();
  }
  const bool is_whole = option.type == "int";
  if (!value.is_number())
    refuse(option.name, value, (is_whole ? "a whole number, " : "a number, ") + option.domain);
  const auto number = value.get<double>();
  if (is_whole && (std::floor(number) != number || std::abs(number) > 1e9))
    refuse(option.name, value, "a whole number, " + option.domain);
  return is_whole ? shortest_text(static_cast<std::int64_t>(number)) : shortest_text(number);
}

}  // namespace

Parameters::Parameters(ViewedRun run, bool is_tunable) : run_(std::move(run)), is_tunable_(is_tunable) {
  for (const OptionInfo& option : options()) first_[option.name] = option.value;
  take_changes();
}

std::vector<OptionInfo> Parameters::options() const {
  return run_.config ? cairn::options(*run_.config()) : std::vector<OptionInfo>{};
}

/// Parameters that are switches but not options.
std::vector<std::pair<std::string, bool>> Parameters::live() const {
  std::vector<std::pair<std::string, bool>> all;
  if (run_.pause) all.emplace_back(kPause, run_.is_paused && run_.is_paused());
  if (run_.step) all.emplace_back(kStep, false);
  if (run_.record) all.emplace_back(kRecord, run_.is_recording && run_.is_recording());
  return all;
}

Json Parameters::values(const std::set<std::string>& names) const {
  Json all = Json::array();
  const auto is_wanted = [&](const std::string& name) { return names.empty() || names.contains(name); };
  for (const OptionInfo& option : options()) {
    if (!is_wanted(option.name)) continue;
    Json parameter{{"name", option.name}, {"value", json_value(option)}};
    if (option.type == "float") parameter["type"] = "float64";  // else 1.0 would count as an integer
    all.push_back(std::move(parameter));
  }
  for (const auto& [name, value] : live()) {
    if (is_wanted(name)) all.push_back({{"name", name}, {"value", value}});
  }
  return all;
}

bool Parameters::has(const std::string& name) const {
  const auto all = live();
  return first_.contains(name) ||
         std::any_of(all.begin(), all.end(), [&](const auto& each) { return each.first == name; });
}

void Parameters::set(const nlohmann::json& list) {
  if (!list.is_array())
    throw Error("setParameters: found " + output::shown(list) + ", expected a list of parameters");
  if (!is_tunable_) throw Error("setParameters: this view is read-only; expected cairn live --tunable");
  const std::vector<OptionInfo> known = options();
  std::vector<std::pair<std::string, std::string>> texts;
  std::vector<std::pair<std::string, nlohmann::json>> switches;
  for (const nlohmann::json& parameter : list) {
    const output::JsonLine line(parameter);
    const std::string name = line.text("name");
    const nlohmann::json& value = line.at("value");
    if (name.starts_with("live.")) {
      if (!has(name)) throw Error("parameter " + output::shown(name) + ": is not an option of this run");
      if (!value.is_boolean()) refuse(name, value, "true or false");
      switches.emplace_back(name, value);
      continue;
    }
    const auto option = std::ranges::find(known, name, &OptionInfo::name);
    if (option == known.end()) {
      FollowConfig any;
      cairn::set(any, name.substr(0, 80), "");  // its error names the similar or the new option
      throw Error("option " + output::shown(name) + ": unknown option");
    }
    texts.emplace_back(name, value.is_null() ? first_.at(name) : text_of(*option, value));
  }
  if (!texts.empty()) {
    if (!run_.set) throw Error("setParameters: the options of this run cannot be changed");
    run_.set(texts);
  }
  for (const auto& [name, value] : switches) set_live(name, value);
}

void Parameters::set_live(const std::string& name, const nlohmann::json& value) {
  const bool on = value.get<bool>();
  if (name == kPause) run_.pause(on);
  if (name == kStep && on) run_.step();
  if (name == kRecord) run_.record(on);
}

std::set<std::string> Parameters::take_changes() {
  std::map<std::string, std::string> now;
  for (const OptionInfo& option : options()) now[option.name] = option.value;
  for (const auto& [name, value] : live()) now[name] = value ? "true" : "false";
  std::set<std::string> changed;
  for (const auto& [name, value] : now) {
    const auto before = known_.find(name);
    if (before == known_.end() || before->second != value) changed.insert(name);
  }
  known_ = std::move(now);
  return changed;
}

std::string Parameters::options_json() const {
  Json all = Json::array();
  for (const OptionInfo& option : options()) {
    Json first = json_value({option.name, option.type, first_.at(option.name), {}, {}, {}, {}, true});
    all.push_back({{"name", option.name},
                   {"type", option.type},
                   {"value", json_value(option)},
                   {"unit", option.unit},
                   {"domain", option.domain},
                   {"help", option.help},
                   {"needs", option.needs},
                   {"active", option.active},
                   {"first", std::move(first)}});
  }
  return output::json_text(all) + "\n";
}

std::string Parameters::config_yaml() const {
  FollowConfig plain;
  plain.segmentation = Config::preset(run_.preset);
  const std::vector<OptionInfo> of_preset = cairn::options(plain);
  std::vector<OptionInfo> changed = options();
  std::erase_if(changed, [&](const OptionInfo& option) {
    const auto same = std::ranges::find(of_preset, option.name, &OptionInfo::name);
    return !option.active || (same != of_preset.end() && same->value == option.value);
  });
  return "preset: " + run_.preset + "\n" + io::options_yaml(changed);
}

}  // namespace cairn::live
