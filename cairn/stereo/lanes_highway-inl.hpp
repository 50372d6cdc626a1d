// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// No include guard: compiled once for each target, inside HWY_BEFORE_NAMESPACE.

/// Highway's operations on the widest vectors of the target, plus the operations that the kernels need. The
/// same vocabulary as lanes_plain.hpp.
namespace cairn::kernels::HWY_NAMESPACE::lanes {

using namespace hwy::HWY_NAMESPACE;  // NOLINT(google-build-using-namespace): the vocabulary is Highway's

/// first, first + 1, first + 2 … Loaded, because compilers assemble Iota() lane by lane in memory and stall
/// on it.
template <class D, class T = TFromD<D>>
HWY_INLINE Vec<D> CountFrom(D d, T first) {
  alignas(64) static constexpr T kNumbers[32] = {0,  1,  2,  3,  4,  5,  6,  7,  8,  9,  10,
                                                 11, 12, 13, 14, 15, 16, 17, 18, 19, 20, 21,
                                                 22, 23, 24, 25, 26, 27, 28, 29, 30, 31};
  return Add(Load(d, kNumbers), Set(d, first));
}

/// Each lane holds two 16-bit numbers: low(a)·low(b) + high(a)·high(b).
template <class D>
HWY_INLINE Vec<D> DotPairs(D d, Vec<D> a, Vec<D> b) {
#if HWY_ARCH_X86
  // One pmaddwd, which adds neighbouring products.
  const Repartition<std::int16_t, D> d16;
  Vec<D> unused = Zero(d);
  return ReorderWidenMulAccumulate(d, BitCast(d16, a), BitCast(d16, b), Zero(d), unused);
#else
  const Vec<D> lows = Mul(ShiftRight<16>(ShiftLeft<16>(a)), ShiftRight<16>(ShiftLeft<16>(b)));
  (void)d;
  return Add(lows, Mul(ShiftRight<16>(a), ShiftRight<16>(b)));
#endif
}

/// Each lane holds two 16-bit numbers: |low(a) − low(b)| − |high(a) − high(b)|.
template <int kShift, class D, HWY_IF_LANE_SIZE_D(D, 4)>
HWY_INLINE Vec<D> AbsChange(D d, Vec<D> a, Vec<D> b) {
  static_assert(kShift == 0);
  const Repartition<std::int16_t, D> d16;
  return DotPairs(d, BitCast(d, Abs(Sub(BitCast(d16, a), BitCast(d16, b)))), Set(d, -0xFFFF));  // (1, −1)
}

/// Each lane holds two bytes: (|low(a) − low(b)| − |high(a) − high(b)|)·2^kShift. With a shift, no
/// difference may exceed 127.
template <int kShift, class D, HWY_IF_LANE_SIZE_D(D, 2)>
HWY_INLINE Vec<D> AbsChange(D d, Vec<D> a, Vec<D> b) {
  const Repartition<std::uint8_t, D> d8;
  const auto a8 = BitCast(d8, a);
  const auto b8 = BitCast(d8, b);
  const Repartition<std::int8_t, D> signed8;
  const auto differences = kShift > 0 ? BitCast(d8, Abs(Sub(BitCast(signed8, a), BitCast(signed8, b))))
                                      : Sub(Max(a8, b8), Min(a8, b8));
#if HWY_ARCH_X86
  // One pmaddubsw: unsigned bytes times (2^kShift, −2^kShift), neighbours added. Two products of 255 fit.
  using V = Vec<D>;
  const V signs = Set(d, static_cast<std::int16_t>((-(1 << kShift) & 0xFF) << 8 | 1 << kShift));
#if HWY_TARGET <= HWY_AVX3
  if constexpr (sizeof(V) == 64) return V{_mm512_maddubs_epi16(differences.raw, signs.raw)};
#endif
#if HWY_TARGET <= HWY_AVX2
  if constexpr (sizeof(V) == 32) return V{_mm256_maddubs_epi16(differences.raw, signs.raw)};
#endif
  if constexpr (sizeof(V) == 16) return V{_mm_maddubs_epi16(differences.raw, signs.raw)};
#else
  const RebindToUnsigned<D> du;
  const auto both = BitCast(du, differences);
  return ShiftLeft<kShift>(BitCast(d, Sub(And(both, Set(du, 0xFF)), ShiftRight<8>(both))));
#endif
}

/// The minimum over all lanes.
template <class D, HWY_IF_LANE_SIZE_D(D, 4)>
HWY_INLINE auto LeastLane(D d, Vec<D> v) {
  return GetLane(MinOfLanes(d, v));
}
/// The lanes as rows of eight, one below the other: the minimum (minus 32768), and above its 16 bits the
/// first column with it.
template <class D>
HWY_INLINE std::int32_t LeastEighth([[maybe_unused]] D d, Vec<D> v) {
  if constexpr (MaxLanes(D()) > 8) {
    const Half<D> half;
    return LeastEighth(half, Min(LowerHalf(half, v), UpperHalf(half, v)));
  } else {
    const RebindToUnsigned<D> du;
    const auto from_0 = Xor(BitCast(du, v), Set(du, 0x8000));
#if HWY_ARCH_X86
    return _mm_cvtsi128_si32(_mm_minpos_epu16(from_0.raw));
#else
    const auto least = MinOfLanes(du, from_0);
    const auto first =
        MinOfLanes(du, IfThenElse(Eq(from_0, least), CountFrom(du, std::uint16_t{0}), Set(du, 8)));
    return GetLane(least) | GetLane(first) << 16;
#endif
  }
}

template <class D, HWY_IF_LANE_SIZE_D(D, 2)>
HWY_INLINE std::int16_t LeastLane(D d, Vec<D> v) {
  return static_cast<std::int16_t>(LeastEighth(d, v) ^ 0x8000);
}

/// The first lane with a value of at most `most`, counted over all vectors. One exists.
template <class D, int kCount>
HWY_INLINE int FirstUpTo([[maybe_unused]] D d, const Vec<D> (&v)[kCount], Vec<D> most) {
  constexpr int kLanes = static_cast<int>(MaxLanes(D()));
#if HWY_TARGET == HWY_AVX3
  std::uint64_t more = 0;
  HWY_UNROLL(16)
  for (int k = 0; k < kCount; ++k) more |= static_cast<std::uint64_t>(Gt(v[k], most).raw) << (k * kLanes);
  return std::countr_one(more);
#else
  using T = TFromD<D>;
  Vec<D> first = Set(d, T{kLanes * kCount});
  HWY_UNROLL(16)
  for (int k = kCount - 1; k >= 0; --k)
    first = IfThenElse(Gt(v[k], most), first, CountFrom(d, static_cast<T>(k * kLanes)));
  return static_cast<int>(LeastLane(d, first));
#endif
}

/// The lane-wise minimum of all vectors.
template <class V, int kCount>
HWY_INLINE V LeastOf(const V (&v)[kCount]) {
  V least = v[0];
  HWY_UNROLL(16)
  for (int k = 1; k < kCount; ++k) least = Min(least, v[k]);
  return least;
}

/// The same for all vectors, one below the other.
template <class D, int kCount>
HWY_INLINE std::int32_t LeastOfEights(D d, const Vec<D> (&v)[kCount]) {
  return LeastEighth(d, LeastOf(v));
}

/// Whether registers hold the costs of several pixels at a time.
constexpr bool kManyCosts = HWY_TARGET == HWY_AVX3;

/// Number of vectors that are reduced to one lane each at a time: as many as fit side by side into 128 bits.
template <class D>
constexpr int kFolded = 16 / static_cast<int>(sizeof(TFromD<D>));
template <class D>
using Folded = CappedTag<TFromD<D>, kFolded<D>>;

struct Lesser {
  template <class V>
  static HWY_INLINE V of(V a, V b) {
    return Min(a, b);
  }
};
struct Sum {
  template <class V>
  static HWY_INLINE V of(V a, V b) {
    return Add(a, b);
  }
};
template <class Op, class D>
HWY_INLINE Vec<Folded<D>> FoldBlocks([[maybe_unused]] D d, Vec<D> v) {
  if constexpr (MaxLanes(D()) > kFolded<D>) {
    const Half<D> half;
    return FoldBlocks<Op>(half, Op::of(LowerHalf(half, v), UpperHalf(half, v)));
  } else {
    return v;
  }
}
/// Lane k: the reduction of v[k]. Two vectors become one, their lanes side by side and half as many of each,
/// until one is left.
template <class Op, class D>
HWY_INLINE Vec<Folded<D>> FoldEach(D d, Vec<D> (&v)[kFolded<D>]) {
  HWY_UNROLL(4)
  for (int n = kFolded<D> / 2; n > 0; n /= 2) {
    HWY_UNROLL(8)
    for (int i = 0; i < n; ++i)
      v[i] = Op::of(InterleaveLower(d, v[i], v[i + n]), InterleaveUpper(d, v[i], v[i + n]));
  }
  return FoldBlocks<Op>(d, v[0]);
}

/// The sum of all lanes: the upper half is added to the lower one repeatedly.
template <class D>
HWY_INLINE float SumByHalves(D d, Vec<D> v) {
  if constexpr (MaxLanes(D()) > 4) {
    const Half<D> half;
    return SumByHalves(half, Add(LowerHalf(half, v), UpperHalf(half, v)));
  } else {
    (void)d;
    v = Add(v, Shuffle1032(v));
    return GetLane(Add(v, Shuffle2301(v)));
  }
}

/// A sum of 16-bit numbers, in fewer and wider lanes: initially none; plus those of v.
template <class D>
using SumTag = Repartition<std::int32_t, D>;
template <class D>
using SumOf = Vec<SumTag<D>>;
template <class D>
HWY_INLINE SumOf<D> ZeroSum(D) {
  return Zero(SumTag<D>());
}
template <class D>
HWY_INLINE SumOf<D> AddPairs(D d, SumOf<D> sum, Vec<D> v) {
#if HWY_ARCH_X86
  const SumTag<D> wide;
  SumOf<D> unused = Zero(wide);
  return Add(sum, ReorderWidenMulAccumulate(wide, v, Set(d, std::int16_t{1}), Zero(wide), unused));
#else
  const auto pairs = BitCast(SumTag<D>(), v);
  (void)d;
  return Add(sum, Add(ShiftRight<16>(ShiftLeft<16>(pairs)), ShiftRight<16>(pairs)));
#endif
}
/// Prefix sums of the lanes of v, plus the last lane of `before`. For at most 4 lanes.
template <class D>
HWY_INLINE Vec<D> RunningSum(D d, Vec<D> before, Vec<D> v) {
  v = Add(v, ShiftLeftLanes<1>(d, v));
  v = Add(v, ShiftLeftLanes<2>(d, v));
  return Add(v, Broadcast<3>(before));
}

/// A vector of smaller numbers with as many lanes as 32-bit lanes.
template <class D, class T>
HWY_INLINE Vec<D> LoadWidened(D d, const T* from) {
  return PromoteTo(d, LoadU(Rebind<T, D>(), from));
}
/// The first and the third number of each group of four.
template <class D>
struct FirstAndThird {
  Vec<D> first;
  Vec<D> third;
};
template <class D>
HWY_INLINE FirstAndThird<D> LoadFirstAndThird(D d, const float* fours) {
  const int n = static_cast<int>(Lanes(d));
  const auto lower = ConcatEven(d, LoadU(d, fours + n), LoadU(d, fours));
  const auto upper = ConcatEven(d, LoadU(d, fours + 3 * n), LoadU(d, fours + 2 * n));
  return {ConcatEven(d, upper, lower), ConcatOdd(d, upper, lower)};
}
template <class D>
HWY_INLINE FirstAndThird<D> LoadFirstAndThird(D d, const std::int16_t* fours) {
  const Repartition<std::int16_t, D> d16;
  const auto lower = BitCast(d, LoadU(d16, fours));
  const auto upper = BitCast(d, LoadU(d16, fours + 2 * Lanes(d)));
  return {ShiftRight<16>(ShiftLeft<16>(ConcatEven(d, upper, lower))),
          ShiftRight<16>(ShiftLeft<16>(ConcatOdd(d, upper, lower)))};
}
template <class D, class T>
HWY_INLINE void StoreNarrowed(D, Vec<D> v, T* to) {
  const Rebind<T, D> small;
  StoreU(DemoteTo(small, v), small, to);
}

/// n·a − b·c in double lanes: below 2^53, hence exact.
template <class DD, class VI>
HWY_INLINE Vec<DD> DoubleDifference(DD dd, VI n, VI a, VI b, VI c) {
  return Sub(Mul(PromoteTo(dd, n), PromoteTo(dd, a)), Mul(PromoteTo(dd, b), PromoteTo(dd, c)));
}

/// n·a − b·c, exact, then rounded once.
template <class D, class VI>
HWY_INLINE Vec<D> ExactDifference(D d, VI n, VI a, VI b, VI c) {
  const Half<D> half;
  const Rebind<double, decltype(half)> dd;
  const Half<Rebind<std::int32_t, D>> hi;
  const auto low =
      DoubleDifference(dd, LowerHalf(hi, n), LowerHalf(hi, a), LowerHalf(hi, b), LowerHalf(hi, c));
  const auto high =
      DoubleDifference(dd, UpperHalf(hi, n), UpperHalf(hi, a), UpperHalf(hi, b), UpperHalf(hi, c));
  return Combine(d, DemoteTo(half, high), DemoteTo(half, low));
}

}  // namespace cairn::kernels::HWY_NAMESPACE::lanes
