// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/core/parallel.hpp>
#include <cairn/stereo/subpixel.hpp>
#include <cairn/stereo/subpixel_kernels.hpp>

namespace cairn {

Image<float> refine_subpixel(const Matches& matches, const SubpixelConfig& config, const Exec& exec) {
  Image<float> refined(matches.best.size(), exec.pool);
  const bool refines = config.method != SubpixelMethod::none && !matches.cost_before.empty();
  const kernels::SubpixelKernels& run = kernels::subpixel_kernels(exec);
  parallel_for(exec, refined.height(), 16, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      run.refine_row(config.method, {matches.best.row(y), refines ? matches.cost_before.row(y) : nullptr,
                                     matches.cost.row(y), refines ? matches.cost_after.row(y) : nullptr,
                                     refined.width(), refined.row(y)});
    }
  });
  return refined;
}

}  // namespace cairn
