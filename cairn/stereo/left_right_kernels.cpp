// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/stereo/left_right_kernels.hpp>
#include <cairn/stereo/match.hpp>
#include <cstdint>
#include <cstdlib>

#define CAIRN_KERNELS "cairn/stereo/left_right_kernels-inl.hpp"
#include <cairn/core/each_target-inl.hpp>

CAIRN_CHOOSE_KERNELS(LeftRightKernels, left_right_kernels, kLeftRightKernels)
