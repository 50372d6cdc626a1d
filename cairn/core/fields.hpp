// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

/// The vocabulary of a config's fields() function. Each stage's header has, beside its config struct,
///
///     template <class V> void fields(LeftRightConfig& c, V&& v) {
///       v("max_diff", c.max_diff, "px", "largest left-right disagreement", off_or(0.0F, 64.0F));
///     }
///
/// and everything else that knows about options (command line, config file, validation, reference page,
/// tuning, Python) visits it. Field types: bool, int, float, an enum with choices(). A field that is read
/// only under a condition says so behind its values:
///
///       v("method", c.method, "", "which winner", kLeftRightMethods, unless("left_right.max_diff", "-1"));
///
/// A member that fields() does not visit is no option: a constant of the method, or a fact of the input.
namespace cairn {

/// What values a number may take: [lowest, highest], or −1 where that switches the stage off.
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
/// Like range(), and −1 switches the stage off.
template <class T>
constexpr Range<T> off_or(T lowest, T highest) {
  return {lowest, highest, true, false};
}
constexpr Range<int> odd_range(int lowest, int highest) {
  return {lowest, highest, false, true};
}

/// One name of an enum's value, as users write it.
template <class E>
struct Choice {
  std::string_view name;
  E value;
};
// Clang tells it from C++20's aggregates only from version 17 on.
template <class E>
Choice(std::string_view, E) -> Choice<E>;

/// The name of a value; "?" for one that is none of the choices.
template <class E, std::size_t N>
std::string choice_name(E value, const std::array<Choice<E>, N>& choices) {
  for (const Choice<E>& choice : choices) {
    if (choice.value == value) return std::string(choice.name);
  }
  return "?";
}

/// No further limit: for bool.
struct Any {};

/// An option is read only while another one has a value, or has another value than that, and is itself read.
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
