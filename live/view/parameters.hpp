// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "view_options.hpp"

/// The options of a run as the Foxglove protocol's parameters. Internal to the live view; used by one thread.
namespace cairn::live {

class Parameters {
 public:
  using Json = nlohmann::ordered_json;

  Parameters(ViewedRun run, bool is_tunable);

  /// Those of these names (none: all) with their values; what is not known is left out.
  [[nodiscard]] Json values(const std::set<std::string>& names) const;
  [[nodiscard]] bool has(const std::string& name) const;

  /// What a client asks for: a list of {name, value}; without a value, an option is as at the start. Options
  /// all or none. Throws Error (what was found, what was expected).
  void set(const nlohmann::json& list);

  /// The names of those whose values differ from what they were at the last call.
  std::set<std::string> take_changes();

  /// For /options.json and /config.yaml.
  [[nodiscard]] std::string options_json() const;
  [[nodiscard]] std::string config_yaml() const;

 private:
  [[nodiscard]] std::vector<OptionInfo> options() const;
  [[nodiscard]] std::vector<std::pair<std::string, bool>> live() const;
  void set_live(const std::string& name, const nlohmann::json& value);

  ViewedRun run_;
  bool is_tunable_;
  std::map<std::string, std::string> first_;  // values at the start
  std::map<std::string, std::string> known_;  // at the last take_changes()
};

}  // namespace cairn::live
