// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <bit>
#include <cairn/stereo/confidence_kernels.hpp>
#include <cmath>
#include <cstdint>
#include <cstdlib>

#define CAIRN_KERNELS "cairn/stereo/confidence_kernels-inl.hpp"
#include <cairn/core/each_target-inl.hpp>

CAIRN_CHOOSE_KERNELS(ConfidenceKernels, confidence_kernels, kConfidenceKernels)
