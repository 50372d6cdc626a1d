// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <array>
#include <bit>
#include <cairn/core/scratch.hpp>
#include <cairn/stereo/byte_lanes_plain.hpp>
#include <cairn/stereo/lanes_plain.hpp>
#include <cairn/stereo/memory.hpp>
#include <cairn/stereo/semi_global_kernels.hpp>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#define CAIRN_KERNELS "cairn/stereo/semi_global_kernels-inl.hpp"
#define CAIRN_KERNELS_USE_VECTORS
#include <cairn/core/each_target-inl.hpp>

CAIRN_CHOOSE_KERNELS(SemiGlobalKernels, semi_global_kernels, kSemiGlobalKernels)
