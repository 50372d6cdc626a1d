// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/regions/hint_kernels.hpp>
#include <cairn/regions/region_cues.hpp>
#include <cmath>

#define CAIRN_KERNELS "cairn/regions/hint_kernels-inl.hpp"
#include <cairn/core/each_target-inl.hpp>

CAIRN_CHOOSE_KERNELS(HintKernels, hint_kernels, kHintKernels)
