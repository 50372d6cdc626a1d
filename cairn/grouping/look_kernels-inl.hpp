// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// Included once for each instruction set, by look_kernels.cpp, so without a guard.
namespace cairn::kernels::CAIRN_KERNEL_TARGET {
namespace {

inline constexpr int kBlock = 64;  // facets that are tested at once

/// hits[k] = 1 where facet first + k is within the window.
inline void test_block(const LookArrays& looks, const LookWindow& window, int first,
                       std::uint8_t* CAIRN_RESTRICT hits) {
  const LookArrays at = looks;
  const LookWindow w = window;
  for (int k = 0; k < kBlock; ++k) {
    const int j = first + k;
    const float dr = at.red[j] - w.red;
    const float dg = at.green[j] - w.green;
    const float db = at.blue[j] - w.blue;
    const bool alike = dr * dr + dg * dg + db * db <= w.most_squares;
    const bool beside = (at.right[j] >= w.left) & (at.left[j] <= w.right);
    const bool level = (at.bottom[j] >= w.top) & (at.top[j] <= w.bottom);
    hits[k] = static_cast<std::uint8_t>(alike & beside & level);
  }
}

inline int within(const LookArrays& looks, const LookWindow& window, int first, int last,
                  std::int32_t* found) {
  int count = 0;
  for (int block = first; block < last; block += kBlock) {
    std::array<std::uint8_t, kBlock> hits;
    test_block(looks, window, block, hits.data());
    for (int k = 0; k < kBlock; k += 8) {
      std::uint64_t eight = 0;
      std::memcpy(&eight, hits.data() + k, sizeof(eight));
      if (eight == 0) continue;
      for (int i = k; i < k + 8; ++i) {
        found[count] = block + i;
        count += hits[static_cast<std::size_t>(i)];
      }
    }
  }
  while (count > 0 && found[count - 1] >= last) --count;
  return count;
}

/// 2^n · e^r with n whole and |r| ≤ ln 2 / 2.
inline double exponential(double x) {
  constexpr double kLog2E = 1.4426950408889634;
  constexpr double kLn2High = 0.6931471803691238;  // few bits, so that n times it is exact
  constexpr double kLn2Low = 1.9082149292705877e-10;
  constexpr double kRound = 6755399441055744.0;  // 1.5·2⁵²: leaves the whole number in the low bits
  const double shifted = x * kLog2E + kRound;
  const double n = shifted - kRound;
  const double r = (x - n * kLn2High) - n * kLn2Low;
  // The Taylor series: its next term is below 2⁻⁵⁷.
  double sum = 1.0 / 6227020800.0;
  sum = sum * r + 1.0 / 479001600.0;
  sum = sum * r + 1.0 / 39916800.0;
  sum = sum * r + 1.0 / 3628800.0;
  sum = sum * r + 1.0 / 362880.0;
  sum = sum * r + 1.0 / 40320.0;
  sum = sum * r + 1.0 / 5040.0;
  sum = sum * r + 1.0 / 720.0;
  sum = sum * r + 1.0 / 120.0;
  sum = sum * r + 1.0 / 24.0;
  sum = sum * r + 1.0 / 6.0;
  sum = sum * r + 0.5;
  sum = sum * r + 1.0;
  sum = sum * r + 1.0;
  const std::uint64_t exponent = (std::bit_cast<std::uint64_t>(shifted) + 1023) << 52U;
  return sum * std::bit_cast<double>(exponent);
}

inline void exponentials(double* values, int count) {
  for (int i = 0; i < count; ++i) values[i] = exponential(values[i]);
}

inline NearPixels pixels_like(const ColourCells& cells, const double* colour, double spread,
                              double* CAIRN_RESTRICT work) {
  const ColourCells at = cells;
  const double red = colour[0];
  const double green = colour[1];
  const double blue = colour[2];
  for (int i = 0; i < at.count; ++i) {
    const double dr = red - at.red[i];
    const double dg = green - at.green[i];
    const double db = blue - at.blue[i];
    work[i] = exponential(-((dr * dr + dg * dg + db * db) / 3) / spread);
  }
  // Eight sums side by side: one would wait for its own additions.
  std::array<double, 8> ground{};
  std::array<double, 8> figure{};
  int i = 0;
  for (; i + 8 <= at.count; i += 8) {
    for (int k = 0; k < 8; ++k) {
      ground[static_cast<std::size_t>(k)] += work[i + k] * at.ground[i + k];
      figure[static_cast<std::size_t>(k)] += work[i + k] * at.figure[i + k];
    }
  }
  NearPixels near;
  for (std::size_t k = 0; k < 8; ++k) {
    near.ground += ground[k];
    near.figure += figure[k];
  }
  for (; i < at.count; ++i) {
    near.ground += work[i] * at.ground[i];
    near.figure += work[i] * at.figure[i];
  }
  return near;
}

/// exponential() to nine digits, for −700 ≤ x ≤ 0.
inline double rough_exponential(double x) {
  constexpr double kLog2E = 1.4426950408889634;
  constexpr double kLn2 = 0.6931471805599453;
  constexpr double kRound = 6755399441055744.0;  // 1.5·2⁵²: leaves the whole number in the low bits
  const double shifted = x * kLog2E + kRound;
  const double r = x - (shifted - kRound) * kLn2;
  // Least largest relative error for |r| ≤ ln 2 / 2 (found by Remez' exchange): 2.6e-9.
  double sum = 0.0013941118885963991;
  sum = sum * r + 0.008375134774061576;
  sum = sum * r + 0.0416663527712871;
  sum = sum * r + 0.16666415414048596;
  sum = sum * r + 0.5000000047145969;
  sum = sum * r + 1.0000000377388687;
  sum = sum * r + 1.0;
  const std::uint64_t exponent = (std::bit_cast<std::uint64_t>(shifted) + 1023) << 52U;
  return sum * std::bit_cast<double>(exponent);
}

inline NearPixels pixels_roughly_like(const ColourCells& cells, const double* colour, double spread) {
  const ColourCells at = cells;
  const double red = colour[0];
  const double green = colour[1];
  const double blue = colour[2];
  const double scale = -1 / (3 * spread);
  std::array<double, kCellSlack> ground{};
  std::array<double, kCellSlack> figure{};
  for (int first = 0; first < at.count; first += kCellSlack) {
    std::array<double, kCellSlack> alike;
    for (int k = 0; k < kCellSlack; ++k) {
      const double dr = red - at.red[first + k];
      const double dg = green - at.green[first + k];
      const double db = blue - at.blue[first + k];
      alike[static_cast<std::size_t>(k)] = rough_exponential((dr * dr + dg * dg + db * db) * scale);
    }
    for (int k = 0; k < kCellSlack; ++k) {
      const auto lane = static_cast<std::size_t>(k);
      ground[lane] += alike[lane] * at.ground[first + k];
      figure[lane] += alike[lane] * at.figure[first + k];
    }
  }
  NearPixels near;
  for (std::size_t k = 0; k < kCellSlack; ++k) {
    near.ground += ground[k];
    near.figure += figure[k];
  }
  return near;
}

inline void find_behind(const GroundPlane* planes, int count, int y, int width, float* CAIRN_RESTRICT out) {
  for (int x = 0; x < width; ++x) out[x] = 0;
  const auto v = static_cast<float>(y);
  for (int i = 0; i < count; ++i) {
    const GroundPlane plane = planes[i];
    for (int x = 0; x < width; ++x) {
      const float d = plane.a * static_cast<float>(x) + plane.b * v + plane.c;
      out[x] = out[x] < d ? d : out[x];
    }
  }
}

inline void mark_borders(const RegionId* above, const RegionId* row, const RegionId* below, int width,
                         std::uint8_t* CAIRN_RESTRICT out) {
  const auto differs = [=](int x, int left, int right) {
    const auto here = static_cast<std::int32_t>(row[x]);
    std::int32_t other = 0;
    for (const RegionId* const beside : {above, row, below}) {
      other |= static_cast<std::int32_t>(beside[left]) ^ here;
      other |= static_cast<std::int32_t>(beside[x]) ^ here;
      other |= static_cast<std::int32_t>(beside[right]) ^ here;
    }
    return static_cast<std::uint8_t>(other != 0);
  };
  const int last = width - 1;
  out[0] = differs(0, 0, last < 1 ? 0 : 1);
  for (int x = 1; x < last; ++x) out[x] = differs(x, x - 1, x + 1);
  if (last > 0) out[last] = differs(last, last - 1, last);
}

inline void judge(const ShownRow& row, int width, float least, float margin, Taken* CAIRN_RESTRICT taken,
                  std::uint8_t* CAIRN_RESTRICT before) {
  const ShownRow at = row;
  auto* const kinds = reinterpret_cast<std::uint8_t*>(taken);
  for (int x = 0; x < width; ++x) {
    const float evidence = at.evidence_px[x];
    const float behind = at.behind_px[x];
    const bool known = (at.reject[x] == Reject::none) & (at.disparity_px[x] - behind > least);
    const int inner = static_cast<int>(Taken::inner) - 2 * at.at_border[x];
    const int kind = inner + static_cast<int>(evidence == evidence);  // NaN is not itself
    kinds[x] = static_cast<std::uint8_t>(known ? kind : 0);
    before[x] = static_cast<std::uint8_t>(evidence - behind > margin);
  }
}

inline constexpr LookKernels kLookKernels{within,      exponentials, pixels_like, pixels_roughly_like,
                                          find_behind, mark_borders, judge};

}  // namespace
}  // namespace cairn::kernels::CAIRN_KERNEL_TARGET
