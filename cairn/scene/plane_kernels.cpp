// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/scene/plane_kernels.hpp>
#include <cmath>
#include <cstdint>
#include <cstdlib>

#define CAIRN_KERNELS "cairn/scene/plane_kernels-inl.hpp"
#include <cairn/core/each_target-inl.hpp>

CAIRN_CHOOSE_KERNELS(PlaneKernels, plane_kernels, kPlaneKernels)
