// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// No include guard: compiled once for each target, inside HWY_BEFORE_NAMESPACE.

/// Highway's operations on the widest vectors of the target, and those few that the kernels need beyond them.
/// The same vocabulary as lanes_plain.hpp.
namespace cairn::kernels::HWY_NAMESPACE::lanes {

using namespace hwy::HWY_NAMESPACE;  // NOLINT(google-build-using-namespace): the vocabulary is Highway's

/// Each lane holds two 16-bit numbers: low(a)·low(b) + high(a)·high(b).
template <class D>
HWY_INLINE Vec<D> DotPairs(D d, Vec<D> a, Vec<D> b) {
#if HWY_ARCH_X86
  // One pmaddwd, which adds up neighbouring products.
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
template <class D, HWY_IF_LANE_SIZE_D(D, 4)>
HWY_INLINE Vec<D> AbsChange(D d, Vec<D> a, Vec<D> b) {
  const Repartition<std::int16_t, D> d16;
  return DotPairs(d, BitCast(d, Abs(Sub(BitCast(d16, a), BitCast(d16, b)))), Set(d, -0xFFFF));  // (1, −1)
}

/// Each lane holds two bytes: |low(a) − low(b)| − |high(a) − high(b)|.
template <class D, HWY_IF_LANE_SIZE_D(D, 2)>
HWY_INLINE Vec<D> AbsChange(D d, Vec<D> a, Vec<D> b) {
  const Repartition<std::uint8_t, D> d8;
  const auto a8 = BitCast(d8, a);
  const auto b8 = BitCast(d8, b);
  const auto differences = BitCast(RebindToUnsigned<D>(), Sub(Max(a8, b8), Min(a8, b8)));
  const auto low = And(differences, Set(RebindToUnsigned<D>(), 0xFF));
  return BitCast(d, Sub(low, ShiftRight<8>(differences)));
}

/// The least of all lanes.
template <class D, HWY_IF_LANE_SIZE_D(D, 4)>
HWY_INLINE auto LeastLane(D d, Vec<D> v) {
  return GetLane(MinOfLanes(d, v));
}
template <class D, HWY_IF_LANE_SIZE_D(D, 2)>
HWY_INLINE std::int16_t LeastLane(D d, Vec<D> v) {
  if constexpr (MaxLanes(D()) > 8) {
    const Half<D> half;
    return LeastLane(half, Min(LowerHalf(half, v), UpperHalf(half, v)));
  } else {
    // Unsigned, x86 has one instruction for it.
    const RebindToUnsigned<D> du;
    const auto shifted = Xor(BitCast(du, v), Set(du, 0x8000));
    return static_cast<std::int16_t>(GetLane(MinOfLanes(du, shifted)) ^ 0x8000);
  }
}

/// The sum of all lanes: the upper half is added to the lower one until one lane is left.
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

/// As many 16-bit numbers as there are 32-bit lanes.
template <class D>
HWY_INLINE Vec<D> LoadWidened(D d, const std::int16_t* from) {
  return PromoteTo(d, LoadU(Rebind<std::int16_t, D>(), from));
}

/// n·a − b·c in double lanes: below 2^53, thus exact.
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
