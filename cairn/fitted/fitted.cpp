// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/fitted/fitted.hpp>

// The assembler embeds each file (CAIRN_FITTED is this folder). The labels stay inside this object file.
#define CAIRN_EMBEDDED(name)                                                                             \
  __asm__(".pushsection .rodata\n.balign 16\ncairn_fitted_" #name ":\n.incbin \"" CAIRN_FITTED "/" #name \
          ".bin\"\ncairn_fitted_" #name "_end:\n.byte 0\n.popsection\n");                                \
  extern "C" __attribute__((visibility("hidden"))) const std::byte cairn_fitted_##name[];                \
  extern "C" __attribute__((visibility("hidden"))) const std::byte cairn_fitted_##name##_end[];          \
  std::span<const std::byte> cairn::fitted::name() {                                                     \
    return {cairn_fitted_##name, cairn_fitted_##name##_end};                                             \
  }

CAIRN_EMBEDDED(hints)
CAIRN_EMBEDDED(same_thing)
CAIRN_EMBEDDED(whole_object)
CAIRN_EMBEDDED(disparity_bias)
CAIRN_EMBEDDED(right_plane)
CAIRN_EMBEDDED(shows_floor)
