// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// Compiles a file of kernels for each instruction set. The kernels of one topic are three files:
//
//   gradient_kernels.hpp      a struct of functions, and gradient_kernels(target)
//   gradient_kernels-inl.hpp  the functions, in namespace cairn::kernels::CAIRN_KERNEL_TARGET, and a constant
//                             of the struct that lists them
//   gradient_kernels.cpp      #define CAIRN_KERNELS "cairn/image/gradient_kernels-inl.hpp"
//                             #include <cairn/core/each_target-inl.hpp>
//                             CAIRN_CHOOSE_KERNELS(GradientKernels, gradient_kernels, kGradientKernels)
//
// The file CAIRN_KERNELS is included here once for each Highway target and once for plain C++, the latter
// with CAIRN_PLAIN_KERNELS = 1. Plain loops need only this: Highway switches the instruction set of the
// compiler. Kernels written in Highway's vectors define CAIRN_KERNELS_USE_VECTORS before. Those that also define
// CAIRN_KERNELS_USE_VNNI are compiled once more for AVX2 and AVX-512, in N_AVX2_VNNI and N_AVX3_VNNI, with
// CAIRN_VNNI = 1 and the instructions that add products to sums; CAIRN_OF_VNNI_TARGET finds them.
//
// No include guard: to be included once, by a source file.
#include <cairn/core/target.hpp>

#if defined(__GNUC__)
#define CAIRN_RESTRICT __restrict__
#else
#define CAIRN_RESTRICT
#endif

#if CAIRN_WITH_HWY
#include <cairn/core/highway_targets.hpp>
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cairn/core/one_target-inl.hpp"
#include <hwy/foreach_target.h>
// The last target; Highway leaves its inclusion to the source file.
#include <cairn/core/one_target-inl.hpp>
#endif

#define CAIRN_PLAIN_KERNELS 1
#define CAIRN_VNNI 0
#define CAIRN_KERNEL_TARGET plain_kernels
#define CAIRN_LANES_INLINE inline
#define CAIRN_LANES_ATTR
#define CAIRN_NOINLINE
#define CAIRN_UNROLL
#include CAIRN_KERNELS

// CAIRN_OF_TARGET(target, name) ends a function: it returns the address of `name` in the namespace of
// `target`, or nullptr if this build lacks the target.
#if CAIRN_WITH_HWY && (HWY_TARGETS & HWY_SSE4)
#define CAIRN_OF_SSE4(name) \
  case Target::sse4:        \
    return &N_SSE4::name;
#else
#define CAIRN_OF_SSE4(name)
#endif
#if CAIRN_WITH_HWY && (HWY_TARGETS & HWY_AVX2)
#define CAIRN_OF_AVX2(name) \
  case Target::avx2:        \
    return &N_AVX2::name;
#else
#define CAIRN_OF_AVX2(name)
#endif
#if CAIRN_WITH_HWY && (HWY_TARGETS & HWY_AVX3)
#define CAIRN_OF_AVX512(name) \
  case Target::avx512:        \
    return &N_AVX3::name;
#else
#define CAIRN_OF_AVX512(name)
#endif
#if CAIRN_WITH_HWY && (HWY_TARGETS & HWY_NEON)
#define CAIRN_OF_NEON(name) \
  case Target::neon:        \
    return &N_NEON::name;
#else
#define CAIRN_OF_NEON(name)
#endif

#define CAIRN_OF_TARGET(target, name) \
  switch (target) {                   \
    case Target::scalar:              \
      return &plain_kernels::name;    \
      CAIRN_OF_SSE4(name)             \
      CAIRN_OF_AVX2(name)             \
      CAIRN_OF_AVX512(name)           \
      CAIRN_OF_NEON(name)             \
    default:                          \
      return nullptr;                 \
  }

// The same for the kernels with VNNI: ends a function in which `target` is one that the processor has with VNNI.
#if CAIRN_WITH_HWY && (HWY_TARGETS & HWY_AVX2)
#define CAIRN_OF_AVX2_VNNI(name) \
  case Target::avx2:             \
    return &N_AVX2_VNNI::name;
#else
#define CAIRN_OF_AVX2_VNNI(name)
#endif
#if CAIRN_WITH_HWY && (HWY_TARGETS & HWY_AVX3)
#define CAIRN_OF_AVX512_VNNI(name) \
  case Target::avx512:             \
    return &N_AVX3_VNNI::name;
#else
#define CAIRN_OF_AVX512_VNNI(name)
#endif
#define CAIRN_OF_VNNI_TARGET(target, name) \
  switch (target) {                        \
    CAIRN_OF_AVX2_VNNI(name)               \
    CAIRN_OF_AVX512_VNNI(name)             \
    default:                               \
      return nullptr;                      \
  }

// Defines `choose(target)`, nullptr if this build has no kernels for it, and `choose(exec)`, the kernels for
// the active target of `exec`: the constant `list` of each target, a Kernels.
#define CAIRN_CHOOSE_KERNELS(Kernels, choose, list) \
  namespace cairn::kernels {                        \
  const Kernels* choose(Target target) {            \
    CAIRN_OF_TARGET(target, list)                   \
  }                                                 \
  const Kernels& choose(const Exec& exec) {         \
    return *choose(active_target(exec));            \
  }                                                 \
  }
