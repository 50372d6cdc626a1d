// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/core/parallel.hpp>
#include <cairn/stereo/flatness.hpp>
#include <cairn/stereo/flatness_kernels.hpp>
#include <cassert>

namespace cairn {

Image<Reject> reject_flat(const Matches& matches, const FlatnessConfig& config, const Exec& exec) {
  const Size size = matches.best.size();
  if (config.threshold < 0) return Image<Reject>(size, Reject::none, exec.pool);
  assert(matches.mean_cost.size() == size && matches.cost.size() == size);
  Image<Reject> verdict(size, exec.pool);
  const kernels::FlatnessKernels& run = kernels::flatness_kernels(exec);
  parallel_for(exec, size.height, 64, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      run.compare_with_mean(matches.cost.row(y), matches.mean_cost.row(y), size.width, config.threshold,
                            verdict.row(y));
    }
  });
  return verdict;
}

}  // namespace cairn
