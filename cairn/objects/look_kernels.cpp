// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// Compiles look_kernels-inl.hpp once for plain C++ and once for each of Highway's targets, and lists what
// there is. The loops are the same; what Highway adds is the switch of the instruction set.
#include <array>
#include <bit>
#include <cairn/core/target.hpp>
#include <cairn/objects/look_kernels.hpp>
#include <cstdint>
#include <cstring>

#if defined(__GNUC__)
#define CAIRN_RESTRICT __restrict__
#else
#define CAIRN_RESTRICT
#endif

#if CAIRN_WITH_HWY
// Only what Target names; see matching/kernels.cpp.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cairn/objects/look_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#if HWY_TARGET != HWY_EMU128 && HWY_TARGET != HWY_SCALAR
#define CAIRN_KERNEL_TARGET HWY_NAMESPACE
HWY_BEFORE_NAMESPACE();
#include <cairn/objects/look_kernels-inl.hpp>
HWY_AFTER_NAMESPACE();
#undef CAIRN_KERNEL_TARGET
#endif
#endif

#if !CAIRN_WITH_HWY || HWY_ONCE
#define CAIRN_KERNEL_TARGET plain_kernels
#include <cairn/objects/look_kernels-inl.hpp>

namespace cairn::kernels {

const LookKernels* look_kernels(Target target) {
  switch (target) {
    case Target::scalar:
      return &plain_kernels::kLookKernels;
#if CAIRN_WITH_HWY
#if HWY_TARGETS & HWY_SSE4
    case Target::sse4:
      return &N_SSE4::kLookKernels;
#endif
#if HWY_TARGETS & HWY_AVX2
    case Target::avx2:
      return &N_AVX2::kLookKernels;
#endif
#if HWY_TARGETS & HWY_AVX3
    case Target::avx512:
      return &N_AVX3::kLookKernels;
#endif
#if HWY_TARGETS & HWY_NEON
    case Target::neon:
      return &N_NEON::kLookKernels;
#endif
#endif
    default:
      return nullptr;
  }
}

const LookKernels& look_kernels(const Exec& exec) {
  return *look_kernels(active_target(exec));
}

}  // namespace cairn::kernels
#endif
