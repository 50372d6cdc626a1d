// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// No include guard: compiled once for each target.
namespace cairn::kernels::CAIRN_KERNEL_TARGET {
namespace {

/// to[x] = from[x] + more[x]
template <class T>
inline void add_rows(const T* from, const T* more, int count, T* CAIRN_RESTRICT to) {
  for (int x = 0; x < count; ++x) to[x] = static_cast<T>(from[x] + more[x]);
}

/// Sums of `window` consecutive numbers, composed of blocks of 1, 2, 4, … numbers. The window is odd.
template <class T>
inline void sum_along(const T* columns, int width, int window, T* blocks, T* sums) {
  T* const halves[] = {blocks, blocks + width + window};  // input and output must not overlap
  const T* block = columns;
  const T* sum = columns;
  int summed = 1;
  int length = width + window - 1;
  int half = 0;
  for (int size = 2; size <= window; size *= 2, half = 1 - half) {
    length -= size / 2;  // of complete blocks
    add_rows(block, block + size / 2, length, halves[half]);
    block = halves[half];
    if ((window & size) == 0) continue;
    for (int x = 0; x < width; ++x) sums[x] = static_cast<T>(sum[x] + block[x + summed]);
    sum = sums;
    summed += size;
  }
}

}  // namespace
}  // namespace cairn::kernels::CAIRN_KERNEL_TARGET
