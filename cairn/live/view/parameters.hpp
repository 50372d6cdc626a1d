// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include <cairn/live/view/view_options.hpp>

/// The options of a run as the Foxglove protocol's parameters. Internal to the live view; used by one thread.
namespace cairn::live {

class Parameters {
 public:
  using Json = nlohmann::ordered_json;

  Parameters(ViewedRun run, bool is_tunable);

  /// The values of the named parameters (empty: all); unknown names are left out.
  [[nodiscard]] Json values(const std::set<std::string>& names) const;
  [[nodiscard]] bool has(const std::string& name) const;

  /// Sets parameters from a client's list of {name, value}; without a value, an option is reset to its
  /// initial one. Options: all or none. Throws Error (what was found, what was expected).
  void set(const nlohmann::json& list);

  /// The names of the parameters that changed since the last call.
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
