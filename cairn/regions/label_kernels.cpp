// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// Compiles the kernels once for each of Highway's targets, and lists what there is.
#include <cairn/core/target.hpp>
#include <cairn/regions/label_kernels.hpp>
#include <cairn/regions/label_kernels_plain.hpp>

#if CAIRN_WITH_HWY
// Only what Target names; see matching/kernels.cpp.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cairn/regions/label_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#if HWY_TARGET != HWY_EMU128 && HWY_TARGET != HWY_SCALAR
HWY_BEFORE_NAMESPACE();
#include <cairn/regions/label_kernels_highway-inl.hpp>
HWY_AFTER_NAMESPACE();
#endif
#endif

#if !CAIRN_WITH_HWY || HWY_ONCE
namespace cairn::kernels {

const LabelKernels* label_kernels(Target target) {
  switch (target) {
    case Target::scalar:
      return &plain_labels::kLabelKernels;
#if CAIRN_WITH_HWY
#if HWY_TARGETS & HWY_SSE4
    case Target::sse4:
      return &N_SSE4::kLabelKernels;
#endif
#if HWY_TARGETS & HWY_AVX2
    case Target::avx2:
      return &N_AVX2::kLabelKernels;
#endif
#if HWY_TARGETS & HWY_AVX3
    case Target::avx512:
      return &N_AVX3::kLabelKernels;
#endif
#if HWY_TARGETS & HWY_NEON
    case Target::neon:
      return &N_NEON::kLabelKernels;
#endif
#endif
    default:
      return nullptr;
  }
}

const LabelKernels& label_kernels(const Exec& exec) {
  return *label_kernels(active_target(exec));
}

}  // namespace cairn::kernels
#endif
