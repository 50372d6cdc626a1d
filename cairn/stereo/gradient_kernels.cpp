// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/stereo/gradient.hpp>
#include <cairn/stereo/gradient_kernels.hpp>
#include <cmath>
#include <cstdint>

#define CAIRN_KERNELS "cairn/stereo/gradient_kernels-inl.hpp"
#include <cairn/core/each_target-inl.hpp>

CAIRN_CHOOSE_KERNELS(DisparityGradientKernels, disparity_gradient_kernels, kDisparityGradientKernels)
