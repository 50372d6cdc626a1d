// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// No include guard: compiled once for each target.
#include <cairn/core/sum_along-inl.hpp>

namespace cairn::kernels::CAIRN_KERNEL_TARGET {
namespace {

template <class Pixel>
void add_colours(const Pixel* row, int width, std::int32_t* CAIRN_RESTRICT brightness,
                 std::int32_t* CAIRN_RESTRICT blue, std::int32_t* CAIRN_RESTRICT red,
                 std::int32_t* CAIRN_RESTRICT squares) {
  for (int x = 0; x < width; ++x) {
    const std::array<int, 3> colour = colour_of(row[x]);
    brightness[x] += colour[0];
    blue[x] += colour[1];
    red[x] += colour[2];
    squares[x] += colour[0] * colour[0];
  }
}

inline void add_counts(const HintPixels& row, int width, std::int32_t* CAIRN_RESTRICT edges,
                       std::int32_t* CAIRN_RESTRICT textured, std::int32_t* CAIRN_RESTRICT matched,
                       std::int32_t* CAIRN_RESTRICT above) {
  const std::uint16_t* const edge = row.edges;
  const float* const evidence = row.textured_px;
  const float* const disparity = row.disparity_px;
  const float* const ground = row.ground_px;
  for (int x = 0; x < width; ++x) {
    const int is_matched = disparity[x] == disparity[x] ? 1 : 0;  // false for NaN
    edges[x] += edge[x];
    textured[x] += evidence[x] == evidence[x] ? 1 : 0;
    matched[x] += is_matched;
    above[x] += ground[x] > 0 ? is_matched : 0;
  }
}

inline void add_distances(const HintPixels& row, int width, double* CAIRN_RESTRICT disparities,
                          double* CAIRN_RESTRICT grounds, double* CAIRN_RESTRICT heights,
                          double* CAIRN_RESTRICT before) {
  const float* const disparity = row.disparity_px;
  const float* const ground = row.ground_px;
  const float* const background = row.background_px;
  for (int x = 0; x < width; ++x) {
    const bool is_matched = disparity[x] == disparity[x];
    const double d = disparity[x];
    const double g = ground[x];
    disparities[x] += is_matched ? d : 0;
    grounds[x] += g;
    heights[x] += is_matched & (g > 0) ? d - g : 0;
    before[x] += is_matched ? d - background[x] : 0;
  }
}

inline void add_row(const HintPixels& row, int width, const ColumnSums& sums) {
  const auto& whole = sums.whole;
  if (row.rgb != nullptr) {
    add_colours(row.rgb, width, whole[kBrightness], whole[kBlue], whole[kRed], whole[kSquares]);
  } else {
    add_colours(row.gray, width, whole[kBrightness], whole[kBlue], whole[kRed], whole[kSquares]);
  }
  add_counts(row, width, whole[kEdges], whole[kTextured], whole[kMatched], whole[kAbove]);
  add_distances(row, width, sums.real[kDisparity], sums.real[kGround], sums.real[kHeight],
                sums.real[kBefore]);
}

template <class Number>
void sum_runs(const Number* columns, const std::int32_t* first, const std::int32_t* last, int most, int cells,
              double* CAIRN_RESTRICT out) {
  for (int c = 0; c < cells; ++c) out[c] = static_cast<double>(columns[first[c]]);
  for (int i = 1; i < most; ++i) {
    for (int c = 0; c < cells; ++c) {
      const std::int32_t x = first[c] + i;
      const std::int32_t end = last[c];
      const auto value = static_cast<double>(columns[x < end ? x : end - 1]);
      out[c] += x < end ? value : 0;
    }
  }
}

inline void sum_cells(const ColumnSums& columns, const std::int32_t* first, const std::int32_t* last,
                      int most, int cells, const CellSums& sums) {
  for (std::size_t i = 0; i < kWholeSums; ++i)
    sum_runs(columns.whole[i], first, last, most, cells, sums.whole[i]);
  for (std::size_t i = 0; i < kRealSums; ++i)
    sum_runs(columns.real[i], first, last, most, cells, sums.real[i]);
}

inline void mean(const double* sums, const double* counts, int cells, double none,
                 double* CAIRN_RESTRICT out) {
  for (int c = 0; c < cells; ++c) {
    const double quotient = sums[c] / (counts[c] > 0 ? counts[c] : 1);
    out[c] = counts[c] > 0 ? quotient : none;
  }
}

/// In 1/64, rounded, halves up.
inline std::int16_t in_steps(double value, double least, double most) {
  // For positive numbers truncation is faster than floor(), and exact.
  constexpr int kPositive = 1024;
  constexpr double kSteps = 64;
  value = value < least ? least : value;
  value = most < value ? most : value;
  return static_cast<std::int16_t>(static_cast<int>(value * kSteps + (0.5 + kPositive)) - kPositive);
}

inline void put(const double* values, int cells, const ChannelScale& scale, int stride,
                std::int16_t* CAIRN_RESTRICT out) {
  const auto [zero, unit, least, most] = scale;
  for (int c = 0; c < cells; ++c) out[c * stride] = in_steps((values[c] - zero) / unit, least, most);
}

inline void add_cells(const std::int16_t* row, int cells, int sign, const ChannelSums& columns) {
  for (std::size_t k = 0; k < kLooks; ++k) {
    const std::int16_t* const values = row + kMeanBrightness + k;
    std::int32_t* CAIRN_RESTRICT const sums = columns[kLookSums + k];
    std::int32_t* CAIRN_RESTRICT const squares = columns[kSquareSums + k];
    for (int c = 0; c < cells; ++c) {
      const int value = values[c * kHintChannels];
      sums[c] += sign * value;
      squares[c] += sign * value * value;
    }
  }
  std::int32_t* CAIRN_RESTRICT const disparities = columns[kDisparitySum];
  std::int32_t* CAIRN_RESTRICT const matched = columns[kMatchedCells];
  for (int c = 0; c < cells; ++c) {
    const std::int16_t* const cell = row + c * kHintChannels;
    const int is_matched = cell[kShareMatched] > 0 ? sign : 0;
    disparities[c] += is_matched * cell[kMeanDisparity];
    matched[c] += is_matched;
  }
}

inline void sum_around(const std::int32_t* columns, int cells, std::int32_t* blocks, std::int32_t* sums) {
  sum_along(columns - kAround, cells, kWindow, blocks, sums);
}

/// The sums are whole numbers; they and the products below are exact in a double, so no root is of a negative number.
inline void compare(const ChannelSums& sums, const double* counts, int cells, std::int16_t* row) {
  // Below these, in 1/64, the spread of a plain surface would be noise.
  constexpr std::array<double, kLooks> kLeastSpread{5, 10, 10};
  constexpr double kDisparityUnit = 8;  // 1/64: an eighth of the nearest disparity
  constexpr double kLimit = 4;
  for (std::size_t k = 0; k < kLooks; ++k) {
    const std::int32_t* const values = sums[kLookSums + k];
    const std::int32_t* const squares = sums[kSquareSums + k];
    const std::int16_t* const in = row + kMeanBrightness + k;
    std::int16_t* const out = row + kRelativeBrightness + k;
    for (int c = 0; c < cells; ++c) {
      const double sum = values[c];
      const double spread = std::sqrt(counts[c] * squares[c] - sum * sum);
      const double value = counts[c] * in[c * kHintChannels] - sum;
      out[c * kHintChannels] = in_steps(value / (spread + counts[c] * kLeastSpread[k]), -kLimit, kLimit);
    }
  }
  for (int c = 0; c < cells; ++c) {
    std::int16_t* const cell = row + c * kHintChannels;
    const double count = sums[kMatchedCells][c];
    const double value = count * cell[kMeanDisparity] - sums[kDisparitySum][c];
    const std::int16_t nearer = in_steps(value / (kDisparityUnit * (count > 0 ? count : 1)), -kLimit, kLimit);
    cell[kRelativeDisparity] = cell[kShareMatched] > 0 ? nearer : std::int16_t{0};
  }
}

inline constexpr HintKernels kHintKernels{add_row, sum_cells, mean, put, add_cells, sum_around, compare};

}  // namespace
}  // namespace cairn::kernels::CAIRN_KERNEL_TARGET
