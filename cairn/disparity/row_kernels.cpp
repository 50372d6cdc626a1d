// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// Compiles row_kernels-inl.hpp once for plain C++ and once for each of Highway's targets, and lists what
// there is. The loops are the same; what Highway adds is the switch of the instruction set.
#include <algorithm>
#include <bit>
#include <cairn/core/target.hpp>
#include <cairn/disparity/reject.hpp>
#include <cairn/disparity/row_kernels.hpp>
#include <cairn/image/gradient.hpp>
#include <cairn/matching/match.hpp>
#include <cmath>
#include <cstdlib>
#include <limits>

#if defined(__GNUC__)
#define CAIRN_RESTRICT __restrict__
#else
#define CAIRN_RESTRICT
#endif

#if CAIRN_WITH_HWY
#include <cairn/core/highway_targets.hpp>
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cairn/disparity/row_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#if HWY_TARGET != HWY_EMU128 && HWY_TARGET != HWY_SCALAR
#define CAIRN_KERNEL_TARGET HWY_NAMESPACE
HWY_BEFORE_NAMESPACE();
#include <cairn/disparity/row_kernels-inl.hpp>
HWY_AFTER_NAMESPACE();
#undef CAIRN_KERNEL_TARGET
#endif
#endif

#if !CAIRN_WITH_HWY || HWY_ONCE
#define CAIRN_KERNEL_TARGET plain_kernels
#include <cairn/disparity/row_kernels-inl.hpp>

#include <cairn/core/of_target.hpp>

namespace cairn::kernels {

const RowKernels* row_kernels(Target target) {
  CAIRN_OF_TARGET(target, kRowKernels)
}

const RowKernels& row_kernels(const Exec& exec) {
  return *row_kernels(active_target(exec));
}

}  // namespace cairn::kernels
#endif
