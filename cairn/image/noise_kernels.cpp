// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/image/noise_kernels.hpp>
#include <cstdint>

#define CAIRN_KERNELS "cairn/image/noise_kernels-inl.hpp"
#include <cairn/core/each_target-inl.hpp>

CAIRN_CHOOSE_KERNELS(NoiseKernels, noise_kernels, kNoiseKernels)
