// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// No include guard: compiled once for each target.
namespace cairn::kernels::CAIRN_KERNEL_TARGET {
namespace {

inline void compare_with_runner_up(const float* cost, const float* runner_up, int width, float share,
                                   Reject* CAIRN_RESTRICT verdict) {
  // kNoCost needs no special case: infinity, and NaN for a ratio of 100, compare as not less.
  for (int x = 0; x < width; ++x)
    verdict[x] = runner_up[x] * share < cost[x] * 100.0F ? Reject::not_unique : Reject::none;
}

inline constexpr UniquenessKernels kUniquenessKernels{compare_with_runner_up};

}  // namespace
}  // namespace cairn::kernels::CAIRN_KERNEL_TARGET
