// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// Compiles semi_global_kernels-inl.hpp once for plain C++ and once for each of Highway's targets, and lists
// what there is.
#include <algorithm>
#include <array>
#include <bit>
#include <cairn/matching/scratch.hpp>
#include <cairn/matching/semi_global_kernels.hpp>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#if defined(__GNUC__)
#define CAIRN_RESTRICT __restrict__
#else
#define CAIRN_RESTRICT
#endif

#if CAIRN_WITH_HWY
#include <cairn/core/highway_targets.hpp>
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cairn/matching/semi_global_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#if HWY_TARGET != HWY_EMU128 && HWY_TARGET != HWY_SCALAR
#define CAIRN_KERNEL_TARGET HWY_NAMESPACE
#define CAIRN_LANES_INLINE HWY_INLINE
#define CAIRN_LANES_ATTR HWY_ATTR
#define CAIRN_UNROLL HWY_UNROLL(16)
HWY_BEFORE_NAMESPACE();
#include <cairn/matching/byte_lanes_highway-inl.hpp>
#include <cairn/matching/lanes_highway-inl.hpp>

#include <cairn/matching/semi_global_kernels-inl.hpp>
HWY_AFTER_NAMESPACE();
#undef CAIRN_KERNEL_TARGET
#undef CAIRN_LANES_INLINE
#undef CAIRN_LANES_ATTR
#undef CAIRN_UNROLL
#endif
#endif

#if !CAIRN_WITH_HWY || HWY_ONCE
#include <cairn/matching/byte_lanes_plain.hpp>
#include <cairn/matching/lanes_plain.hpp>
namespace cairn::kernels::plain_kernels {
namespace bytes = plain_bytes;
namespace lanes = plain;
}  // namespace cairn::kernels::plain_kernels
#define CAIRN_KERNEL_TARGET plain_kernels
#define CAIRN_LANES_INLINE inline
#define CAIRN_LANES_ATTR
#define CAIRN_UNROLL
#include <cairn/matching/semi_global_kernels-inl.hpp>

#include <cairn/core/of_target.hpp>

namespace cairn::kernels {

const SemiGlobalKernels* semi_global_kernels(Target target) {
  CAIRN_OF_TARGET(target, kSemiGlobalKernels)
}

}  // namespace cairn::kernels
#endif
