// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

namespace cairn::kernels {

constexpr int round_up(int value, int step) {
  return (value + step - 1) / step * step;
}

/// Prefetches `count` numbers from `at` on, to be written or read. Must be inlined, and so must callers that
/// do nothing else: compilers drop calls without effect.
template <bool kWrites>
struct Expect {
  template <class T>
  [[gnu::always_inline]] inline void operator()([[maybe_unused]] const T* at,
                                                [[maybe_unused]] int count) const {
#if defined(__GNUC__)
    constexpr int kLine = 64 / sizeof(T);
    for (int i = 0; i < count; i += kLine) __builtin_prefetch(at + i, kWrites);
#endif
  }
};
inline constexpr Expect<true> expect_writes{};
inline constexpr Expect<false> expect_reads{};

}  // namespace cairn::kernels
