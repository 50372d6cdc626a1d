// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <array>
#include <cairn/regions/convolution_kernels.hpp>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>

#define CAIRN_KERNELS "cairn/regions/convolution_kernels-inl.hpp"
#define CAIRN_KERNELS_USE_VECTORS
#include <cairn/core/each_target-inl.hpp>

CAIRN_CHOOSE_KERNELS(ConvolutionKernels, convolution_kernels, kConvolutionKernels)
