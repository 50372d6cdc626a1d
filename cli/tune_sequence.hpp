// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common.hpp"

namespace cairn::cli {

struct TuneSequenceOptions {
  std::string source;
  std::string calib;
  ConfigOptions config;
  ExecOptions exec;
  std::vector<std::string> patterns;  // empty: usual_tunables()
  int evaluations = 0;                // 0 = limited by the time only
  double seconds = 60;
  std::optional<double> holdout;
  std::uint32_t seed = 1;
  std::string output;
};

/// `cairn tune --sequence`: searches for the options with the steadiest objects of a sequence, see
/// steadiness(); prints and writes the options. `stop` returns true to end. Returns the exit code.
int tune_sequence(const TuneSequenceOptions& options, const std::function<bool()>& stop);

}  // namespace cairn::cli
