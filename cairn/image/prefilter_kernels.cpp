// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/image/prefilter_kernels.hpp>

#define CAIRN_KERNELS "cairn/image/prefilter_kernels-inl.hpp"
#include <cairn/core/each_target-inl.hpp>

CAIRN_CHOOSE_KERNELS(PrefilterKernels, prefilter_kernels, kPrefilterKernels)
