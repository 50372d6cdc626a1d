// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/output/json.hpp>
#include <cairn/timing/frame_times.hpp>
#include <string>
#include <vector>

#include "common.hpp"

namespace cairn::cli {

/// What `cairn bench --budget` found.
struct BudgetReport {
  std::string text;
  output::Json json;
};

struct Budget {
  double rate_hz = 0;
  Size size;                         // the largest to try
  std::vector<std::string> presets;  // to try
  timing::Limits limits;             // of each trial
};

/// Times the presets on the rendered room, at the size and at shares of it with as large shares of the number of
/// disparities, until 99 % of the frames take at most 1/rate_hz.
BudgetReport sizes_within_budget(const Budget& budget, const ConfigOptions& options, const Exec& exec);

}  // namespace cairn::cli
