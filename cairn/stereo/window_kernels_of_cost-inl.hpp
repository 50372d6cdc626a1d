// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// No include guard: to be included once, by the source of a cost, which defines CAIRN_COST.
#include <algorithm>
#include <array>
#include <bit>
#include <cairn/core/scratch.hpp>
#include <cairn/image/prefilter.hpp>
#include <cairn/stereo/lanes_plain.hpp>
#include <cairn/stereo/memory.hpp>
#include <cairn/stereo/window_kernels.hpp>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <vector>

#define CAIRN_KERNELS "cairn/stereo/window_kernels-inl.hpp"
#define CAIRN_KERNELS_USE_VECTORS
#include <cairn/core/each_target-inl.hpp>

namespace cairn::kernels {

template <>
const WindowKernels* window_kernels<CAIRN_COST>(Target target) {
  CAIRN_OF_TARGET(target, kWindowKernels)
}

}  // namespace cairn::kernels
