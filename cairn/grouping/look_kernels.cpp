// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <array>
#include <bit>
#include <cairn/grouping/look_kernels.hpp>
#include <cstdint>
#include <cstring>

#define CAIRN_KERNELS <cairn/grouping/look_kernels-inl.hpp>
#include <cairn/core/each_target-inl.hpp>

CAIRN_CHOOSE_KERNELS(LookKernels, look_kernels, kLookKernels)
