// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <algorithm>
#include <array>
#include <cairn/core/error.hpp>
#include <cairn/core/nearest.hpp>
#include <cairn/core/number_text.hpp>
#include <cairn/pipeline/config.hpp>
#include <charconv>
#include <cmath>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

/// Iterates over the options of any configuration with for_each_section(). Private to the library.
namespace cairn::option_walk {

// ---- text of values and domains ----

inline std::string write(bool value) {
  return value ? "true" : "false";
}

template <class Number>
requires std::is_arithmetic_v<Number> std::string write(Number value) {
  return shortest_text(value);
}

template <class E, std::size_t N>
std::string write(E value, const std::array<Choice<E>, N>& choices) {
  return choice_name(value, choices);
}

template <class T, class Domain>
std::string write(const T& value, const Domain&) {
  return write(value);
}

template <class T>
std::string describe(const Range<T>& range) {
  std::string text = range.minus_one_is_off ? "−1 = off, " : "";
  text += write(range.lowest) + " … " + write(range.highest);
  if (range.odd_only) text += ", odd";
  return text;
}

template <class E, std::size_t N>
std::string describe(const std::array<Choice<E>, N>& choices) {
  std::string text;
  for (const auto& choice : choices) text += (text.empty() ? "" : "|") + std::string(choice.name);
  return text;
}

inline std::string type_name(bool) {
  return "bool";
}
inline std::string type_name(int) {
  return "int";
}
inline std::string type_name(float) {
  return "float";
}
template <class E>
requires std::is_enum_v<E> std::string type_name(E) {
  return "choice";
}

inline std::string describe_any(bool) {
  return "true|false";
}
template <class T, class Domain>
std::string domain_of(const T& value, const Domain& domain) {
  if constexpr (std::is_same_v<Domain, Any>) {
    return describe_any(value);
  } else {
    return describe(domain);
  }
}

// ---- reading values ----

[[noreturn]] inline void refuse(const std::string& option, std::string_view found,
                                const std::string& expected) {
  throw Error("option " + option + ": found '" + std::string(found.substr(0, 80)) + "', expected " +
              expected);
}

template <class Number>
bool parse_number(std::string_view text, Number& value) {
  if (text.starts_with('+')) text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size() &&
         std::isfinite(static_cast<double>(value));
}

template <class T>
void check(const std::string& option, T value, const Range<T>& range) {
  const bool off = range.minus_one_is_off && value == T{-1};
  const bool inside = value >= range.lowest && value <= range.highest;  // false for NaN
  bool parity = true;
  if constexpr (std::is_integral_v<T>) parity = !range.odd_only || value % 2 == 1;
  if (!off && !(inside && parity)) refuse(option, write(value), describe(range));
}
inline void check(const std::string&, bool, Any) {}
template <class E, std::size_t N>
void check(const std::string& option, E value, const std::array<Choice<E>, N>& choices) {
  const bool known =
      std::any_of(choices.begin(), choices.end(), [&](const auto& c) { return c.value == value; });
  if (!known) refuse(option, std::to_string(static_cast<int>(value)), describe(choices));
}

inline void read(const std::string& option, std::string_view text, bool& value, Any) {
  if (text == "true" || text == "on" || text == "yes" || text == "1") {
    value = true;
  } else if (text == "false" || text == "off" || text == "no" || text == "0") {
    value = false;
  } else {
    refuse(option, text, "true or false");
  }
}

template <class T>
void read(const std::string& option, std::string_view text, T& value, const Range<T>& range) {
  T parsed{};
  if (!parse_number(text, parsed)) {
    refuse(option, text, (std::is_integral_v<T> ? "a whole number, " : "a number, ") + describe(range));
  }
  check(option, parsed, range);
  value = parsed;
}

template <class E, std::size_t N>
void read(const std::string& option, std::string_view text, E& value,
          const std::array<Choice<E>, N>& choices) {
  const auto found =
      std::find_if(choices.begin(), choices.end(), [&](const auto& c) { return c.name == text; });
  if (found == choices.end()) refuse(option, text, "one of " + describe(choices));
  value = found->value;
}

// ---- walking the options ----

/// Calls visit(full name, value, unit, help, domain, condition) for every option.
template <class C, class F>
void for_each_option(C& config, F&& visit) {
  for_each_section(config, [&](std::string_view section, auto& stage) {
    fields(stage, [&](std::string_view name, auto& value, std::string_view unit, std::string_view help,
                      const auto& domain, const Condition& condition = {}) {
      visit(std::string(section) + '.' + std::string(name), value, unit, help, domain, condition);
    });
  });
}

// ---- which options are read ----

/// An option, its value, and the condition under which it is read.
struct Read {
  std::string option;
  std::string value;
  Condition condition;
};

template <class C>
std::vector<Read> reads_of(const C& config) {
  std::vector<Read> all;
  C copy = config;  // fields() takes a non-const reference
  for_each_option(copy, [&](std::string name, const auto& value, std::string_view, std::string_view,
                            const auto& domain, const Condition& condition) {
    all.push_back({std::move(name), write(value, domain), condition});
  });
  return all;
}

inline const Read& find(const std::vector<Read>& all, std::string_view option) {
  return *std::find_if(all.begin(), all.end(), [&](const Read& read) { return read.option == option; });
}

inline std::string_view section_of(std::string_view option) {
  return option.substr(0, option.find('.'));
}

/// The first unmet condition that keeps the option from being read; nullptr if there is none. Conditions on
/// options outside of `sections` are ignored (empty: none are outside).
inline const Condition* unmet(const std::vector<Read>& all, const Read& option,
                              const std::vector<std::string>& sections) {
  const Condition& condition = option.condition;
  if (condition.option.empty()) return nullptr;
  if (!sections.empty() &&
      std::find(sections.begin(), sections.end(), section_of(condition.option)) == sections.end())
    return nullptr;
  const Read& required = find(all, condition.option);
  if (const Condition* before = unmet(all, required, sections)) return before;
  return (required.value == condition.value) == condition.equal ? nullptr : &condition;
}

inline std::string describe(const Condition& condition) {
  if (condition.option.empty()) return {};
  return std::string(condition.option) + (condition.equal ? "=" : "!=") + std::string(condition.value);
}

// ---- config.hpp, for any configuration ----

template <class C>
std::vector<OptionInfo> options_of(const C& config) {
  std::vector<OptionInfo> all;
  const std::vector<Read> reads = reads_of(config);
  C copy = config;  // fields() takes a non-const reference
  for_each_option(copy, [&](std::string name, const auto& value, std::string_view unit, std::string_view help,
                            const auto& domain, const Condition& condition) {
    const bool active = unmet(reads, reads[all.size()], {}) == nullptr;
    all.push_back({std::move(name), type_name(value), write(value, domain), std::string(unit),
                   domain_of(value, domain), std::string(help), describe(condition), active});
  });
  return all;
}

template <class C>
void require_active_of(const C& config, std::string_view name, const std::vector<std::string>& sections) {
  const std::vector<Read> reads = reads_of(config);
  const Condition* const condition = unmet(reads, find(reads, name), sections);
  if (condition == nullptr) return;
  const std::string option(condition->option);
  const std::string wanted = condition->equal ? option + "=" + std::string(condition->value) : option;
  throw Error(std::string(name) + " has no effect with " + option + "=" +
              find(reads, condition->option).value + "; set " + wanted + " first");
}

/// Sets the option of this name; false if there is none.
template <class C>
bool set_known(C& config, std::string_view name, std::string_view value) {
  bool found = false;
  for_each_option(config, [&](const std::string& option, auto& current, std::string_view, std::string_view,
                              const auto& domain, const Condition&) {
    if (option != name) return;
    found = true;
    read(option, value, current, domain);
  });
  return found;
}

[[noreturn]] inline void refuse_unknown(std::string_view name, const std::vector<OptionInfo>& known) {
  std::vector<std::string> names;
  names.reserve(known.size());
  for (const OptionInfo& option : known) names.push_back(option.name);
  const std::string close = nearest(name, names);
  throw Error("unknown option '" + std::string(name.substr(0, 80)) + "'" +
              (close.empty() ? "; cairn config lists them" : ", did you mean '" + close + "'?"));
}

template <class C>
void check_ranges(const C& config) {
  C copy = config;
  for_each_option(copy, [](const std::string& name, const auto& value, std::string_view, std::string_view,
                           const auto& domain, const Condition&) { check(name, value, domain); });
}

}  // namespace cairn::option_walk
