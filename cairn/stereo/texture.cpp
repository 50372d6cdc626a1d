// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/core/parallel.hpp>
#include <cairn/image/texture.hpp>
#include <cairn/stereo/disparity_map_kernels.hpp>
#include <cairn/stereo/texture.hpp>

namespace cairn {

Image<Reject> reject_textureless(View<const Gray> left, const TextureConfig& config, const Exec& exec) {
  if (config.threshold < 0) return Image<Reject>(left.size(), Reject::none, exec.pool);
  const Image<std::uint8_t> low = lacks_texture(left, {config.window_size, config.threshold}, exec);
  Image<Reject> verdict(left.size(), exec.pool);
  const kernels::DisparityMapKernels& run = kernels::disparity_map_kernels(exec);
  parallel_for(exec, left.height(), 64, [&](int first, int last) {
    for (int y = first; y < last; ++y)
      run.reject_where(low.row(y), left.width(), Reject::no_texture, verdict.row(y));
  });
  return verdict;
}

}  // namespace cairn
