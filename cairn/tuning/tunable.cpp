// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <array>
#include <cairn/core/error.hpp>
#include <cairn/core/nearest.hpp>
#include <cairn/core/number_text.hpp>
#include <cairn/tuning/tunable.hpp>
#include <charconv>
#include <cmath>
#include <type_traits>

namespace cairn {
namespace {

constexpr double kOff = -1;

template <class T>
void describe(Tunable& tunable, const T&, const Range<T>& range) {
  tunable.kind = std::is_integral_v<T> ? TunableKind::whole_number : TunableKind::number;
  tunable.lowest = static_cast<double>(range.lowest);
  tunable.highest = static_cast<double>(range.highest);
  tunable.minus_one_is_off = range.minus_one_is_off;
  tunable.odd_only = range.odd_only;
}

void describe(Tunable& tunable, bool, Any) {
  tunable.kind = TunableKind::choice;
  tunable.choices = {"false", "true"};
}

template <class E, std::size_t N>
void describe(Tunable& tunable, E, const std::array<Choice<E>, N>& choices) {
  tunable.kind = TunableKind::choice;
  for (const auto& choice : choices) tunable.choices.emplace_back(choice.name);
}

std::vector<std::string> preset_values(const std::string& option) {
  std::vector<std::string> values;
  for (const std::string& preset : preset_names()) {
    for (const OptionInfo& known : options(Config::preset(preset))) {
      const bool is_new = std::find(values.begin(), values.end(), known.value) == values.end();
      if (known.name == option && is_new) values.push_back(known.value);
    }
  }
  return values;
}

bool fits(std::string_view name, std::string_view pattern) {
  return pattern.ends_with('*') ? name.starts_with(pattern.substr(0, pattern.size() - 1)) : name == pattern;
}

[[noreturn]] void refuse(const std::string& pattern, const std::vector<Tunable>& all) {
  std::vector<std::string> names;
  names.reserve(all.size());
  for (const Tunable& tunable : all) names.push_back(tunable.name);
  const std::string close = nearest(pattern, names);
  throw Error("no option to tune is named '" + pattern.substr(0, 80) + "'" +
              (close.empty() ? ", expected names from cairn config, or a prefix such as match.*"
                             : ", did you mean '" + close + "'?"));
}

const OptionInfo& option_named(const std::vector<OptionInfo>& all, std::string_view name) {
  return *std::find_if(all.begin(), all.end(), [&](const OptionInfo& option) { return option.name == name; });
}

/// Whether the option is active, or becomes active with another value of one in `varied`.
bool may_be_read(std::string_view name, const std::vector<Tunable>& varied,
                 const std::vector<OptionInfo>& all) {
  const OptionInfo& option = option_named(all, name);
  if (option.active) return true;
  const std::size_t end = option.needs.find_first_of("!=");
  const std::string required = option.needs.substr(0, end);
  const bool varies =
      std::any_of(varied.begin(), varied.end(), [&](const Tunable& t) { return t.name == required; });
  const bool differs = option.needs[end] == '!';
  const bool same = option.needs.substr(end + (differs ? 2 : 1)) == option_named(all, required).value;
  return (varies || same != differs) && may_be_read(required, varied, all);
}

double number_of(const std::string& text) {
  double value = 0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

std::string text_of(double value, TunableKind kind) {
  return kind == TunableKind::whole_number ? shortest_text(std::llround(value))
                                           : shortest_text(static_cast<float>(value));
}

/// Rounds to three significant digits, for readability.
double rounded(double value) {
  if (value == 0) return 0;
  const double scale = std::pow(10.0, 2 - std::floor(std::log10(std::abs(value))));
  return std::round(value * scale) / scale;
}

/// The nearest valid value to `value`: within the limits, an integer or odd if required, and at least one
/// step away from `from`.
double allowed(const Tunable& tunable, double value, double from) {
  if (tunable.kind == TunableKind::number) return std::clamp(rounded(value), tunable.lowest, tunable.highest);
  const double way = value < from ? -1 : 1;
  const double least = tunable.odd_only ? 2 : 1;
  value = std::round(value);
  if (std::abs(value - from) < least) value = from + way * least;
  if (tunable.odd_only && std::fmod(value, 2) == 0) value += way;
  return value < tunable.lowest || value > tunable.highest ? from : value;
}

/// Values to try for an option that is 0 or off, where a factor has no effect: those of the presets, else a
/// small share of the range.
std::vector<double> values_when_off(const Tunable& tunable) {
  constexpr double kSmallPart = 1.0 / 64;
  std::vector<double> values;
  for (const std::string& text : tunable.of_presets) {
    if (const double value = number_of(text); value != 0 && value != kOff) values.push_back(value);
  }
  if (values.empty()) values.push_back(std::max(tunable.lowest, tunable.highest * kSmallPart));
  return values;
}

}  // namespace

std::vector<Tunable> tunables() {
  std::vector<Tunable> all;
  Config config;  // not const, because fields() takes a non-const reference
  for_each_section(config, [&](std::string_view section, auto& stage) {
    fields(stage, [&](std::string_view name, auto& value, std::string_view, std::string_view,
                      const auto& domain, const Condition& = {}) {
      Tunable tunable;
      tunable.name = std::string(section) + '.' + std::string(name);
      describe(tunable, value, domain);
      tunable.of_presets = preset_values(tunable.name);
      all.push_back(std::move(tunable));
    });
  });
  return all;
}

std::vector<Tunable> tunables(const std::vector<std::string>& patterns) {
  const std::vector<Tunable> all = tunables();
  for (const std::string& pattern : patterns) {
    if (std::none_of(all.begin(), all.end(), [&](const Tunable& t) { return fits(t.name, pattern); }))
      refuse(pattern, all);
  }
  std::vector<Tunable> chosen;
  std::copy_if(all.begin(), all.end(), std::back_inserter(chosen), [&](const Tunable& tunable) {
    return std::any_of(patterns.begin(), patterns.end(),
                       [&](const std::string& pattern) { return fits(tunable.name, pattern); });
  });
  return chosen;
}

std::vector<Tunable> tunables(const std::vector<std::string>& patterns, const Config& config) {
  std::vector<Tunable> chosen = tunables(patterns);
  const std::vector<Tunable> named = chosen;
  const std::vector<OptionInfo> all = options(config);
  std::erase_if(chosen, [&](const Tunable& tunable) { return !may_be_read(tunable.name, named, all); });
  for (const std::string& pattern : patterns) {
    const auto fits_pattern = [&](const Tunable& tunable) { return fits(tunable.name, pattern); };
    if (std::any_of(chosen.begin(), chosen.end(), fits_pattern)) continue;
    require_active(config, std::find_if(named.begin(), named.end(), fits_pattern)->name);
  }
  return chosen;
}

std::vector<std::string> usual_tunables(const Config& config, bool objects) {
  std::vector<std::string> patterns{"left_right.max_diff", "uniqueness.ratio", "speckle.size"};
  const auto add = [&](std::initializer_list<const char*> more) {
    patterns.insert(patterns.end(), more.begin(), more.end());
  };
  if (config.match.method == MatchMethod::semi_global) {
    add({"semi_global.*"});
  } else {
    add({"match.cost", "match.window_size", "flatness.threshold", "texture.threshold"});
  }
  if (!objects) return patterns;
  if (config.ground.source != GroundSource::off) add({"ground.margin"});
  add({"objects.min_area", "objects.min_confidence"});
  if (config.pipeline.method == Method::region_tree) {
    add({"superpixels.*"});
  } else {
    add({"intensity.*", "disparity.*"});
  }
  return patterns;
}

bool changes_disparities(std::string_view option) {
  if (option.starts_with("pipeline.")) return false;
  for (const OptionInfo& known : options(Config{})) {  // in data-flow order
    if (known.name.starts_with("background.")) return false;
    if (known.name == option) return true;
  }
  return false;
}

std::vector<std::string> neighbours(const Tunable& tunable, const std::string& value, double step) {
  std::vector<std::string> all;
  const auto add = [&](std::string text) {
    if (text != value && std::find(all.begin(), all.end(), text) == all.end()) all.push_back(std::move(text));
  };
  if (tunable.kind == TunableKind::choice) {
    for (const std::string& choice : tunable.choices) add(choice);
    return all;
  }
  const double current = number_of(value);
  const bool off = tunable.minus_one_is_off && current == kOff;
  if (off || current == 0) {
    for (const double other : values_when_off(tunable)) add(text_of(other, tunable.kind));
  } else {
    for (const double other : {current * step, current / step})
      add(text_of(allowed(tunable, other, current), tunable.kind));
  }
  if (tunable.minus_one_is_off) add(text_of(kOff, tunable.kind));
  return all;
}

}  // namespace cairn
