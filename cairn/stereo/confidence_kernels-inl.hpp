// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// No include guard: compiled once for each target.
#include <cairn/core/sum_along-inl.hpp>

namespace cairn::kernels::CAIRN_KERNEL_TARGET {
namespace {

inline constexpr HolesAndJumps kHole = 1;
inline constexpr HolesAndJumps kIsJump = 256;

inline void mark_jumps(const float* here, const float* below, int width, float jump,
                       HolesAndJumps* CAIRN_RESTRICT marks) {
  const auto mark = [&](int x, int right) {
    const float d = here[x];
    // Comparisons with NaN are false. Both are always made: a branch would prevent vector code.
    const int along = std::abs(d - here[right]) > jump ? kIsJump : 0;
    const int down = std::abs(d - below[x]) > jump ? kIsJump : 0;
    return static_cast<HolesAndJumps>((d == d ? 0 : kHole) | along | down);
  };
  for (int x = 0; x + 1 < width; ++x) marks[x] = mark(x, x + 1);
  marks[width - 1] = mark(width - 1, width - 1);
}

inline void add_counts(const HolesAndJumps* more, int width, HolesAndJumps* CAIRN_RESTRICT counts) {
  for (int x = 0; x < width; ++x) counts[x] = static_cast<HolesAndJumps>(counts[x] + more[x]);
}

inline void remove_counts(const HolesAndJumps* less, int width, HolesAndJumps* CAIRN_RESTRICT counts) {
  for (int x = 0; x < width; ++x) counts[x] = static_cast<HolesAndJumps>(counts[x] - less[x]);
}

inline void sum_counts(const HolesAndJumps* columns, int width, int window, HolesAndJumps* blocks,
                       HolesAndJumps* sums) {
  sum_along(columns, width, window, blocks, sums);
}

/// 2^t for |t| ≤ kMaxExponent, with a relative error of 2·10⁻⁷; in arithmetic that is the same on every
/// platform, unlike that of libraries.
inline float power_of_two(float t) {
  constexpr int kOffset = 64;
  const int whole = static_cast<int>(t + kOffset) - kOffset;
  const float f = t - static_cast<float>(whole);
  const float fraction =
      1.0F + f * (0.6931514F + f * (0.2401641F + f * (0.0558005F + f * (0.00901663F + f * 0.00186721F))));
  return std::bit_cast<float>((whole + 127) << 23) * fraction;
}

inline constexpr float kMinMean = 1e-6F;  // avoids a division by 0 if all costs are 0
inline constexpr float kMaxExponent = 30.0F;

inline float logistic(float log_odds) {
  constexpr float kLog2OfE = 1.44269504F;
  // In this order of arguments NaN, of pixels without a match, is clamped too.
  const float exponent = std::max(-kMaxExponent, std::min(kMaxExponent, -kLog2OfE * log_odds));
  return 1.0F / (1.0F + power_of_two(exponent));
}

inline void judge_confidence(const ConfidenceRow& given, int width, const ConfidenceModel& fitted,
                             float* CAIRN_RESTRICT out) {
  const ConfidenceRow row = given;
  const ConfidenceModel model = fitted;
  for (int x = 0; x < width; ++x) {
    const float inverse_mean = 1.0F / std::max(row.mean_cost[x], kMinMean);
    const float margin = std::min((row.runner_up[x] - row.cost[x]) * inverse_mean, 1.0F);
    const float cost = std::min(row.cost[x] * inverse_mean, 1.0F);
    const int counts = row.around[x];
    const float jumps = std::sqrt(static_cast<float>(counts >> 8) * row.inverse_area[x]);
    const float holes = std::sqrt(static_cast<float>(counts & 255) * row.inverse_area[x]);
    const float log_odds =
        model.bias + model.margin * margin + model.cost * cost + model.jumps * jumps + model.holes * holes;
    const float confidence = logistic(log_odds);
    const float d = row.disparity_px[x];
    out[x] = d == d ? confidence : 0.0F;  // a hole is NaN
  }
}

inline constexpr ConfidenceKernels kConfidenceKernels{mark_jumps, add_counts, remove_counts, sum_counts,
                                                      judge_confidence};

}  // namespace
}  // namespace cairn::kernels::CAIRN_KERNEL_TARGET
