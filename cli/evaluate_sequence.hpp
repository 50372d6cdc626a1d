// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace cairn::cli {

struct EvaluateSequenceOptions {
  std::vector<std::string> results;
  std::string truth;
  int min_area = 200;
  bool tentative = false;
  std::optional<std::string> json;
  std::optional<std::string> csv;
};

/// `cairn evaluate RESULT … TRUTH --sequence`: prints the scores and writes the requested files. Returns the
/// exit code.
int evaluate_sequence(const EvaluateSequenceOptions& options);

/// `cairn evaluate poses.tum truth.tum`.
int evaluate_trajectory(const EvaluateSequenceOptions& options);

}  // namespace cairn::cli
