// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/pipeline/config.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace cairn {

enum class TunableKind : std::uint8_t { number, whole_number, choice };

/// An option to search and its limits, both from the fields() of its stage.
struct Tunable {
  std::string name;  // "match.window_size"
  TunableKind kind = TunableKind::number;
  double lowest = 0;  // for numbers
  double highest = 0;
  bool minus_one_is_off = false;
  bool odd_only = false;
  std::vector<std::string> choices;     // all values of a choice or a bool
  std::vector<std::string> of_presets;  // its distinct values in the presets
};

/// All options.
std::vector<Tunable> tunables();
/// The options that match `patterns`, in their usual order, each once. A pattern is the name of an option or
/// a prefix followed by *: "match.*", "*". Throws Error for a pattern without match.
std::vector<Tunable> tunables(const std::vector<std::string>& patterns);
/// Of those, the options that `config` reads, or would read with another value of one of them. Throws Error
/// for a pattern without such an option.
std::vector<Tunable> tunables(const std::vector<std::string>& patterns, const Config& config);

/// The patterns of the options searched by default: numbers that `config` reads and that do not follow from a
/// calibration. `objects`: also those that only affect objects, not disparities.
std::vector<std::string> usual_tunables(const Config& config, bool objects);
/// Whether the option affects disparities, not only objects.
bool changes_disparities(std::string_view option);

/// The values to try next to `value`, as accepted by set(); never `value` itself, always within the limits. A
/// number is multiplied and divided by `step` > 1, rounded to three digits; an integer changes by at least
/// one. A number with an off value is also tried off; from off or 0, the values of the presets are tried. For
/// a choice: every other value.
std::vector<std::string> neighbours(const Tunable& tunable, const std::string& value, double step);

}  // namespace cairn
