// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// Compiles the kernels once for plain C++ and once for each of Highway's targets, and lists what there
// is.
#include <algorithm>
#include <array>
#include <bit>
#include <cairn/core/target.hpp>
#include <cairn/matching/kernels.hpp>
#include <cairn/matching/pixel_math.hpp>
#include <cairn/matching/scratch.hpp>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <vector>

#if CAIRN_WITH_HWY
#include <cairn/core/highway_targets.hpp>
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cairn/matching/kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#if HWY_TARGET != HWY_EMU128 && HWY_TARGET != HWY_SCALAR
#define CAIRN_KERNEL_TARGET HWY_NAMESPACE
#define CAIRN_LANES_INLINE HWY_INLINE
#define CAIRN_NOINLINE HWY_NOINLINE
#define CAIRN_UNROLL HWY_UNROLL(16)
HWY_BEFORE_NAMESPACE();
// clang-format off
#include <cairn/matching/lanes_highway-inl.hpp>
#include <cairn/matching/geometry-inl.hpp>
#include <cairn/matching/winners-inl.hpp>
#include <cairn/matching/window_sums-inl.hpp>
#include <cairn/matching/pixel_rows-inl.hpp>
#include <cairn/matching/kernels-inl.hpp>
// clang-format on
HWY_AFTER_NAMESPACE();
#undef CAIRN_KERNEL_TARGET
#undef CAIRN_LANES_INLINE
#undef CAIRN_NOINLINE
#undef CAIRN_UNROLL
#endif
#endif

#if !CAIRN_WITH_HWY || HWY_ONCE
#include <cairn/matching/lanes_plain.hpp>
namespace cairn::kernels::plain_kernels {
namespace lanes = plain;
}
#define CAIRN_KERNEL_TARGET plain_kernels
#define CAIRN_LANES_INLINE inline
#define CAIRN_NOINLINE
#define CAIRN_UNROLL
// clang-format off
#include <cairn/matching/geometry-inl.hpp>
#include <cairn/matching/winners-inl.hpp>
#include <cairn/matching/window_sums-inl.hpp>
#include <cairn/matching/pixel_rows-inl.hpp>
#include <cairn/matching/kernels-inl.hpp>
// clang-format on

#include <cairn/core/of_target.hpp>

namespace cairn::kernels {

const MatchKernels* match_kernels(Target target) {
  CAIRN_OF_TARGET(target, kMatchKernels)
}

const MatchKernels& match_kernels(const Exec& exec) {
  return *match_kernels(active_target(exec));
}

}  // namespace cairn::kernels
#endif
