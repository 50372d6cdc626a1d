// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// No include guard: compiled once for each target.
namespace cairn::kernels::CAIRN_KERNEL_TARGET {
namespace {

inline void compare_with_mean(const float* cost, const float* mean, int width, float threshold,
                              Reject* CAIRN_RESTRICT verdict) {
  for (int x = 0; x < width; ++x) {
    const bool shallow = !(mean[x] > 0) | ((mean[x] - cost[x]) / mean[x] < threshold);
    verdict[x] = (shallow & (cost[x] < kNoCost)) ? Reject::flat : Reject::none;
  }
}

inline constexpr FlatnessKernels kFlatnessKernels{compare_with_mean};

}  // namespace
}  // namespace cairn::kernels::CAIRN_KERNEL_TARGET
