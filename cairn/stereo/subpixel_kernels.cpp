// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/stereo/lanes_plain.hpp>
#include <cairn/stereo/subpixel_kernels.hpp>
#include <limits>

#define CAIRN_KERNELS "cairn/stereo/subpixel_kernels-inl.hpp"
#define CAIRN_KERNELS_USE_VECTORS
#include <cairn/core/each_target-inl.hpp>

CAIRN_CHOOSE_KERNELS(SubpixelKernels, subpixel_kernels, kSubpixelKernels)
