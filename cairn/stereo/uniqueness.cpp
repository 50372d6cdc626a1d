// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/core/parallel.hpp>
#include <cairn/stereo/uniqueness.hpp>
#include <cairn/stereo/uniqueness_kernels.hpp>
#include <cassert>

namespace cairn {

Image<Reject> reject_ambiguous(const Matches& matches, const UniquenessConfig& config, const Exec& exec) {
  const Size size = matches.best.size();
  if (config.ratio < 0) return Image<Reject>(size, Reject::none, exec.pool);
  assert(matches.runner_up.size() == size && matches.cost.size() == size);
  const kernels::UniquenessKernels& run = kernels::uniqueness_kernels(exec);
  const float share = 100.0F - config.ratio;
  Image<Reject> verdict(size, exec.pool);
  parallel_for(exec, size.height, 64, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      run.compare_with_runner_up(matches.cost.row(y), matches.runner_up.row(y), size.width, share,
                                 verdict.row(y));
    }
  });
  return verdict;
}

}  // namespace cairn
