// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/core/parallel.hpp>
#include <cairn/disparity/left_right.hpp>
#include <cassert>
#include <cmath>
#include <cstdlib>

namespace cairn {
namespace {

constexpr int kGrain = 32;  // rows

int row_of_match(const Matches& matches, int x, int y) {
  return matches.row_offset.empty() ? y : y + matches.row_offset(x, y);
}

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

/// What the left winners say about the right image: each right pixel gets the disparity of the cheapest left
/// pixel that claims it. Rows of the right image are independent: each looks up the left rows that may point
/// at it.
Image<std::int16_t> vote(const Matches& matches, const Exec& exec) {
  const Size size = matches.best.size();
  const int band = largest_row_offset(matches);
  Image<std::int16_t> winner(size, kNoMatch, exec.pool);
  Image<float> least(size, kNoCost, exec.pool);
  parallel_for(exec, size.height, kGrain, [&](int first, int last) {
    for (int right_y = first; right_y < last; ++right_y) {
      std::int16_t* const won = winner.row(right_y);
      float* const paid = least.row(right_y);
      for (int y = std::max(0, right_y - band); y <= std::min(size.height - 1, right_y + band); ++y) {
        const std::int16_t* const best = matches.best.row(y);
        const float* const cost = matches.cost.row(y);
        for (int x = 0; x < size.width; ++x) {
          if (best[x] == kNoMatch || row_of_match(matches, x, y) != right_y) continue;
          const int right_x = x - best[x];
          const bool wins = cost[x] < paid[right_x] || (cost[x] == paid[right_x] && best[x] < won[right_x]);
          if (wins || won[right_x] == kNoMatch) {
            won[right_x] = best[x];
            paid[right_x] = cost[x];
          }
        }
      }
    }
  });
  return winner;
}

Image<Reject> compare(const Matches& matches, View<const std::int16_t> right, int max_diff,
                      const Exec& exec) {
  const Size size = matches.best.size();
  Image<Reject> verdict(size, exec.pool);
  parallel_for(exec, size.height, kGrain, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      const std::int16_t* const best = matches.best.row(y);
      Reject* const out = verdict.row(y);
      for (int x = 0; x < size.width; ++x) {
        if (best[x] == kNoMatch) {
          out[x] = Reject::none;
          continue;
        }
        const int back = right(x - best[x], row_of_match(matches, x, y));
        out[x] = std::abs(best[x] - back) <= max_diff ? Reject::none : Reject::left_right;
      }
    }
  });
  return verdict;
}

}  // namespace

Image<Reject> reject_inconsistent(const Matches& matches, const LeftRightConfig& config, const Exec& exec) {
  if (config.max_diff < 0) return Image<Reject>(matches.best.size(), Reject::none, exec.pool);
  const int max_diff = static_cast<int>(std::floor(config.max_diff));  // winners are whole pixels
  if (config.method == LeftRightMethod::vote) {
    const Image<std::int16_t> voted = vote(matches, exec);
    return compare(matches, voted, max_diff, exec);
  }
  assert(matches.best_right.size() == matches.best.size());
  return compare(matches, matches.best_right, max_diff, exec);
}

}  // namespace cairn
