// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// No include guard: compiled once for each target.
namespace cairn::kernels::CAIRN_KERNEL_TARGET {
namespace {

/// The matched right pixel of each left pixel, `none` without a match.
inline void find_partners(const std::int16_t* best, int width, int none,
                          std::int32_t* CAIRN_RESTRICT partners) {
  const auto count = static_cast<std::uint32_t>(width);
  for (int x = 0; x < width; ++x) {
    const int partner = x - best[x];
    const bool inside = static_cast<std::uint32_t>(partner) < count;
    partners[x] = (inside & (best[x] != kNoMatch)) ? partner : none;
  }
}

/// `difference(x)`: between the disparity of a left pixel and that of its right partner.
template <class Difference>
inline void judge_differences(const std::int16_t* best, int width, int max_diff, Difference difference,
                              Reject* CAIRN_RESTRICT verdict) {
  for (int x = 0; x < width; ++x) {
    const bool comes_back = (std::abs(difference(x)) <= max_diff) | (best[x] == kNoMatch);
    verdict[x] = comes_back ? Reject::none : Reject::left_right;
  }
}

inline constexpr int kVotes = 256;  // left pixels at a time: their claims stay in the nearest cache

/// Two pixels may claim the same one, so this loop is scalar, but it is a minimum of two numbers only; pixels
/// without a partner claim an entry beyond the row. So the time does not depend on the image content.
inline void cast_votes(const std::int32_t* partners, const float* cost, int begin, int count,
                       Claim* CAIRN_RESTRICT least) {
  Claim own[kVotes];
  for (int i = 0; i < count; ++i) own[i] = claim_of(cost[i], begin + i);
#pragma GCC unroll 4
  for (int i = 0; i < count; ++i) {
    const Claim claim = own[i];
    const Claim known = least[partners[i]];
    least[partners[i]] = claim < known ? claim : known;
  }
}

inline void compare_with_votes(const std::int16_t* best, const float* cost, int width, int max_diff,
                               std::int32_t* CAIRN_RESTRICT partners, Claim* CAIRN_RESTRICT claims,
                               Reject* CAIRN_RESTRICT verdict) {
  std::fill_n(claims, width + 1, kNoClaim);
  find_partners(best, width, width, partners);
  for (int x = 0; x < width; x += kVotes)
    cast_votes(partners + x, cost + x, x, std::min(kVotes, width - x), claims);
  for (int x = 0; x < width; x += kVotes) {
    const int count = std::min(kVotes, width - x);
    std::int32_t claimants[kVotes];
    for (int i = 0; i < count; ++i) claimants[i] = claimant(claims[partners[x + i]]);
    // For pixels that claim the same one, disparities differ as much as positions.
    judge_differences(
        best + x, count, max_diff, [&](int i) { return x + i - claimants[i]; }, verdict + x);
  }
}

inline void compare_with_right(const std::int16_t* best, const std::int16_t* best_right, int width,
                               int max_diff, std::int32_t* CAIRN_RESTRICT partners,
                               std::int32_t* CAIRN_RESTRICT back, Reject* CAIRN_RESTRICT verdict) {
  find_partners(best, width, 0, partners);
  for (int x = 0; x < width; ++x) back[x] = best_right[partners[x]];
  judge_differences(
      best, width, max_diff, [best, back](int x) { return best[x] - back[x]; }, verdict);
}

inline constexpr LeftRightKernels kLeftRightKernels{compare_with_votes, compare_with_right};

}  // namespace
}  // namespace cairn::kernels::CAIRN_KERNEL_TARGET
