// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <bit>
#include <cairn/core/parallel.hpp>
#include <cairn/disparity/left_right.hpp>
#include <cairn/matching/kernels.hpp>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <vector>

namespace cairn {
namespace {

constexpr int kGrain = 32;  // rows

/// How many rows up or down a match may lie.
int largest_row_offset(const Matches& matches) {
  int largest = 0;
  for (int y = 0; y < matches.row_offset.height(); ++y) {
    const std::int8_t* offset = matches.row_offset.row(y);
    for (int x = 0; x < matches.row_offset.width(); ++x)
      largest = std::max(largest, std::abs(int{offset[x]}));
  }
  return largest;
}

/// A left winner's claim to a right pixel as one number: of two the smaller wins, by its cost, then by its
/// disparity. Costs are not negative, so that their bits are in their order; the sign that a zero may have is
/// left out.
using Claim = std::uint64_t;
constexpr Claim kNoClaim = ~Claim{0};

Claim claim_of(float cost, std::int16_t disparity) {
  constexpr std::uint32_t kNoSign = 0x7FFFFFFF;
  return Claim{std::bit_cast<std::uint32_t>(cost) & kNoSign} << 16 |
         static_cast<std::uint16_t>(disparity - kNoMatch);
}
std::int32_t disparity_of(Claim claim) {
  return static_cast<std::int32_t>(claim & 0xFFFF) + kNoMatch;
}

/// What the left winners say about a row of the right image: each pixel goes to the cheapest left one that
/// claims it. Rows up to `band` away may point at it. One entry of `claims` is to spare, before the first,
/// for the left pixels that claim none: so nothing is decided by a jump.
void vote_row(const Matches& matches, int right_y, int band, Claim* claims) {
  const auto [width, height] = matches.best.size();
  std::fill_n(claims - 1, width + 1, kNoClaim);
  for (int y = std::max(0, right_y - band); y <= std::min(height - 1, right_y + band); ++y) {
    const std::int16_t* const best = matches.best.row(y);
    const float* const cost = matches.cost.row(y);
    const std::int8_t* const row = matches.row_offset.empty() ? nullptr : matches.row_offset.row(y);
    for (int x = 0; x < width; ++x) {
      const bool claims_here = (best[x] != kNoMatch) & (row == nullptr || y + row[x] == right_y);
      Claim& claim = claims[claims_here ? x - best[x] : -1];
      claim = std::min(claim, claim_of(cost[x], best[x]));
    }
  }
}

/// Where row_offset tells which row a match lies in. `back(x, y)`: the disparity of a right pixel.
template <class Back>
void compare_across_rows(const Matches& matches, int y, int max_diff, const Back& back, Reject* verdict) {
  const std::int16_t* const best = matches.best.row(y);
  for (int x = 0; x < matches.best.width(); ++x) {
    const bool agrees = best[x] == kNoMatch ||
                        std::abs(best[x] - back(x - best[x], y + matches.row_offset(x, y))) <= max_diff;
    verdict[x] = agrees ? Reject::none : Reject::left_right;
  }
}

Image<Reject> compare_with_votes(const Matches& matches, int max_diff, const Exec& exec) {
  const Size size = matches.best.size();
  const int band = largest_row_offset(matches);
  const auto width = static_cast<std::size_t>(size.width);
  const auto look_back = kernels::match_kernels(exec).look_back;
  Image<Reject> verdict(size, exec.pool);
  parallel_for(exec, size.height, kGrain, [&](int first, int last) {
    // The rows of votes that a left row may look into: its own and `band` up and down.
    const int kept = 2 * band + 1;
    std::vector<Claim> memory(static_cast<std::size_t>(kept) * (width + 1));
    std::vector<std::int32_t> back(width);
    const auto claims_of = [&](int right_y) {
      return memory.data() + static_cast<std::size_t>(right_y % kept) * (width + 1) + 1;
    };
    const auto vote = [&](int right_y) { vote_row(matches, right_y, band, claims_of(right_y)); };
    for (int y = std::max(0, first - band); y < std::min(first + band, size.height); ++y) vote(y);
    for (int y = first; y < last; ++y) {
      if (y + band < size.height) vote(y + band);
      if (matches.row_offset.empty()) {
        std::transform(claims_of(y), claims_of(y) + width, back.data(), disparity_of);
        look_back(matches.best.row(y), back.data(), size.width, max_diff, verdict.row(y));
      } else {
        const auto voted = [&](int x, int right_y) { return disparity_of(claims_of(right_y)[x]); };
        compare_across_rows(matches, y, max_diff, voted, verdict.row(y));
      }
    }
  });
  return verdict;
}

Image<Reject> compare_with_right(const Matches& matches, int max_diff, const Exec& exec) {
  assert(matches.best_right.size() == matches.best.size());
  const Size size = matches.best.size();
  const auto look_back = kernels::match_kernels(exec).look_back;
  Image<Reject> verdict(size, exec.pool);
  parallel_for(exec, size.height, kGrain, [&](int first, int last) {
    std::vector<std::int32_t> back(static_cast<std::size_t>(size.width));
    for (int y = first; y < last; ++y) {
      if (matches.row_offset.empty()) {
        std::copy_n(matches.best_right.row(y), size.width, back.data());
        look_back(matches.best.row(y), back.data(), size.width, max_diff, verdict.row(y));
      } else {
        const auto right = [&](int x, int right_y) { return matches.best_right(x, right_y); };
        compare_across_rows(matches, y, max_diff, right, verdict.row(y));
      }
    }
  });
  return verdict;
}

}  // namespace

Image<Reject> reject_inconsistent(const Matches& matches, const LeftRightConfig& config, const Exec& exec) {
  if (config.max_diff < 0) return Image<Reject>(matches.best.size(), Reject::none, exec.pool);
  const int max_diff = static_cast<int>(std::floor(config.max_diff));  // winners are whole pixels
  return config.method == LeftRightMethod::vote ? compare_with_votes(matches, max_diff, exec)
                                                : compare_with_right(matches, max_diff, exec);
}

}  // namespace cairn
