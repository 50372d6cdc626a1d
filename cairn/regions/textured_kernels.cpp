// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/regions/textured_kernels.hpp>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>

#define CAIRN_KERNELS "cairn/regions/textured_kernels-inl.hpp"
#include <cairn/core/each_target-inl.hpp>

CAIRN_CHOOSE_KERNELS(TexturedKernels, textured_kernels, kEvidenceKernels)
