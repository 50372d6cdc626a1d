// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/stereo/flatness_kernels.hpp>
#include <cairn/stereo/match.hpp>

#define CAIRN_KERNELS "cairn/stereo/flatness_kernels-inl.hpp"
#include <cairn/core/each_target-inl.hpp>

CAIRN_CHOOSE_KERNELS(FlatnessKernels, flatness_kernels, kFlatnessKernels)
