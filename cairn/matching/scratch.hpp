// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <algorithm>
#include <cairn/core/pool.hpp>
#include <cstddef>
#include <type_traits>

namespace cairn::kernels {

constexpr int round_up(int value, int step) {
  return (value + step - 1) / step * step;
}

/// Asks for the memory that `count` numbers from `at` on will be written to or read from. Must be inlined,
/// and so must what calls it and does nothing else: compilers leave out calls that change nothing.
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

/// Working memory of one band of rows: zeros at first, aligned like an image's rows. From the heap, not from
/// the pool: how many bands are at work at a time depends on the threads, and what a pool holds shall not.
template <class T>
class Scratch {
  static_assert(std::is_arithmetic_v<T>);

 public:
  explicit Scratch(int size) : size_(size), buffer_(Pool().take(bytes())) { std::fill_n(data(), size, T{0}); }
  [[nodiscard]] int size() const { return size_; }
  [[nodiscard]] T* data() const { return reinterpret_cast<T*>(buffer_.data()); }
  [[nodiscard]] T& operator[](int i) const { return data()[i]; }

 private:
  [[nodiscard]] std::size_t bytes() const { return static_cast<std::size_t>(size_) * sizeof(T); }
  int size_;
  Pool::Buffer buffer_;
};

}  // namespace cairn::kernels
