// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/scene/floor_kernels.hpp>
#include <cmath>
#include <cstdint>
#include <limits>

#define CAIRN_KERNELS "cairn/scene/floor_kernels-inl.hpp"
#include <cairn/core/each_target-inl.hpp>

CAIRN_CHOOSE_KERNELS(FloorKernels, floor_kernels, kFloorKernels)
