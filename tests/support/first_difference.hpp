// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <bit>
#include <cairn/core/image.hpp>
#include <cairn/stereo/match.hpp>
#include <cstddef>
#include <string>

namespace cairn {

/// A description of the first difference in bits between two images; "" if they are equal.
template <class T>
std::string first_difference(const Image<T>& expected, const Image<T>& got) {
  using Bits = std::array<std::byte, sizeof(T)>;
  if (expected.size() != got.size()) return "sizes " + text(expected.size()) + " and " + text(got.size());
  for (int y = 0; y < expected.height(); ++y) {
    for (int x = 0; x < expected.width(); ++x) {
      if (std::bit_cast<Bits>(expected(x, y)) == std::bit_cast<Bits>(got(x, y))) continue;
      return "(" + std::to_string(x) + ", " + std::to_string(y) + "): expected " +
             std::to_string(expected(x, y)) + ", got " + std::to_string(got(x, y));
    }
  }
  return {};
}

inline std::string first_difference(const Matches& expected, const Matches& got) {
  std::string found;
  const auto compare = [&](const char* map, const auto& a, const auto& b) {
    const std::string difference = first_difference(a, b);
    if (!difference.empty()) found += std::string(map) + " " + difference + "; ";
  };
  compare("best", expected.best, got.best);
  compare("best_right", expected.best_right, got.best_right);
  compare("row_offset", expected.row_offset, got.row_offset);
  compare("cost", expected.cost, got.cost);
  compare("runner_up", expected.runner_up, got.runner_up);
  compare("mean_cost", expected.mean_cost, got.mean_cost);
  compare("cost_before", expected.cost_before, got.cost_before);
  compare("cost_after", expected.cost_after, got.cost_after);
  return found;
}

}  // namespace cairn
