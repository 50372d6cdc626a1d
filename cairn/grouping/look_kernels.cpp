// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// Compiles look_kernels-inl.hpp once for plain C++ and once for each of Highway's targets, and lists what
// there is. The loops are the same; what Highway adds is the switch of the instruction set.
#include <array>
#include <bit>
#include <cairn/core/target.hpp>
#include <cairn/grouping/look_kernels.hpp>
#include <cstdint>
#include <cstring>

#if defined(__GNUC__)
#define CAIRN_RESTRICT __restrict__
#else
#define CAIRN_RESTRICT
#endif

#if CAIRN_WITH_HWY
#include <cairn/core/highway_targets.hpp>
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cairn/grouping/look_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#if HWY_TARGET != HWY_EMU128 && HWY_TARGET != HWY_SCALAR
#define CAIRN_KERNEL_TARGET HWY_NAMESPACE
HWY_BEFORE_NAMESPACE();
#include <cairn/grouping/look_kernels-inl.hpp>
HWY_AFTER_NAMESPACE();
#undef CAIRN_KERNEL_TARGET
#endif
#endif

#if !CAIRN_WITH_HWY || HWY_ONCE
#define CAIRN_KERNEL_TARGET plain_kernels
#include <cairn/grouping/look_kernels-inl.hpp>

#include <cairn/core/of_target.hpp>

namespace cairn::kernels {

const LookKernels* look_kernels(Target target) {
  CAIRN_OF_TARGET(target, kLookKernels)
}

const LookKernels& look_kernels(const Exec& exec) {
  return *look_kernels(active_target(exec));
}

}  // namespace cairn::kernels
#endif
