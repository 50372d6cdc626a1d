// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "evaluation_text.hpp"

#include <algorithm>
#include <cairn/core/error.hpp>
#include <map>

namespace cairn::cli {
namespace {

using Json = nlohmann::ordered_json;

/// Quotes a CSV field that may contain commas.
std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string all = "\"";
  for (const char c : text) all += c == '"' ? std::string("\"\"") : std::string(1, c);
  return all + "\"";
}

}  // namespace

void require_one_run(const char* option, const std::optional<std::string>& file,
                     const std::vector<std::string>& runs) {
  if (!file || runs.size() < 2) return;
  throw Error(std::string(option) + " " + *file + ": needs one run, found " + std::to_string(runs.size()) +
              "; --csv accepts several");
}

std::string csv(const std::vector<std::pair<std::string, Json>>& runs) {
  std::vector<std::string> names;
  std::vector<std::map<std::string, std::string>> rows;
  for (const auto& [run, summary] : runs) {
    std::map<std::string, std::string> row;
    const Json flat = summary.flatten();
    for (const auto& [pointer, value] : flat.items()) {
      std::string name = pointer.substr(1);
      std::replace(name.begin(), name.end(), '/', '.');
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
      row[name] = value.is_null() ? "" : value.dump();
    }
    rows.push_back(std::move(row));
  }
  // A run without a section, such as `objects`, has no value for its name if other runs have its parts.
  std::erase_if(names, [&](const std::string& name) {
    return std::any_of(names.begin(), names.end(),
                       [&](const std::string& other) { return other.starts_with(name + "."); });
  });
  std::string text = "run";
  for (const std::string& name : names) text += "," + name;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    text += "\n" + quoted(runs[i].first);
    for (const std::string& name : names) text += "," + rows[i][name];
  }
  return text + "\n";
}

}  // namespace cairn::cli
