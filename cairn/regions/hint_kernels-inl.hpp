// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// No include guard: compiled once for each target.
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

inline void put(const double* values, int cells, const ChannelScale& scale, int stride,
                std::int16_t* CAIRN_RESTRICT out) {
  const auto [zero, unit, least, most] = scale;
  // For positive numbers truncation is faster than floor(), and exact.
  constexpr int kPositive = 1024;
  constexpr double kSteps = 64;
  for (int c = 0; c < cells; ++c) {
    double value = (values[c] - zero) / unit;
    value = value < least ? least : value;
    value = most < value ? most : value;
    out[c * stride] =
        static_cast<std::int16_t>(static_cast<int>(value * kSteps + (0.5 + kPositive)) - kPositive);
  }
}

inline constexpr HintKernels kHintKernels{add_row, sum_cells, mean, put};

}  // namespace
}  // namespace cairn::kernels::CAIRN_KERNEL_TARGET
