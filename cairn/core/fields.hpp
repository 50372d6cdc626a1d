// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cstdint>
#include <limits>
#include <string_view>
#include <vector>

/// The vocabulary of a config's fields() function. Each stage's header has, beside its config struct,
///
///     template <class V> void fields(LeftRightConfig& c, V&& v) {
///       v("max_diff", c.max_diff, "px", "largest left-right disagreement", off_or(0.0F, 64.0F));
///     }
///
/// and everything else that knows about options (command line, config file, validation, reference page,
/// Python) visits it. Field types: bool, int, float, an enum with choices(), std::vector<PointPair>.
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

/// No further limit: for bool, for points.
struct Any {};

/// A point of the scene seen in both images, in px; the hand-given evidence for a ground.
struct PointPair {
  float x_left = 0;
  float y_left = 0;
  float x_right = 0;
  float y_right = 0;
  friend bool operator==(const PointPair&, const PointPair&) = default;
};

}  // namespace cairn
