// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/stereo/uniqueness_kernels.hpp>

#define CAIRN_KERNELS "cairn/stereo/uniqueness_kernels-inl.hpp"
#include <cairn/core/each_target-inl.hpp>

CAIRN_CHOOSE_KERNELS(UniquenessKernels, uniqueness_kernels, kUniquenessKernels)
