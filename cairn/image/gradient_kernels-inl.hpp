// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// No include guard: compiled once for each target.
#include <cairn/image/over_neighbours-inl.hpp>

namespace cairn::kernels::CAIRN_KERNEL_TARGET {
namespace {

/// Repeats the first and the last sample of a row `radius` times around it.
inline void replicate_ends(std::uint16_t* row, int width, int channels, int radius) {
  const int last = (width - 1) * channels;
  for (int i = 1; i <= radius; ++i) {
    for (int c = 0; c < channels; ++c) {
      row[c - i * channels] = row[c];
      row[last + c + i * channels] = row[last + c];
    }
  }
}

inline void smooth(const std::uint8_t* const* rows, int width, int channels, RowWeights kernel,
                   std::uint16_t* CAIRN_RESTRICT padded, std::uint32_t* CAIRN_RESTRICT sum,
                   std::int16_t* CAIRN_RESTRICT out) {
  const int r = kernel.radius;
  const int length = width * channels;
  std::uint16_t* const column = padded + r * channels;  // 8.8 bits
  const auto centre_weight = static_cast<std::uint16_t>(kernel.weights[0]);
  for (int x = 0; x < length; ++x) column[x] = static_cast<std::uint16_t>(rows[r][x] * centre_weight);
  for (int i = 1; i <= r; ++i) {
    const std::uint8_t* const up = rows[r - i];
    const std::uint8_t* const down = rows[r + i];
    const auto w = static_cast<std::uint16_t>(kernel.weights[i]);
    for (int x = 0; x < length; ++x)
      column[x] = static_cast<std::uint16_t>(column[x] + w * (up[x] + down[x]));
  }
  replicate_ends(column, width, channels, r);

  // 8.16 bits.
  for (int x = 0; x < length; ++x) sum[x] = std::uint32_t{column[x]} * centre_weight + (1U << 11U);
  for (int i = 1; i <= r; ++i) {
    const auto w = static_cast<std::uint32_t>(kernel.weights[i]);
    const std::uint16_t* const left = column - i * channels;
    const std::uint16_t* const right = column + i * channels;
    for (int x = 0; x < length; ++x) sum[x] += w * (std::uint32_t{left[x]} + right[x]);
  }
  for (int x = 0; x < length; ++x) out[x] = static_cast<std::int16_t>(sum[x] >> 12U);
}

inline void edges(const std::int16_t* up, const std::int16_t* here, const std::int16_t* down, int width,
                  int channels, std::uint32_t* CAIRN_RESTRICT squares, std::uint16_t* CAIRN_RESTRICT out) {
  const int end = (width - 1) * channels;
  const auto square = [&](int x, int left, int right) {
    const int gx = here[right] - here[left];
    const int gy = down[x] - up[x];
    return static_cast<std::uint32_t>(gx * gx + gy * gy);
  };
  for (int x = channels; x < end; ++x) squares[x] = square(x, x - channels, x + channels);
  for (int c = 0; c < channels; ++c) {
    squares[c] = square(c, c, c + std::min(channels, end));
    squares[end + c] = square(end + c, c + std::max(end - channels, 0), end + c);
  }
  // The root is monotonic, rounded or not.
  if (channels == 3) {
    for (int x = 0; x < width; ++x)
      squares[x] = std::max(std::max(squares[3 * x], squares[3 * x + 1]), squares[3 * x + 2]);
  }
  for (int x = 0; x < width; ++x) {
    const float magnitude = std::sqrt(static_cast<float>(static_cast<int>(squares[x]))) * 0.125F;
    out[x] = static_cast<std::uint16_t>(static_cast<int>(magnitude + 0.5F));  // 1/32 → 1/4 level
  }
}

inline void steepness(const std::int16_t* up, const std::int16_t* here, const std::int16_t* down, int width,
                      std::uint16_t* CAIRN_RESTRICT out) {
  over_neighbours(up, here, down, width, out, [](int, int u, int l, int r, int d) {
    constexpr int kCap = 256 * 16;  // above it the root rounds to 255, and float holds the sum exactly
    const int square = std::min((r - l) * (r - l) + (d - u) * (d - u), kCap * kCap);
    const int root = static_cast<int>(std::sqrt(static_cast<float>(square)) * (1.0F / 16) + 0.5F);
    return static_cast<std::uint16_t>(std::min(root, 255));
  });
}

inline constexpr GradientKernels kGradientKernels{smooth, edges, steepness};

}  // namespace
}  // namespace cairn::kernels::CAIRN_KERNEL_TARGET
