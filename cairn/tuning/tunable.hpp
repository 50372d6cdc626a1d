// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/pipeline/config.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace cairn {

enum class TunableKind : std::uint8_t { number, whole_number, choice };

/// An option that a search may change, and within which limits; both come from the fields() of its stage.
struct Tunable {
  std::string name;  // "match.window_size"
  TunableKind kind = TunableKind::number;
  double lowest = 0;  // of numbers
  double highest = 0;
  bool minus_one_is_off = false;
  bool odd_only = false;
  std::vector<std::string> choices;     // every value of a choice or a bool
  std::vector<std::string> of_presets;  // what the presets give it, each value once
};

/// Every option.
std::vector<Tunable> tunables();
/// Those that `patterns` name, in the order of the options, each once. A pattern is an option's name or its
/// beginning with a * behind it: "match.*", "*". Throws Error for a pattern that names none.
std::vector<Tunable> tunables(const std::vector<std::string>& patterns);
/// Of those the ones that `config` reads, or would read with another value of one of them. Throws Error for a
/// pattern that names none such.
std::vector<Tunable> tunables(const std::vector<std::string>& patterns, const Config& config);

/// The patterns of the options that are searched where nobody chooses: numbers that `config` reads and that
/// no calibration knows better. `objects`: also those that only the objects depend on, not the disparities.
std::vector<std::string> usual_tunables(const Config& config, bool objects);
/// Whether the disparities depend on the option, and not only the objects.
bool changes_disparities(std::string_view option);

/// What a search tries next to `value`, as set() reads it; never `value` itself, always within the limits. A
/// number grows and shrinks by the factor `step` > 1, rounded to three digits, a whole one by at least one. A
/// number that can be switched off is tried off as well; from off or 0, what the presets give is tried. Of a
/// choice, every other value.
std::vector<std::string> neighbours(const Tunable& tunable, const std::string& value, double step);

}  // namespace cairn
