// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// No include guard: compiled once for each target, inside HWY_BEFORE_NAMESPACE.

/// Highway's operations, plus the operations on byte vectors that semi-global matching needs. The same
/// vocabulary as byte_lanes_plain.hpp.
namespace cairn::kernels::HWY_NAMESPACE::bytes {

using namespace hwy::HWY_NAMESPACE;  // NOLINT(google-build-using-namespace): the vocabulary is Highway's

/// Lane i of the result is lane i − 1 of `here`; lane 0 is the last lane of `before`.
template <class D, class V = Vec<D>>
HWY_INLINE V SlideUp(D d, V before, V here) {
#if HWY_ARCH_X86
#if HWY_TARGET == HWY_AVX3
  if constexpr (sizeof(V) == 64) {
    return CombineShiftRightBytes<15>(d, here, V{_mm512_alignr_epi64(here.raw, before.raw, 6)});
  }
#endif
#if HWY_TARGET <= HWY_AVX2
  if constexpr (sizeof(V) == 32) {
    return CombineShiftRightBytes<15>(d, here, ConcatLowerUpper(d, here, before));
  }
#endif
#endif
  if constexpr (sizeof(V) == 16) return CombineShiftRightBytes<15>(d, here, before);
}

/// Lane i of the result is lane i + 1 of `here`; the last lane is lane 0 of `next`.
template <class D, class V = Vec<D>>
HWY_INLINE V SlideDown(D d, V here, V next) {
#if HWY_ARCH_X86
#if HWY_TARGET == HWY_AVX3
  if constexpr (sizeof(V) == 64) {
    return CombineShiftRightBytes<1>(d, V{_mm512_alignr_epi64(next.raw, here.raw, 2)}, here);
  }
#endif
#if HWY_TARGET <= HWY_AVX2
  if constexpr (sizeof(V) == 32) {
    return CombineShiftRightBytes<1>(d, ConcatLowerUpper(d, next, here), here);
  }
#endif
#endif
  if constexpr (sizeof(V) == 16) return CombineShiftRightBytes<1>(d, next, here);
}

/// The minimum of 16 bytes, in lane 0.
template <class D>
HWY_INLINE Vec<D> LeastBlock([[maybe_unused]] D d, Vec<D> v) {
  if constexpr (MaxLanes(D()) > 16) {
    const Half<D> half;
    return ZeroExtendVector(d, LeastBlock(half, Min(LowerHalf(half, v), UpperHalf(half, v))));
  } else {
#if HWY_ARCH_X86
    const Repartition<std::uint16_t, D> d16;
    const Vec<D> pairs = Min(v, BitCast(d, ShiftRight<8>(BitCast(d16, v))));
    return Vec<D>{_mm_minpos_epu16(pairs.raw)};
#else
    v = Min(v, CombineShiftRightBytes<8>(d, v, v));
    v = Min(v, CombineShiftRightBytes<4>(d, v, v));
    v = Min(v, CombineShiftRightBytes<2>(d, v, v));
    return Min(v, CombineShiftRightBytes<1>(d, v, v));
#endif
  }
}

/// The minimum over all lanes, in every lane.
template <class D, class V = Vec<D>>
HWY_INLINE V MinOfAll(D d, V v) {
  const V least = LeastBlock(d, v);
#if HWY_TARGET == HWY_AVX3
  if constexpr (sizeof(V) == 64) return V{_mm512_broadcastb_epi8(_mm512_castsi512_si128(least.raw))};
#endif
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX2
  if constexpr (sizeof(V) == 32) return V{_mm256_broadcastb_epi8(_mm256_castsi256_si128(least.raw))};
#endif
  if constexpr (sizeof(V) == 16) return TableLookupBytes(least, Zero(d));
}

/// Population count of 4-bit numbers.
template <class D, class V = Vec<D>>
HWY_INLINE V CountBits(D d, V v) {
  alignas(16) constexpr std::uint8_t kBits[16] = {0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4};
  const V table = LoadDup128(d, kBits);
  const V four = Set(d, std::uint8_t{15});
  return Add(TableLookupBytes(table, And(v, four)), TableLookupBytes(table, ShiftRight<4>(v)));
}

/// Hamming distance of 24-bit a and b, lane by lane.
template <class D, class V = Vec<D>>
HWY_INLINE V CountDifferentBits(D d, const V (&a)[3], const V (&b)[3]) {
  const V x = Xor(a[0], b[0]);
  const V y = Xor(a[1], b[1]);
  const V z = Xor(a[2], b[2]);
  // The number of set bits among three bits at the same position, in binary, so that two bytes are counted
  // instead of three.
  const V x_y = Xor(x, y);
  const V ones = Xor(x_y, z);
  const V twos = Or(And(x, y), And(x_y, z));
  const V pairs = CountBits(d, twos);
  return Add(CountBits(d, ones), Add(pairs, pairs));
}

/// a + b + c as 16-bit numbers.
template <class D, class V = Vec<D>>
HWY_INLINE void StoreSum(D, V a, V b, V c, std::int16_t* to) {
  const Half<D> half;
  const Repartition<std::int16_t, D> wide;
  const auto lower = [&](V v) HWY_ATTR { return PromoteTo(wide, LowerHalf(half, v)); };
  const auto upper = [&](V v) HWY_ATTR { return PromoteTo(wide, UpperHalf(half, v)); };
  Store(Add(Add(lower(a), lower(b)), lower(c)), wide, to);
  Store(Add(Add(upper(a), upper(b)), upper(c)), wide, to + Lanes(wide));
}

}  // namespace cairn::kernels::HWY_NAMESPACE::bytes
