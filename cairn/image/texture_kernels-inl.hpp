// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// No include guard: compiled once for each target.
#include <cairn/core/sum_along-inl.hpp>

namespace cairn::kernels::CAIRN_KERNEL_TARGET {
namespace {

/// 16 bits hold the square of a byte difference and double the number of lanes.
inline std::uint16_t square(std::uint8_t p, std::uint8_t q, std::uint16_t most) {
  const auto difference = static_cast<std::int16_t>(p - q);
  return std::min(static_cast<std::uint16_t>(difference * difference), most);
}

template <class Sum>
inline void add_squares(const std::uint8_t* here, const std::uint8_t* there, int count, std::uint16_t most,
                        Sum* CAIRN_RESTRICT sums) {
  for (int x = 0; x < count; ++x) sums[x] = static_cast<Sum>(sums[x] + square(here[x], there[x], most));
}

template <class Sum>
inline void remove_squares(const std::uint8_t* here, const std::uint8_t* there, int count, std::uint16_t most,
                           Sum* CAIRN_RESTRICT sums) {
  for (int x = 0; x < count; ++x) sums[x] = static_cast<Sum>(sums[x] - square(here[x], there[x], most));
}

template <class Sum>
inline void flag_low_sums(const Sum* columns, int width, int window, const Sum* limits, Sum* blocks,
                          Sum* sums, std::uint8_t* CAIRN_RESTRICT low) {
  sum_along(columns, width, window, blocks, sums);
  for (int x = 0; x < width; ++x) low[x] |= sums[x] < limits[x] ? 1 : 0;
}

template <class Sum>
inline constexpr SquareKernels<Sum> kSquareKernels{add_squares<Sum>, remove_squares<Sum>, flag_low_sums<Sum>};

inline constexpr TextureKernels kTextureKernels{kSquareKernels<std::uint16_t>, kSquareKernels<std::uint32_t>};

}  // namespace
}  // namespace cairn::kernels::CAIRN_KERNEL_TARGET
