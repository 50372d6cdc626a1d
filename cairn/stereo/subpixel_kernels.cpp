// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/matching/lanes_plain.hpp>
#include <cairn/matching/subpixel_kernels.hpp>
#include <limits>

#define CAIRN_KERNELS "cairn/matching/subpixel_kernels-inl.hpp"
#define CAIRN_KERNELS_USE_VECTORS
#include <cairn/core/each_target-inl.hpp>

CAIRN_CHOOSE_KERNELS(SubpixelKernels, subpixel_kernels, kSubpixelKernels)
