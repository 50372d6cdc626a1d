// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <charconv>
#include <string>
#include <type_traits>

namespace cairn {

/// The shortest text that reads as this number.
template <class Number>
requires std::is_arithmetic_v<Number> std::string shortest_text(Number value) {
  std::array<char, 64> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

}  // namespace cairn
