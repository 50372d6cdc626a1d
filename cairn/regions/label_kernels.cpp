// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// Compiles the kernels once for each of Highway's targets, and lists what there is.
#include <cairn/core/target.hpp>
#include <cairn/regions/label_kernels.hpp>
#include <cairn/regions/label_kernels_plain.hpp>

#if CAIRN_WITH_HWY
#include <cairn/core/highway_targets.hpp>
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
#include <cairn/core/of_target.hpp>

namespace cairn::kernels {

namespace plain_kernels = plain_labels;

const LabelKernels* label_kernels(Target target) {
  CAIRN_OF_TARGET(target, kLabelKernels)
}

const LabelKernels& label_kernels(const Exec& exec) {
  return *label_kernels(active_target(exec));
}

}  // namespace cairn::kernels
#endif
