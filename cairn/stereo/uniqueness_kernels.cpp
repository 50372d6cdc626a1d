// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/disparity/uniqueness_kernels.hpp>

#define CAIRN_KERNELS "cairn/disparity/uniqueness_kernels-inl.hpp"
#include <cairn/core/each_target-inl.hpp>

CAIRN_CHOOSE_KERNELS(UniquenessKernels, uniqueness_kernels, kUniquenessKernels)
