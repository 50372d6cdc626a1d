// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// No include guard: compiled once for each target.
namespace cairn::kernels::CAIRN_KERNEL_TARGET {
namespace {

#if CAIRN_PLAIN_KERNELS

inline void convolve(const std::int16_t* const* rows, const Convolution& by, int width, std::int16_t* out) {
  const auto least = static_cast<float>(by.least);
  const auto greatest = static_cast<float>(kGreatestActivation);
  for (int x = 0; x < width; ++x) {
    std::array<std::int32_t, kMostOutputs> sums;
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

#else

namespace hn = hwy::HWY_NAMESPACE;

using Sums = hn::CappedTag<std::int32_t, 8>;
using Scales = hn::RebindToFloat<Sums>;
using Products = hn::Repartition<std::int16_t, Sums>;
using Narrow = hn::Rebind<std::int16_t, Sums>;

constexpr int kLanes = static_cast<int>(hn::MaxLanes(Sums()));

/// The outputs of kPixels pixels, in kVectors vectors each.
template <int kVectors, int kPixels>
HWY_INLINE void outputs_of(const std::int16_t* const* rows, const Convolution& by, std::ptrdiff_t first,
                           std::int16_t* HWY_RESTRICT out) {
  const Sums d;
  const Products pairs;
  hn::Vec<Sums> sums[kPixels][kVectors];
  hn::Vec<Sums> others[kPixels][kVectors];  // where an instruction set sums two halves apart
#pragma GCC unroll 12
  for (int p = 0; p < kPixels; ++p) {
#pragma GCC unroll 12
    for (int v = 0; v < kVectors; ++v) {
      sums[p][v] = hn::LoadU(d, by.bias + v * kLanes);
      others[p][v] = hn::Zero(d);
    }
  }
  const std::int16_t* HWY_RESTRICT weights = by.weights;
  const int step = by.stride * by.inputs;
  for (int row = 0; row < by.side; ++row) {
    const std::int16_t* HWY_RESTRICT in = rows[row] + first * step;
    for (int i = 0; i < by.side * by.inputs; i += 2) {
      hn::Vec<Products> two[kPixels];
#pragma GCC unroll 12
      for (int p = 0; p < kPixels; ++p) {
        std::int32_t both = 0;
        std::memcpy(&both, in + p * step + i, sizeof both);
        two[p] = hn::BitCast(pairs, hn::Set(d, both));
      }
#pragma GCC unroll 12
      for (int v = 0; v < kVectors; ++v) {
        const auto w = hn::LoadU(pairs, weights);
        weights += 2 * kLanes;
#pragma GCC unroll 12
        for (int p = 0; p < kPixels; ++p)
          sums[p][v] = hn::ReorderWidenMulAccumulate(d, two[p], w, sums[p][v], others[p][v]);
      }
    }
  }
  const auto least = hn::Set(Scales(), static_cast<float>(by.least));
  const auto greatest = hn::Set(Scales(), static_cast<float>(kGreatestActivation));
#pragma GCC unroll 12
  for (int p = 0; p < kPixels; ++p) {
#pragma GCC unroll 12
    for (int v = 0; v < kVectors; ++v) {
      const auto sum = hn::RearrangeToOddPlusEven(sums[p][v], others[p][v]);
      const auto value = hn::Mul(hn::ConvertTo(Scales(), sum), hn::LoadU(Scales(), by.scale + v * kLanes));
      const auto rounded = hn::NearestInt(hn::Clamp(value, least, greatest));
      hn::StoreU(hn::DemoteTo(Narrow(), rounded), Narrow(), out + (p * kVectors + v) * kLanes);
    }
  }
}

/// A row, several pixels at a time: as many sums as registers hold.
template <int kVectors>
HWY_INLINE void row_of(const std::int16_t* const* rows, const Convolution& by, int width, std::int16_t* out) {
  constexpr int kPixels = kVectors < 6 ? 12 / kVectors : 2;
  int x = 0;
  for (; x + kPixels <= width; x += kPixels)
    outputs_of<kVectors, kPixels>(rows, by, x, out + std::ptrdiff_t{x} * by.outputs);
  for (; x < width; ++x) outputs_of<kVectors, 1>(rows, by, x, out + std::ptrdiff_t{x} * by.outputs);
}

inline void convolve(const std::int16_t* const* rows, const Convolution& by, int width, std::int16_t* out) {
  switch (by.outputs / 8) {
    case 1:
      return row_of<8 / kLanes>(rows, by, width, out);
    case 2:
      return row_of<16 / kLanes>(rows, by, width, out);
    case 3:
      return row_of<24 / kLanes>(rows, by, width, out);
    case 4:
      return row_of<32 / kLanes>(rows, by, width, out);
    case 5:
      return row_of<40 / kLanes>(rows, by, width, out);
    default:
      return row_of<48 / kLanes>(rows, by, width, out);
  }
}

#endif

inline constexpr ConvolutionKernels kConvolutionKernels{convolve};

}  // namespace
}  // namespace cairn::kernels::CAIRN_KERNEL_TARGET
