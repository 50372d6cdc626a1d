// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace cairn::cli {

/// Throws Error if the option is given with several runs.
void require_one_run(const char* option, const std::optional<std::string>& file,
                     const std::vector<std::string>& runs);

/// The --csv file of `cairn evaluate`: a header line of names, then one line per run (name, summary): the
/// names are the paths in the summaries, with points. Missing values are empty.
std::string csv(const std::vector<std::pair<std::string, nlohmann::ordered_json>>& runs);

}  // namespace cairn::cli
