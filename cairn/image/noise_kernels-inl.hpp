// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// No include guard: compiled once for each target.
namespace cairn::kernels::CAIRN_KERNEL_TARGET {
namespace {

inline void noise(const std::uint8_t* up, const std::uint8_t* here, const std::uint8_t* down, int width,
                  std::uint16_t* CAIRN_RESTRICT out) {
  for (int x = 1; x + 1 < width; ++x) {
    const int corners = up[x - 1] + up[x + 1] + down[x - 1] + down[x + 1];
    const int sides = up[x] + down[x] + here[x - 1] + here[x + 1];
    const auto response = static_cast<std::int16_t>(corners - 2 * sides + 4 * here[x]);
    out[x] = static_cast<std::uint16_t>(response < 0 ? -response : response);
  }
}

inline constexpr NoiseKernels kNoiseKernels{noise};

}  // namespace
}  // namespace cairn::kernels::CAIRN_KERNEL_TARGET
