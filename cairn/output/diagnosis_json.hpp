// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/diagnosis/diagnose.hpp>
#include <cairn/diagnosis/synchrony.hpp>
#include <string>
#include <vector>

/// What `cairn doctor --json` writes of each pair, each finding and the sequence (docs/doctor.md); Python has
/// the same.
namespace cairn::output {

/// One number of a pair; NaN where it was not measured.
struct PairNumber {
  const char* key;     // in JSON
  const char* name;    // on the terminal
  const char* format;  // of printf
  double (*of)(const PairMeasures&);
};
std::vector<PairNumber> pair_numbers();

/// An object of pair_numbers(), null where not measured, and rows_histogram.
std::string measures_json(const PairMeasures& measures);
/// `names`: of the pairs that Finding::frames counts.
std::string finding_json(const Finding& finding, const std::vector<std::string>& names);
/// `names`: of its frames; without them frames go by their numbers.
std::string synchrony_json(const Synchrony& synchrony, const std::vector<std::string>& names);

}  // namespace cairn::output
