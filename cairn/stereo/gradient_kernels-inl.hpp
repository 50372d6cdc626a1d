// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// No include guard: compiled once for each target.
#include <cairn/image/over_neighbours-inl.hpp>

namespace cairn::kernels::CAIRN_KERNEL_TARGET {
namespace {

inline void disparity_steepness(const std::int16_t* up, const std::int16_t* here, const std::int16_t* down,
                                int width, std::uint16_t* CAIRN_RESTRICT out) {
  over_neighbours(up, here, down, width, out, [](int centre, int u, int l, int r, int d) {
    const auto known = [centre](int neighbour) { return neighbour == kHole16 ? centre : neighbour; };
    const auto capped = [](int step) { return std::min(std::max(step, -kSteepest16), kSteepest16); };
    const int gx = capped(known(r) - known(l));
    const int gy = capped(known(d) - known(u));
    const int square = std::min(gx * gx + gy * gy, kSteepest16 * kSteepest16);
    const int root = static_cast<int>(std::sqrt(static_cast<float>(square)) + 0.5F);
    return static_cast<std::uint16_t>(centre == kHole16 ? int{kHoleGradient} : root);
  });
}

inline void quantise(const float* disparity_px, int width, std::int16_t* CAIRN_RESTRICT out) {
  for (int x = 0; x < width; ++x) {
    const float d = disparity_px[x];
    // 32767/16 is never reached (kMaxDisparity); the clamp keeps the conversion defined, for NaN too.
    const float wide = d * 16.0F;
    const float bounded = wide > -32767.0F ? wide : -32767.0F;
    const float sixteenths = bounded < 32767.0F ? bounded : 32767.0F;
    // Truncation and a correction instead of std::floor, which is a call per pixel before SSE4.1.
    const int truncated = static_cast<int>(sixteenths);
    const float rest = sixteenths - static_cast<float>(truncated);
    const int rounded = truncated + (rest >= 0.5F ? 1 : 0) - (rest < -0.5F ? 1 : 0);
    const int hole = d == d ? 0 : -1;  // a hole is NaN
    out[x] = static_cast<std::int16_t>((rounded & ~hole) | (kHole16 & hole));
  }
}

inline constexpr DisparityGradientKernels kDisparityGradientKernels{disparity_steepness, quantise};

}  // namespace
}  // namespace cairn::kernels::CAIRN_KERNEL_TARGET
