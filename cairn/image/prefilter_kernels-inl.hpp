// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// No include guard: compiled once for each target.
namespace cairn::kernels::CAIRN_KERNEL_TARGET {
namespace {

inline void filter_row(const Gray* above, const Gray* here, const Gray* below, int width, int cap,
                       std::int16_t* columns, Gray* out) {
  for (int x = 0; x < width; ++x) columns[x] = static_cast<std::int16_t>(above[x] + 2 * here[x] + below[x]);
  const auto most = static_cast<std::int16_t>(cap);
  const auto least = static_cast<std::int16_t>(-cap);
  for (int x = 1; x < width - 1; ++x) {
    const auto slope = static_cast<std::int16_t>(columns[x + 1] - columns[x - 1]);
    out[x] = static_cast<Gray>(std::clamp(slope, least, most) + most);
  }
  out[0] = out[width - 1] = static_cast<Gray>(cap);
}

inline constexpr PrefilterKernels kPrefilterKernels{filter_row};

}  // namespace
}  // namespace cairn::kernels::CAIRN_KERNEL_TARGET
