// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/core/parallel.hpp>
#include <cairn/regions/gradient_threshold.hpp>
#include <cmath>

namespace cairn {
namespace {

constexpr int kGrain = 16;  // rows

}  // namespace

void level_below(double threshold, Image<std::uint16_t>& gradient, const Exec& exec) {
  // Gradients are integers, so `< threshold` equals `< ceil(threshold)`.
  const auto least = static_cast<std::uint16_t>(std::clamp(std::ceil(threshold), 0.0, double{UINT16_MAX}));
  if (least == 0) return;
  parallel_for(exec, gradient.height(), kGrain, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      std::uint16_t* const row = gradient.row(y);
      for (int x = 0; x < gradient.width(); ++x) {
        const std::uint16_t value = row[x];
        row[x] = value < least ? std::uint16_t{0} : value;
      }
    }
  });
}

}  // namespace cairn
