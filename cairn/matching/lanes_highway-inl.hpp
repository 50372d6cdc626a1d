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

/// |low(a) − low(b)| and |high(a) − high(b)|, again as a pair.
template <class D>
HWY_INLINE Vec<D> AbsDiffPairs(D d, Vec<D> a, Vec<D> b) {
  const Repartition<std::int16_t, D> d16;
  return BitCast(d, Abs(Sub(BitCast(d16, a), BitCast(d16, b))));
}

/// n·a − b·c in double lanes: below 2^53, thus exact.
template <class DD, class VI>
HWY_INLINE Vec<DD> ExactDifference(DD dd, VI n, VI a, VI b, VI c) {
  return Sub(Mul(PromoteTo(dd, n), PromoteTo(dd, a)), Mul(PromoteTo(dd, b), PromoteTo(dd, c)));
}

/// n·a − b·c, exact, then rounded once.
template <class D, class VI>
HWY_INLINE Vec<D> WideDifference(D d, VI n, VI a, VI b, VI c) {
  const Half<D> half;
  const Rebind<double, decltype(half)> dd;
  const Half<Rebind<std::int32_t, D>> hi;
  const auto low =
      ExactDifference(dd, LowerHalf(hi, n), LowerHalf(hi, a), LowerHalf(hi, b), LowerHalf(hi, c));
  const auto high =
      ExactDifference(dd, UpperHalf(hi, n), UpperHalf(hi, a), UpperHalf(hi, b), UpperHalf(hi, c));
  return Combine(d, DemoteTo(half, high), DemoteTo(half, low));
}

}  // namespace cairn::kernels::HWY_NAMESPACE::lanes
