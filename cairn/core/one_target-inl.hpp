// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// No include guard: each_target-inl.hpp has Highway include it once for each target.
#ifdef CAIRN_KERNELS_USE_VECTORS
#include <hwy/highway.h>
#else
// Loops need only the target switch. The vector code takes a second and a half to compile.
#include <hwy/base.h>
#include <hwy/ops/set_macros-inl.h>
#endif

#if HWY_TARGET != HWY_EMU128 && HWY_TARGET != HWY_SCALAR
#define CAIRN_PLAIN_KERNELS 0
#define CAIRN_KERNEL_TARGET HWY_NAMESPACE
#define CAIRN_LANES_INLINE HWY_INLINE
#define CAIRN_LANES_ATTR HWY_ATTR
#define CAIRN_NOINLINE HWY_NOINLINE
#define CAIRN_UNROLL HWY_UNROLL(16)
HWY_BEFORE_NAMESPACE();
#include CAIRN_KERNELS
HWY_AFTER_NAMESPACE();
#undef CAIRN_PLAIN_KERNELS
#undef CAIRN_KERNEL_TARGET
#undef CAIRN_LANES_INLINE
#undef CAIRN_LANES_ATTR
#undef CAIRN_NOINLINE
#undef CAIRN_UNROLL
#endif
