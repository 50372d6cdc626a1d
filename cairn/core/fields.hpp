// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

/// The vocabulary of a config's fields() function. Each stage's header has, next to its config struct,
///
///     template <class V> void fields(LeftRightConfig& c, V&& v) {
///       v("max_diff", c.max_diff, "px", "largest left-right disagreement", off_or(0.0F, 64.0F));
///     }
///
/// and all users of options (command line, config file, validation, reference page, tuning, Python) visit it.
/// Field types: bool, int, float, an enum with choices(). A field that is read only under a condition names
/// the condition after its values:
///
///       v("method", c.method, "", "which winner", kLeftRightMethods, unless("left_right.max_diff", "-1"));
///
/// A member that fields() does not visit is not an option but a constant of the method or a property of the
/// input.
namespace cairn {

/// The allowed values of a number: [lowest, highest], and −1 if that switches the stage off.
template <class T>
struct Range {
  T lowest = std::numeric_limits<T>::lowest();
  T highest = std::numeric_limits<T>::max();
  bool minus_one_is_off = false;
  bool odd_only = false;
};

template <class T>
constexpr Range<T> range(T lowest, T highest) {
  return {lowest, highest, false, false};
}
/// Like range(), but −1 switches the stage off.
template <class T>
constexpr Range<T> off_or(T lowest, T highest) {
  return {lowest, highest, true, false};
}
constexpr Range<int> odd_range(int lowest, int highest) {
  return {lowest, highest, false, true};
}

/// One value of an enum and its name in config files and on the command line.
template <class E>
struct Choice {
  std::string_view name;
  E value;
};
// Clang deduces aggregates, as C++20 has it, only from version 17 on.
template <class E>
Choice(std::string_view, E) -> Choice<E>;

/// The name of a value; "?" if it is not among the choices.
template <class E, std::size_t N>
std::string choice_name(E value, const std::array<Choice<E>, N>& choices) {
  for (const Choice<E>& choice : choices) {
    if (choice.value == value) return std::string(choice.name);
  }
  return "?";
}

/// No limit: for bool.
struct Any {};

/// An option is read only while another option is read and has (`equal`) or has not a certain value.
struct Condition {
  std::string_view option{};  // "match.method"; empty: always read
  std::string_view value{};   // as set() reads it
  bool equal = true;
};
constexpr Condition when(std::string_view option, std::string_view value) {
  return {option, value, true};
}
constexpr Condition unless(std::string_view option, std::string_view value) {
  return {option, value, false};
}

}  // namespace cairn
