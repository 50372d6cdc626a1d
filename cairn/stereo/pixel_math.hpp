// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <algorithm>
#include <cairn/image/prefilter.hpp>
#include <cmath>
#include <cstdint>

/// The last step of every operator: from the exact integer sums of a window to a float cost. One rounding per
/// operation, none fused, so every target gets the same bits. The kernels repeat these steps lane by lane.
///
/// Notation: n pixels; sums l, r of the left and right pixels; ll, rr, lr of their products.
namespace cairn::pixel_math {

inline constexpr float kNoEnergyCost = 65536.0F;  // nssd of an all-black window
inline constexpr int kPartialSums = 16;           // of mean_cost; see sum_of_partials()

/// 1/√v in float, 0 for v = 0.
inline float inverse_root(std::int64_t v) {
  return v > 0 ? 1.0F / std::sqrt(static_cast<float>(v)) : 0.0F;
}

inline float sad(std::int64_t sum) {
  return static_cast<float>(sum);
}
inline float ssd(std::int64_t sum) {
  return static_cast<float>(sum);
}
inline float zsad(std::int64_t sum) {
  return static_cast<float>(sum) * (1.0F / kMeanSteps);
}

/// (n·ssd − (l − r)²) / n
inline float zssd(std::int64_t n, std::int64_t ssd_sum, std::int64_t l_minus_r) {
  return static_cast<float>(n * ssd_sum - l_minus_r * l_minus_r) * (1.0F / static_cast<float>(n));
}
/// Takes the inverse roots of ll and rr.
inline float nssd(std::int64_t ssd_sum, float inverse_l, float inverse_r) {
  const float inverse = inverse_l * inverse_r;
  return inverse > 0 ? static_cast<float>(ssd_sum) * inverse : kNoEnergyCost;
}
/// Takes the inverse roots of n·ll − l² and n·rr − r². Clamped at 0: rounding may take a perfect match below.
inline float zncc(std::int64_t n, std::int64_t lr, std::int64_t l, std::int64_t r, float inverse_l,
                  float inverse_r) {
  return std::max(0.0F, 1.0F - static_cast<float>(n * lr - l * r) * (inverse_l * inverse_r));
}

/// Adds sixteen partial sums in a fixed order. The k-th holds the costs of candidates k, k + 16, …, so a mean
/// does not depend on the number of lanes.
inline float sum_of_partials(const float* partial) {
  float quarter[4];
  for (int i = 0; i < 4; ++i) quarter[i] = (partial[i] + partial[i + 8]) + (partial[i + 4] + partial[i + 12]);
  return (quarter[0] + quarter[2]) + (quarter[1] + quarter[3]);
}

}  // namespace cairn::pixel_math
