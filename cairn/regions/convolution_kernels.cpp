// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <array>
#include <cairn/core/target.hpp>
#include <cairn/regions/convolution_kernels.hpp>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>

#define CAIRN_KERNELS "cairn/regions/convolution_kernels-inl.hpp"
#define CAIRN_KERNELS_USE_VECTORS
#define CAIRN_KERNELS_USE_VNNI
#include <cairn/core/each_target-inl.hpp>

#if CAIRN_WITH_HWY && HWY_ARCH_X86
#include <cpuid.h>
#endif

namespace cairn::kernels {
namespace {

bool has_vnni([[maybe_unused]] Target target) {
#if CAIRN_WITH_HWY && HWY_ARCH_X86
  struct Bits {
    bool avx2 = false, avx512 = false;
  };
  // Queried once: in a virtual machine, CPUID takes as long as several rows of an image.
  static const Bits has = [] {
    Bits bits;
    unsigned a = 0, b = 0, c = 0, d = 0;
    if (__get_cpuid_count(7, 0, &a, &b, &c, &d) == 0) return bits;
    bits.avx512 = (c & bit_AVX512VNNI) != 0;
    const bool has_next_leaf = a >= 1;
    bits.avx2 = has_next_leaf && __get_cpuid_count(7, 1, &a, &b, &c, &d) != 0 && (a & bit_AVXVNNI) != 0;
    return bits;
  }();
  return (target == Target::avx2 && has.avx2) || (target == Target::avx512 && has.avx512);
#else
  return false;
#endif
}

}  // namespace

const ConvolutionKernels* convolution_kernels(Target target) {
  CAIRN_OF_TARGET(target, kConvolutionKernels)
}

const ConvolutionKernels* vnni_convolution_kernels(Target target) {
  if (!has_vnni(target)) return nullptr;
  CAIRN_OF_VNNI_TARGET(target, kConvolutionKernels)
}

const ConvolutionKernels& convolution_kernels(const Exec& exec) {
  const Target target = active_target(exec);
  const ConvolutionKernels* const vnni = vnni_convolution_kernels(target);
  const ConvolutionKernels* const run = vnni != nullptr ? vnni : convolution_kernels(target);
  return run != nullptr ? *run : plain_kernels::kConvolutionKernels;
}

}  // namespace cairn::kernels
