// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>

/// For the files that are compiled once for each of Highway's targets, in namespaces that it names, and once
/// for plain C++, in plain_kernels. To be included in the last of these passes.
///
/// CAIRN_OF_TARGET(target, name) ends a function: it returns the address of what is called `name` in the
/// namespace for `target`, nullptr where this build has none.

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
