// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/objects/obstacle_kernels.hpp>
#include <cmath>
#include <limits>

#define CAIRN_KERNELS "cairn/objects/obstacle_kernels-inl.hpp"
#include <cairn/core/each_target-inl.hpp>

CAIRN_CHOOSE_KERNELS(ObstacleKernels, obstacle_kernels, kSpaceKernels)
