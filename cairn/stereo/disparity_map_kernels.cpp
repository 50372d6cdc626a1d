// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/stereo/disparity_map_kernels.hpp>
#include <cstdint>
#include <limits>

#define CAIRN_KERNELS "cairn/stereo/disparity_map_kernels-inl.hpp"
#include <cairn/core/each_target-inl.hpp>

CAIRN_CHOOSE_KERNELS(DisparityMapKernels, disparity_map_kernels, kDisparityMapKernels)
