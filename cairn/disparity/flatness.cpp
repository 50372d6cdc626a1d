// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/core/parallel.hpp>
#include <cairn/disparity/flatness.hpp>
#include <cassert>

namespace cairn {

Image<Reject> reject_flat(const Matches& matches, const FlatnessConfig& config, const Exec& exec) {
  const Size size = matches.best.size();
  if (config.threshold < 0) return Image<Reject>(size, Reject::none, exec.pool);
  assert(matches.mean_cost.size() == size && matches.cost.size() == size);
  Image<Reject> verdict(size, exec.pool);
  parallel_for(exec, size.height, 64, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      const float* const cost = matches.cost.row(y);
      const float* const mean = matches.mean_cost.row(y);
      Reject* const out = verdict.row(y);
      for (int x = 0; x < size.width; ++x) {
        const bool shallow = !(mean[x] > 0) | ((mean[x] - cost[x]) / mean[x] < config.threshold);
        out[x] = (shallow & (cost[x] < kNoCost)) ? Reject::flat : Reject::none;
      }
    }
  });
  return verdict;
}

}  // namespace cairn
