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
#define CAIRN_VNNI 0
#define CAIRN_KERNEL_TARGET HWY_NAMESPACE
#define CAIRN_LANES_INLINE HWY_INLINE
#define CAIRN_LANES_ATTR HWY_ATTR
#define CAIRN_NOINLINE HWY_NOINLINE
#define CAIRN_UNROLL HWY_UNROLL(16)
HWY_BEFORE_NAMESPACE();
#include CAIRN_KERNELS
HWY_AFTER_NAMESPACE();
#if defined(CAIRN_KERNELS_USE_VNNI) && (HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3)
// Highway itself never uses VNNI with AVX2, and with AVX-512 only in later versions and for a target of its own. The
// vectors and functions stay those of this target: functions of a smaller one are inlined into a larger one.
#undef CAIRN_KERNEL_TARGET
#undef CAIRN_VNNI
#define CAIRN_VNNI 1
#if HWY_TARGET == HWY_AVX2
#define CAIRN_KERNEL_TARGET N_AVX2_VNNI
HWY_PUSH_ATTRIBUTES(HWY_TARGET_STR ",avxvnni")
#else
#define CAIRN_KERNEL_TARGET N_AVX3_VNNI
HWY_PUSH_ATTRIBUTES(HWY_TARGET_STR ",avx512vnni")
#endif
#include CAIRN_KERNELS
HWY_POP_ATTRIBUTES
#endif
#undef CAIRN_PLAIN_KERNELS
#undef CAIRN_VNNI
#undef CAIRN_KERNEL_TARGET
#undef CAIRN_LANES_INLINE
#undef CAIRN_LANES_ATTR
#undef CAIRN_NOINLINE
#undef CAIRN_UNROLL
#endif
