// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// No include guard: compiled once for each target, over the vocabulary `lanes` of that target.
#include <cairn/stereo/lanes-inl.hpp>

namespace cairn::kernels::CAIRN_KERNEL_TARGET {
namespace {

using F = lanes::CappedTag<float, 16>;
using I = lanes::Rebind<std::int32_t, F>;
using VF = lanes::Vec<F>;
using VI = lanes::Vec<I>;

/// The slope of the curve through (−1, before), (0, least), (1, after).
template <SubpixelMethod kMethod>
CAIRN_LANES_INLINE VF steepness(VF before, VF least, VF after) {
  if constexpr (kMethod == SubpixelMethod::parabola) {
    return lanes::Add(lanes::Sub(before, least), lanes::Sub(after, least));
  } else {
    return lanes::Sub(lanes::Max(before, after), least);
  }
}

/// The minimum of that curve: within ±1/2, as `least` is the smallest of the three. 0 for a missing neighbour
/// (∞) and for three equal costs.
template <SubpixelMethod kMethod>
CAIRN_LANES_INLINE VF lowest(VF before, VF least, VF after) {
  const F f;
  const VF rise = steepness<kMethod>(before, least, after);
  const auto defined = lanes::And(lanes::Gt(rise, lanes::Zero(f)), lanes::Lt(rise, lanes::Set(f, kNoCost)));
  const VF divisor = lanes::IfThenElse(defined, rise, lanes::Set(f, 1.0F));
  const VF offset = lanes::Div(lanes::Mul(lanes::Set(f, 0.5F), lanes::Sub(before, after)), divisor);
  return lanes::IfThenElseZero(defined, offset);
}

template <SubpixelMethod kMethod>
void refine_row(const RefinedRow& row) {
  const F f;
  const I i32;
  for (int x = 0; x < row.width; x += static_cast<int>(lanes::Lanes(f))) {
    const VI best = lanes::LoadWidened(i32, row.best + x);
    VF d = lanes::ConvertTo(f, best);
    if (row.before != nullptr) {
      const VF offset = lowest<kMethod>(lanes::Load(f, row.before + x), lanes::Load(f, row.cost + x),
                                        lanes::Load(f, row.after + x));
      d = lanes::Add(d, offset);
    }
    const auto none = lanes::RebindMask(f, lanes::Eq(best, lanes::Set(i32, std::int32_t{kNoMatch})));
    const VF hole = lanes::Set(f, std::numeric_limits<float>::quiet_NaN());
    lanes::Store(lanes::IfThenElse(none, hole, d), f, row.out + x);
  }
}
inline void refine_row(SubpixelMethod method, const RefinedRow& row) {
  method == SubpixelMethod::parabola ? refine_row<SubpixelMethod::parabola>(row)
                                     : refine_row<SubpixelMethod::equiangular>(row);
}

inline constexpr SubpixelKernels kSubpixelKernels{refine_row};

}  // namespace
}  // namespace cairn::kernels::CAIRN_KERNEL_TARGET
