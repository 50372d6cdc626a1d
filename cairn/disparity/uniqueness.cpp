// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/core/parallel.hpp>
#include <cairn/disparity/uniqueness.hpp>
#include <cassert>

namespace cairn {

Image<Reject> reject_ambiguous(const Matches& matches, const UniquenessConfig& config, const Exec& exec) {
  const Size size = matches.best.size();
  if (config.ratio < 0) return Image<Reject>(size, Reject::none, exec.pool);
  assert(matches.runner_up.size() == size && matches.cost.size() == size);
  const float share = 100.0F - config.ratio;
  Image<Reject> verdict(size, exec.pool);
  parallel_for(exec, size.height, 64, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      const float* const cost = matches.cost.row(y);
      const float* const runner_up = matches.runner_up.row(y);
      Reject* const out = verdict.row(y);
      // kNoCost needs no case of its own: infinity, and NaN for a ratio of 100, are never less than anything.
      for (int x = 0; x < size.width; ++x) {
        out[x] = runner_up[x] * share < cost[x] * 100.0F ? Reject::not_unique : Reject::none;
      }
    }
  });
  return verdict;
}

}  // namespace cairn
