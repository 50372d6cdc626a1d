// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/image/texture_kernels.hpp>
#include <cstdint>

#define CAIRN_KERNELS "cairn/image/texture_kernels-inl.hpp"
#include <cairn/core/each_target-inl.hpp>

CAIRN_CHOOSE_KERNELS(TextureKernels, texture_kernels, kTextureKernels)
