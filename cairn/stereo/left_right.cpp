// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/core/parallel.hpp>
#include <cairn/core/scratch.hpp>
#include <cairn/stereo/left_right.hpp>
#include <cairn/stereo/left_right_kernels.hpp>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <vector>

namespace cairn {
namespace {

using kernels::Claim;

constexpr int kGrain = 32;  // rows

/// The largest row offset of a match, up or down.
int largest_row_offset(const Matches& matches) {
  int largest = 0;
  for (int y = 0; y < matches.row_offset.height(); ++y) {
    const std::int8_t* offset = matches.row_offset.row(y);
    for (int x = 0; x < matches.row_offset.width(); ++x)
      largest = std::max(largest, std::abs(int{offset[x]}));
  }
  return largest;
}

/// Votes of the left winners for a row of the right image: the cheapest left pixel claims each right pixel.
/// Left rows up to `band` away can match this row. `claims` has one extra entry at the end for left pixels
/// that match another row, so the loop has no branch.
void vote_across_rows(const Matches& matches, int right_y, int band, Claim* claims) {
  const auto [width, height] = matches.best.size();
  std::fill_n(claims, width + 1, kernels::kNoClaim);
  for (int y = std::max(0, right_y - band); y <= std::min(height - 1, right_y + band); ++y) {
    const std::int16_t* const best = matches.best.row(y);
    const float* const cost = matches.cost.row(y);
    const std::int8_t* const row = matches.row_offset.row(y);
    for (int x = 0; x < width; ++x) {
      const bool claims_here = (best[x] != kNoMatch) & (y + row[x] == right_y);
      Claim& claim = claims[claims_here ? x - best[x] : width];
      claim = std::min(claim, kernels::claim_of(cost[x], x));
    }
  }
}

/// For matches with a row_offset. `back(x, y)`: the disparity of a right pixel.
template <class Back>
void compare_across_rows(const Matches& matches, int y, int max_diff, const Back& back, Reject* verdict) {
  const std::int16_t* const best = matches.best.row(y);
  for (int x = 0; x < matches.best.width(); ++x) {
    const bool agrees = best[x] == kNoMatch ||
                        std::abs(best[x] - back(x - best[x], y + matches.row_offset(x, y))) <= max_diff;
    verdict[x] = agrees ? Reject::none : Reject::left_right;
  }
}

Image<Reject> compare_with_votes_across_rows(const Matches& matches, int max_diff, const Exec& exec) {
  const Size size = matches.best.size();
  const int band = largest_row_offset(matches);
  const auto width = static_cast<std::size_t>(size.width);
  Image<Reject> verdict(size, exec.pool);
  parallel_for(exec, size.height, kGrain, [&](int first, int last) {
    // Votes of the right rows that a left row can match: its own, and `band` up and down.
    const int kept = 2 * band + 1;
    std::vector<Claim> memory(static_cast<std::size_t>(kept) * (width + 1));
    const auto claims_of = [&](int right_y) {
      return memory.data() + static_cast<std::size_t>(right_y % kept) * (width + 1);
    };
    const auto vote = [&](int right_y) { vote_across_rows(matches, right_y, band, claims_of(right_y)); };
    const auto voted = [&](int x, int right_y) { return kernels::claimant(claims_of(right_y)[x]) - x; };
    for (int y = std::max(0, first - band); y < std::min(first + band, size.height); ++y) vote(y);
    for (int y = first; y < last; ++y) {
      if (y + band < size.height) vote(y + band);
      compare_across_rows(matches, y, max_diff, voted, verdict.row(y));
    }
  });
  return verdict;
}

Image<Reject> compare_with_votes(const Matches& matches, int max_diff, const Exec& exec) {
  if (!matches.row_offset.empty()) return compare_with_votes_across_rows(matches, max_diff, exec);
  const Size size = matches.best.size();
  const kernels::LeftRightKernels& run = kernels::left_right_kernels(exec);
  Image<Reject> verdict(size, exec.pool);
  parallel_for(exec, size.height, kGrain, [&](int first, int last) {
    Scratch<std::int32_t> partners(size.width);
    Scratch<Claim> claims(size.width + 1);
    for (int y = first; y < last; ++y) {
      run.compare_with_votes(matches.best.row(y), matches.cost.row(y), size.width, max_diff, partners.data(),
                             claims.data(), verdict.row(y));
    }
  });
  return verdict;
}

Image<Reject> compare_with_right(const Matches& matches, int max_diff, const Exec& exec) {
  assert(matches.best_right.size() == matches.best.size());
  const Size size = matches.best.size();
  const kernels::LeftRightKernels& run = kernels::left_right_kernels(exec);
  const auto right = [&](int x, int right_y) { return matches.best_right(x, right_y); };
  Image<Reject> verdict(size, exec.pool);
  parallel_for(exec, size.height, kGrain, [&](int first, int last) {
    Scratch<std::int32_t> partners(size.width);
    Scratch<std::int32_t> back(size.width);
    for (int y = first; y < last; ++y) {
      if (matches.row_offset.empty()) {
        run.compare_with_right(matches.best.row(y), matches.best_right.row(y), size.width, max_diff,
                               partners.data(), back.data(), verdict.row(y));
      } else {
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
