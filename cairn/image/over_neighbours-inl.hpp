// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// No include guard: compiled once for each target.
namespace cairn::kernels::CAIRN_KERNEL_TARGET {
namespace {

/// For each pixel magnitude(centre, up, left, right, down); the border is replicated.
template <class Magnitude>
inline void over_neighbours(const std::int16_t* up, const std::int16_t* here, const std::int16_t* down,
                            int width, std::uint16_t* CAIRN_RESTRICT out, Magnitude magnitude) {
  const int end = width - 1;
  out[0] = magnitude(here[0], up[0], here[0], here[end > 0 ? 1 : 0], down[0]);
  for (int x = 1; x < end; ++x) out[x] = magnitude(here[x], up[x], here[x - 1], here[x + 1], down[x]);
  if (end > 0) out[end] = magnitude(here[end], up[end], here[end - 1], here[end], down[end]);
}

}  // namespace
}  // namespace cairn::kernels::CAIRN_KERNEL_TARGET
