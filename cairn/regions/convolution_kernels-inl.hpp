// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// No include guard: compiled once for each target.
namespace cairn::kernels::CAIRN_KERNEL_TARGET {
namespace {

#if CAIRN_PLAIN_KERNELS

inline void convolve(const std::int16_t* const* rows, const Convolution& by, int width, std::int16_t* out) {
  const auto least = static_cast<float>(by.least);
  const auto greatest = static_cast<float>(kMaxActivation);
  for (int x = 0; x < width; ++x) {
    std::array<std::int32_t, kMaxOutputs> sums;
    std::copy_n(by.bias, by.outputs, sums.begin());
    const std::int16_t* weights = by.weights;
    for (int row = 0; row < by.side; ++row) {
      const std::int16_t* in = rows[row] + std::ptrdiff_t{x} * by.stride * by.inputs;
      for (int i = 0; i < by.side * by.inputs; i += 2, weights += 2 * by.outputs) {
        for (int o = 0; o < by.outputs; ++o)
          sums[static_cast<std::size_t>(o)] += in[i] * weights[2 * o] + in[i + 1] * weights[2 * o + 1];
      }
    }
    for (int o = 0; o < by.outputs; ++o) {
      const float value = static_cast<float>(sums[static_cast<std::size_t>(o)]) * by.scale[o];
      *out++ = static_cast<std::int16_t>(std::lrint(std::clamp(value, least, greatest)));
    }
  }
}

inline void convolve_two(const std::int16_t* const* rows, const Convolution& by, int width,
                         std::int16_t* const* out) {
  for (int y = 0; y < 2; ++y) {
    if (out[y] != nullptr) convolve(rows + y, by, width, out[y]);
  }
}

inline void add_doubled(const std::int16_t* small, const std::int16_t* like, int channels, int width,
                        std::int16_t* out) {
  for (int x = 0; x < width; ++x) {
    for (int c = 0; c < channels; ++c)
      *out++ = static_cast<std::int16_t>(std::min(small[x / 2 * channels + c] + *like++, kMaxActivation));
  }
}

#else

namespace hn = hwy::HWY_NAMESPACE;

// Sums of outputs: the widest vectors, and those for the last eight outputs of a layer.
using Wide = hn::CappedTag<std::int32_t, 16>;
using Eight = hn::CappedTag<std::int32_t, 8>;

template <class Sums>
constexpr int kLanes = static_cast<int>(hn::MaxLanes(Sums()));

#if CAIRN_VNNI && HWY_TARGET == HWY_AVX3
HWY_INLINE __m512i products_added(__m512i sums, __m512i a, __m512i b) {
  return _mm512_dpwssd_epi32(sums, a, b);
}
HWY_INLINE __m256i products_added(__m256i sums, __m256i a, __m256i b) {
  return _mm256_dpwssd_epi32(sums, a, b);
}
#elif CAIRN_VNNI
HWY_INLINE __m256i products_added(__m256i sums, __m256i a, __m256i b) {
  return _mm256_dpwssd_avx_epi32(sums, a, b);
}
#endif

/// To each of `sums`, two products. `others`: for instruction sets that sum two halves separately.
template <class Sums, class Pairs>
HWY_INLINE hn::Vec<Sums> add_products([[maybe_unused]] Sums d, Pairs a, Pairs b, hn::Vec<Sums> sums,
                                      [[maybe_unused]] hn::Vec<Sums>& others) {
#if CAIRN_VNNI
  return hn::Vec<Sums>{products_added(sums.raw, a.raw, b.raw)};
#else
  return hn::ReorderWidenMulAccumulate(d, a, b, sums, others);
#endif
}

/// Outputs from sums of products.
template <class Sums>
HWY_INLINE void put(Sums d, hn::Vec<Sums> sum, const Convolution& by, int output, std::int16_t* out) {
  const hn::RebindToFloat<Sums> scales;
  const hn::Rebind<std::int16_t, Sums> narrow;
  const auto least = hn::Set(scales, static_cast<float>(by.least));
  const auto greatest = hn::Set(scales, static_cast<float>(kMaxActivation));
  const auto biased = hn::Add(sum, hn::LoadU(d, by.bias + output));
  const auto value = hn::Mul(hn::ConvertTo(scales, biased), hn::LoadU(scales, by.scale + output));
  // Rounds to nearest: the sum has no bits left for fractions. NearestInt() would also look for overflows.
  const auto shift = hn::Set(scales, 12582912.0F);  // 1.5 · 2²³
  const auto shifted = hn::BitCast(d, hn::Add(hn::Clamp(value, least, greatest), shift));
  hn::StoreU(hn::DemoteTo(narrow, hn::Sub(shifted, hn::BitCast(d, shift))), narrow, out + output);
}

/// The outputs of kPixels pixels from `output` on, in kVectors vectors each.
template <class Sums, int kVectors, int kPixels>
HWY_INLINE void outputs_of(const std::int16_t* const* rows, const Convolution& by, int output,
                           std::ptrdiff_t first, std::int16_t* HWY_RESTRICT out) {
  const Sums d;
  const hn::Repartition<std::int16_t, Sums> pairs;
  hn::Vec<Sums> sums[kPixels][kVectors];
  hn::Vec<Sums> others[kPixels][kVectors];
#pragma GCC unroll 12
  for (int p = 0; p < kPixels; ++p) {
#pragma GCC unroll 12
    for (int v = 0; v < kVectors; ++v) {
      sums[p][v] = hn::Zero(d);
      others[p][v] = hn::Zero(d);
    }
  }
  const std::int16_t* HWY_RESTRICT weights = by.weights + 2 * output;
  const int step = by.stride * by.inputs;
  for (int row = 0; row < by.side; ++row) {
    const std::int16_t* HWY_RESTRICT in = rows[row] + first * step;
    for (int i = 0; i < by.side * by.inputs; i += 2, weights += 2 * by.outputs) {
      hn::Vec<decltype(pairs)> two[kPixels];
#pragma GCC unroll 12
      for (int p = 0; p < kPixels; ++p) {
        std::int32_t both = 0;
        std::memcpy(&both, in + p * step + i, sizeof both);
        two[p] = hn::BitCast(pairs, hn::Set(d, both));
      }
#pragma GCC unroll 12
      for (int v = 0; v < kVectors; ++v) {
        const auto w = hn::LoadU(pairs, weights + 2 * v * kLanes<Sums>);
#pragma GCC unroll 12
        for (int p = 0; p < kPixels; ++p) sums[p][v] = add_products(d, two[p], w, sums[p][v], others[p][v]);
      }
    }
  }
#pragma GCC unroll 12
  for (int p = 0; p < kPixels; ++p) {
#pragma GCC unroll 12
    for (int v = 0; v < kVectors; ++v)
      put(d, hn::RearrangeToOddPlusEven(sums[p][v], others[p][v]), by, output + v * kLanes<Sums>,
          out + p * by.outputs);
  }
}

/// A row, several pixels at a time: as many sums as fit in registers.
template <class Sums, int kVectors>
HWY_INLINE void row_of(const std::int16_t* const* rows, const Convolution& by, int output, int width,
                       std::int16_t* out) {
  constexpr int kPixels = kVectors < 6 ? 12 / kVectors : 2;
  int x = 0;
  for (; x + kPixels <= width; x += kPixels)
    outputs_of<Sums, kVectors, kPixels>(rows, by, output, x, out + std::ptrdiff_t{x} * by.outputs);
  for (; x < width; ++x)
    outputs_of<Sums, kVectors, 1>(rows, by, output, x, out + std::ptrdiff_t{x} * by.outputs);
}

// Outputs: a layer has a multiple of it, or eight more.
constexpr int kStep = std::max(8, kLanes<Wide>);

/// `steps` · kStep outputs of a row, from `output` on; at most kMost steps.
template <int kMost>
HWY_INLINE void steps_of_row(int steps, const std::int16_t* const* rows, const Convolution& by, int output,
                             int width, std::int16_t* out) {
  if constexpr (kMost > 1) {
    if (steps < kMost) return steps_of_row<kMost - 1>(steps, rows, by, output, width, out);
  }
  row_of<Wide, kMost * kStep / kLanes<Wide> >(rows, by, output, width, out);
}

inline void convolve(const std::int16_t* const* rows, const Convolution& by, int width, std::int16_t* out) {
  constexpr int kMost = 48 / kStep;
  int output = 0;
  for (int steps = 0; output + kStep <= by.outputs; output += steps * kStep) {
    steps = std::min((by.outputs - output) / kStep, kMost);
    steps_of_row<kMost>(steps, rows, by, output, width, out);
  }
  if (output < by.outputs) row_of<Eight, 8 / kLanes<Eight> >(rows, by, output, width, out);
}

// ---- 3 × 3 windows, one for each pixel
//
// Winograd's minimal filtering (Lavin and Gray 2016, "Fast algorithms for convolutional neural networks"): a tile
// of 2 × 2 outputs depends on 4 × 4 inputs. Both inputs and weights are transformed into 4 × 4 numbers, whose 16
// products give the four sums; the sums themselves need 36. The transformed weights of HintNetwork are four times
// those of the paper, hence integers, and the sums are divided by four without a remainder: the same bits.
// A transformed input is a sum of four inputs, at most 4 · kMaxActivation, and fits into 16 bits. Intermediate sums
// may wrap around; the final ones, four times those of the window, stay below 2³¹.

using Activation = hn::CappedTag<std::int16_t, 8>;

constexpr int kTiles = 5;     // adjacent tiles at a time: as many sums as fit in registers, with
constexpr int kTogether = 2;  // vectors of outputs

/// Transforms four consecutive numbers.
template <class V>
HWY_INLINE void transform(V a, V b, V c, V d, V* to) {
  to[0] = hn::Sub(a, c);
  to[1] = hn::Add(b, c);
  to[2] = hn::Sub(c, b);
  to[3] = hn::Sub(b, d);
}

/// The two sums over three consecutive numbers, from the products of transformed values.
template <class V>
HWY_INLINE void sums_from(V a, V b, V c, V d, V* sums) {
  sums[0] = hn::Add(hn::Add(a, b), c);
  sums[1] = hn::Sub(hn::Sub(b, c), d);
}

/// Transforms the inputs of a tile.
HWY_INLINE void transform_tile(const std::int16_t* const* rows, const std::ptrdiff_t* columns, int inputs,
                               std::int16_t* HWY_RESTRICT to) {
  const Activation d;
  for (int i = 0; i < inputs; i += static_cast<int>(hn::MaxLanes(d))) {
    hn::Vec<Activation> across[4][4];
    hn::Vec<Activation> down[4];
    for (int r = 0; r < 4; ++r) {
      const auto at = [&](int column) HWY_ATTR { return hn::LoadU(d, rows[r] + columns[column] + i); };
      transform(at(0), at(1), at(2), at(3), across[r]);
    }
    for (int c = 0; c < 4; ++c) {
      transform(across[0][c], across[1][c], across[2][c], across[3][c], down);
      for (int r = 0; r < 4; ++r) hn::StoreU(down[r], d, to + (4 * r + c) * kTiles * kMaxTiledInputs + i);
    }
  }
}

/// Outputs of kTiles tiles from column x on, as far as they are inside the image.
template <class Sums, int kCount>
HWY_INLINE void outputs_of_tiles(const std::int16_t* HWY_RESTRICT tiles, const Convolution& by, int output,
                                 int x, int width, std::int16_t* const* out) {
  const Sums d;
  const hn::Repartition<std::int16_t, Sums> pairs;
  HWY_ALIGN std::int32_t products[kPlaces][kTiles][kCount * kLanes<Sums>];
  const std::int16_t* HWY_RESTRICT weights = by.transformed_weights + 2 * output;
  for (auto& of_place : products) {
    hn::Vec<Sums> sums[kTiles][kCount];
    hn::Vec<Sums> others[kTiles][kCount];
#pragma GCC unroll 12
    for (int t = 0; t < kTiles; ++t) {
#pragma GCC unroll 12
      for (int v = 0; v < kCount; ++v) sums[t][v] = others[t][v] = hn::Zero(d);
    }
    for (int i = 0; i < by.inputs; i += 2, weights += 2 * by.outputs) {
      hn::Vec<decltype(pairs)> w[kCount];
#pragma GCC unroll 12
      for (int v = 0; v < kCount; ++v) w[v] = hn::LoadU(pairs, weights + 2 * v * kLanes<Sums>);
#pragma GCC unroll 12
      for (int t = 0; t < kTiles; ++t) {
        std::int32_t both = 0;
        std::memcpy(&both, tiles + t * kMaxTiledInputs + i, sizeof both);
        const auto two = hn::BitCast(pairs, hn::Set(d, both));
#pragma GCC unroll 12
        for (int v = 0; v < kCount; ++v) sums[t][v] = add_products(d, two, w[v], sums[t][v], others[t][v]);
      }
    }
    tiles += kTiles * kMaxTiledInputs;
#pragma GCC unroll 12
    for (int t = 0; t < kTiles; ++t) {
#pragma GCC unroll 12
      for (int v = 0; v < kCount; ++v)
        hn::Store(hn::RearrangeToOddPlusEven(sums[t][v], others[t][v]), d, of_place[t] + v * kLanes<Sums>);
    }
  }
  for (int t = 0; t < kTiles; ++t, x += 2) {
    for (int v = 0; v < kCount; ++v) {
      const auto at = [&](int place) HWY_ATTR { return hn::Load(d, products[place][t] + v * kLanes<Sums>); };
      hn::Vec<Sums> down[4][2];
#pragma GCC unroll 4
      for (int c = 0; c < 4; ++c) sums_from(at(c), at(4 + c), at(8 + c), at(12 + c), down[c]);
#pragma GCC unroll 2
      for (int r = 0; r < 2; ++r) {
        hn::Vec<Sums> sums[2];
        sums_from(down[0][r], down[1][r], down[2][r], down[3][r], sums);
        if (out[r] == nullptr) continue;
#pragma GCC unroll 2
        for (int c = 0; c < 2; ++c) {
          if (x + c < width)
            put(d, hn::ShiftRight<2>(sums[c]), by, output + v * kLanes<Sums>,
                out[r] + std::ptrdiff_t{x + c} * by.outputs);
        }
      }
    }
  }
}

inline void convolve_two(const std::int16_t* const* rows, const Convolution& by, int width,
                         std::int16_t* const* out) {
  HWY_ALIGN std::int16_t tiles[kPlaces * kTiles * kMaxTiledInputs];
  for (int x = 0; x < width; x += 2 * kTiles) {
    for (int t = 0; t < kTiles; ++t) {
      // Where the width is odd, the last column has no neighbour, and no output depends on it.
      std::ptrdiff_t columns[4];
      for (int c = 0; c < 4; ++c) columns[c] = std::ptrdiff_t{std::min(x + 2 * t + c, width + 1)} * by.inputs;
      transform_tile(rows, columns, by.inputs, tiles + t * kMaxTiledInputs);
    }
    int output = 0;
    for (; output + kTogether * kLanes<Wide> <= by.outputs; output += kTogether * kLanes<Wide>)
      outputs_of_tiles<Wide, kTogether>(tiles, by, output, x, width, out);
    for (; output + kLanes<Wide> <= by.outputs; output += kLanes<Wide>)
      outputs_of_tiles<Wide, 1>(tiles, by, output, x, width, out);
    for (; output < by.outputs; output += kLanes<Eight>)
      outputs_of_tiles<Eight, 1>(tiles, by, output, x, width, out);
  }
}

inline void add_doubled(const std::int16_t* small, const std::int16_t* like, int channels, int width,
                        std::int16_t* HWY_RESTRICT out) {
  const Activation d;
  const auto greatest = hn::Set(d, static_cast<std::int16_t>(kMaxActivation));
  for (int x = 0; x < width; ++x) {
    const std::ptrdiff_t from = std::ptrdiff_t{x / 2} * channels;
    const std::ptrdiff_t to = std::ptrdiff_t{x} * channels;
    for (int c = 0; c < channels; c += static_cast<int>(hn::MaxLanes(d))) {
      const auto sum = hn::Add(hn::LoadU(d, small + from + c), hn::LoadU(d, like + to + c));
      hn::StoreU(hn::Min(sum, greatest), d, out + to + c);
    }
  }
}

#endif

inline constexpr ConvolutionKernels kConvolutionKernels{convolve, convolve_two, add_doubled};

}  // namespace
}  // namespace cairn::kernels::CAIRN_KERNEL_TARGET
