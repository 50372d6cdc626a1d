// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/error.hpp>
#include <charconv>
#include <string>

namespace cairn::lab {

/// Throws Error unless `word` is an integer above 0.
inline int positive_number(const std::string& word) {
  int value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size() || value < 1) {
    throw Error("found '" + word + "', expected a positive number");
  }
  return value;
}

}  // namespace cairn::lab
