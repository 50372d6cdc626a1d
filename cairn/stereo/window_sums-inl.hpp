// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// No include guard: compiled once for each target, over the vocabulary `lanes` of that target.
//
// Running sums over windows, and the costs from them.

namespace cairn::kernels::CAIRN_KERNEL_TARGET {
namespace {

template <class T>
int length(const Scratch<T>& list) {
  return static_cast<int>(list.size());
}

/// Sums over the windows of one image for the current row, clipped at its borders. Entries: the pixels of the
/// row in the order of its pairs, with margins before and after.
struct Moments {
  int half;
  int lead;                             // entries before the first; keeps vectors aligned
  int first;                            // entry of a pixel
  int width;                            // number of pixels
  Scratch<std::int32_t> column_sum;     // [lead + entry]
  Scratch<std::int32_t> column_energy;  // likewise, of squares
  Scratch<std::int32_t>
      sum_before;  // [lead + entry]: over the columns before the entry; may wrap, differences do not
  Scratch<std::int32_t> energy_before;
  Scratch<std::int32_t> columns;  // [entry]: columns of the window inside the image
  Scratch<std::int32_t> sum;
  Scratch<std::int32_t> energy;
  Scratch<std::int32_t> variance;  // n·energy − sum², modulo 2^32
  Scratch<float> inverse;          // inverse root needed by the operator

  /// Operators on differences only need none.
  Moments(const Geometry& g, bool wanted)
      : half(g.half),
        lead(wanted ? round_up(half, 16) : 0),
        first(g.pad),
        width(wanted ? g.width : 0),
        column_sum(wanted ? round_up(lead + g.length + half + 16, 16) : 0),
        column_energy(length(column_sum)),
        sum_before(length(column_sum) + 1),
        energy_before(length(column_sum) + 1),
        columns(wanted ? g.length + 16 : 0),
        sum(length(columns)),
        energy(length(columns)),
        variance(length(columns)),
        inverse(length(columns)) {
    for (int x = 0; x < width; ++x) {
      columns[first + x] = std::min(x + half, width - 1) - std::max(x - half, 0) + 1;
    }
  }
};

/// Left windows, complete in their own image, that the left border of the right image cuts: only their
/// columns from d on have a partner. For each left pixel x, those for d = x − half + 1 … x; unused entries
/// are undefined.
struct CutWindows {
  int half;
  int first_x;
  int count;   // number of pixels
  int stride;  // from pixel to pixel
  Scratch<std::int32_t> columns;
  Scratch<std::int32_t> sum;
  Scratch<std::int32_t> energy;
  Scratch<float> inverse;

  CutWindows(const Geometry& g, bool wanted)
      : half(g.half),
        first_x(std::max(g.half, g.first_d)),
        count(wanted ? std::max(0, std::min(g.width - g.half, g.first_d + g.lanes + g.half) - first_x) : 0),
        stride(round_up(half, 4)),
        columns(count > 0 ? round_up(count * stride, 16) + 2 * kMargin : 0),
        sum(length(columns)),
        energy(length(columns)),
        inverse(length(columns)) {
    for (int x = first_x; x < first_x + count; ++x) {
      for (int d = x - half + 1; d <= x; ++d) columns[at(x, d)] = x + half + 1 - d;
    }
  }
  [[nodiscard]] int at(int x, int d) const { return kMargin + (x - first_x) * stride + d - (x - half + 1); }
};

/// The row of the right image (in the same row, or one of its band) correlated with a left row.
template <class Width>
struct Strip {
  using Sum = typename Width::Sum;
  int row;                   // of the right image, relative to that of the left one
  int rows = 0;              // rows of the window inside both images
  Scratch<Sum> column_sums;  // Geometry::column(); in units of 1/2^Width::kShift
  Scratch<Sum> box;          // [lane]
  Scratch<Sum> left_pairs;   // [pad + x]
  Scratch<Sum> right_pairs;  // reversed
  Moments left;
  Moments right;
  CutWindows cut;

  Strip(int strip_row, const Geometry& g, bool with_moments)
      : row(strip_row),
        column_sums(g.columns() * g.lanes),
        box(g.lanes),
        left_pairs(g.length + 16),
        right_pairs(g.length + 16),
        left(g, with_moments),
        right(g, with_moments),
        cut(g, with_moments) {}
};

/// Whole vectors of Wide::pair_of().
template <int kSign, class Pixel>
CAIRN_LANES_INLINE VI pair_up(const Pixel* in, const Pixel* out) {
  const I i32;
  const VI comes = lanes::LoadWidened(i32, in);
  const VI goes = lanes::ShiftLeft<16>(lanes::LoadWidened(i32, out));
  if constexpr (kSign > 0) return lanes::Or(lanes::And(comes, lanes::Set(i32, 0xFFFF)), goes);
  return lanes::Sub(comes, goes);  // of numbers ≥ 0
}

/// Interleaves the pixels of two rows, one incoming and one outgoing, the latter times kSign.
template <class Width, int kSign, class Pixel>
void pair_up(const Pixel* in, const Pixel* out, int width, typename Width::Sum* pairs) {
  int x = 0;
  if constexpr (std::is_same_v<Width, Wide>) {
    for (; x + lane_count<Wide>() <= width; x += lane_count<Wide>()) {
      lanes::StoreU(pair_up<kSign>(in + x, out + x), I(), pairs + x);
    }
  }
  for (; x < width; ++x) pairs[x] = Width::pair_of(in[x], kSign * out[x]);
}

/// The same, last pixel first.
template <class Width, class Pixel>
void pair_up_reversed(const Pixel* in, const Pixel* out, int width, typename Width::Sum* pairs) {
  int x = 0;
  if constexpr (std::is_same_v<Width, Wide>) {
    for (; x + lane_count<Wide>() <= width; x += lane_count<Wide>()) {
      const VI reversed = lanes::Reverse(I(), pair_up<1>(in + x, out + x));
      lanes::StoreU(reversed, I(), pairs + width - x - lane_count<Wide>());
    }
  }
  const Pixel* const last_in = in + width - 1;
  const Pixel* const last_out = out + width - 1;
  for (int i = 0; i < width - x; ++i) pairs[i] = Width::pair_of(last_in[-i], last_out[-i]);
}

/// Multiplies pairs of small numbers; the products stay small.
inline void scale_pairs(std::int32_t* pairs, int count, int scale) {
  const I i32;
  for (int x = 0; x < count; x += lane_count<Wide>()) {
    lanes::StoreU(lanes::Mul(lanes::LoadU(i32, pairs + x), lanes::Set(i32, scale)), i32, pairs + x);
  }
}

/// Masks of the existing candidates: all bits set, or none.
template <class Width>
struct Existence {
  using Sum = typename Width::Sum;
  Scratch<Sum> inside;  // of a reversed row: mask of existing pixels
  Scratch<Sum> within;  // [lane]: mask of existing candidates
  explicit Existence(const Geometry& g) : inside(g.length + 16), within(g.lanes) {
    std::fill_n(inside.data() + g.pad, g.width, Sum{-1});
    std::fill_n(within.data(), g.count, Sum{-1});
  }
};

/// The numbers of a strip and its geometry as local variables: behind a reference, the compiler must assume
/// that vector stores change them, and would reload them for every vector.
template <class Width>
struct Rows {
  using Sum = typename Width::Sum;
  Geometry g;
  int rows;
  Sum* column_sums;
  Sum* box;
  const Sum* left_pairs;
  const Sum* right_pairs;
  const Sum* inside;  // reversed
  const Sum* within;  // [lane]
  const std::int32_t* l;
  const std::int32_t* ll;
  const std::int32_t* variance_l;
  const float* inverse_l;
  const std::int32_t* r;
  const std::int32_t* rr;
  const std::int32_t* variance_r;
  const float* inverse_r;
  const std::int32_t* l_before;  // [entry]
  const std::int32_t* ll_before;
  const std::int32_t* r_before;
  const std::int32_t* rr_before;
  int cut_first_x;
  int cut_stride;
  const std::int32_t* cut_l;
  const std::int32_t* cut_ll;
  const float* cut_inverse_l;

  Rows(const Strip<Width>& strip, const Geometry& geometry, const Existence<Width>& exists)
      : g(geometry),
        rows(strip.rows),
        column_sums(strip.column_sums.data()),
        box(strip.box.data()),
        left_pairs(strip.left_pairs.data()),
        right_pairs(strip.right_pairs.data()),
        inside(exists.inside.data()),
        within(exists.within.data()),
        l(strip.left.sum.data()),
        ll(strip.left.energy.data()),
        variance_l(strip.left.variance.data()),
        inverse_l(strip.left.inverse.data()),
        r(strip.right.sum.data()),
        rr(strip.right.energy.data()),
        variance_r(strip.right.variance.data()),
        inverse_r(strip.right.inverse.data()),
        l_before(strip.left.sum_before.data() + strip.left.lead),
        ll_before(strip.left.energy_before.data() + strip.left.lead),
        r_before(strip.right.sum_before.data() + strip.right.lead),
        rr_before(strip.right.energy_before.data() + strip.right.lead),
        cut_first_x(strip.cut.first_x),
        cut_stride(strip.cut.stride),
        cut_l(strip.cut.sum.data()),
        cut_ll(strip.cut.energy.data()),
        cut_inverse_l(strip.cut.inverse.data()) {}
};

// ----------------------------------------------------------------------------------------------------
// Formulas: from exact integer sums to a float cost. One rounding per operation, none fused, so every target
// gets the same bits. n: number of pixels; l, r: sums of the left and right pixels; ll, rr: of their squares.

/// n·a − b·c, rounded once. In 32 bits if the result is known to fit, whatever the products do.
template <bool kDouble>
CAIRN_LANES_INLINE VF difference(VI n, VI a, VI b, VI c) {
  if constexpr (kDouble) {
    return lanes::ExactDifference(F(), n, a, b, c);
  } else {
    return lanes::ConvertTo(F(), lanes::Sub(lanes::Mul(n, a), lanes::Mul(b, c)));
  }
}

/// 1/√(n·energy − sum²) for zncc, 1/√energy for nssd; 0 where that is 1/0.
template <Cost kCost, bool kDouble>
CAIRN_LANES_INLINE VF inverse_root(VI n, VI energy, VI sum) {
  const F f;
  if constexpr (kCost != Cost::nssd && kCost != Cost::zncc) return lanes::Zero(f);
  const VF v = kCost == Cost::nssd ? lanes::ConvertTo(f, energy) : difference<kDouble>(n, energy, sum, sum);
  return lanes::IfThenElseZero(lanes::Gt(v, lanes::Zero(f)), lanes::Div(lanes::Set(f, 1.0F), lanes::Sqrt(v)));
}

/// The sums that turn a box sum into a cost: of the left and of the right windows.
struct LeftSums {
  VI n;
  VI n_of_box;  // n over the scale of box sums
  VI l, ll;
  VF inverse_n, inverse_l;
};
struct RightSums {
  VI r, rr;
  VF inverse_r;
};

/// sad, zsad: the box sum is the cost.
template <Cost kCost>
CAIRN_LANES_INLINE VF cost_of(VI box) {
  const VF cost = lanes::ConvertTo(F(), box);
  return kCost == Cost::zsad ? lanes::Mul(cost, lanes::Set(F(), 1.0F / kMeanSteps)) : cost;
}

template <Cost kCost, bool kDouble>
CAIRN_LANES_INLINE VF cost_of(VI box, const LeftSums& left, const RightSums& right) {
  const F f;
  if constexpr (kCost == Cost::zncc) {
    const VF correlation = lanes::Mul(difference<kDouble>(left.n_of_box, box, left.l, right.r),
                                      lanes::Mul(left.inverse_l, right.inverse_r));
    return lanes::Sub(lanes::Set(f, 1.0F), correlation);
  } else {
    // Σ(L−R)² = ΣL² + ΣR² − 2ΣLR
    const VI ssd = lanes::Sub(lanes::Add(left.ll, right.rr), lanes::Add(box, box));
    if constexpr (kCost == Cost::ssd) {
      return lanes::ConvertTo(f, ssd);
    } else if constexpr (kCost == Cost::nssd) {
      const VF inverse = lanes::Mul(left.inverse_l, right.inverse_r);
      return lanes::IfThenElse(lanes::Gt(inverse, lanes::Zero(f)),
                               lanes::Mul(lanes::ConvertTo(f, ssd), inverse), lanes::Set(f, 65536.0F));
    } else {
      const VI l_minus_r = lanes::Sub(left.l, right.r);
      if constexpr (kDouble)
        return lanes::Mul(difference<kDouble>(left.n, ssd, l_minus_r, l_minus_r), left.inverse_n);
      const VI n_ssd = lanes::Sub(lanes::Mul(left.n, lanes::Add(left.ll, right.rr)),
                                  lanes::Mul(left.n_of_box, lanes::Add(box, box)));
      const VI zssd = lanes::Sub(n_ssd, lanes::Mul(l_minus_r, l_minus_r));
      return lanes::Mul(lanes::ConvertTo(f, zssd), left.inverse_n);
    }
  }
}

/// The same for left.n_of_box = 1. For zssd the moments of `left` and `right` are N·ΣL² − (ΣL)² and N·ΣR² −
/// (ΣR)² instead of ΣL² and ΣR².
template <Cost kCost>
CAIRN_LANES_INLINE VF cost_of_whole(VI box, const LeftSums& left, const RightSums& right) {
  const F f;
  const VI covariance = lanes::Sub(box, lanes::Mul(left.l, right.r));
  if constexpr (kCost == Cost::zncc) {
    const VF correlation =
        lanes::Mul(lanes::ConvertTo(f, covariance), lanes::Mul(left.inverse_l, right.inverse_r));
    return lanes::Sub(lanes::Set(f, 1.0F), correlation);
  } else {
    const VI zssd = lanes::Sub(lanes::Add(left.ll, right.rr), lanes::Add(covariance, covariance));
    return lanes::Mul(lanes::ConvertTo(f, zssd), left.inverse_n);
  }
}

// ----------------------------------------------------------------------------------------------------
// The windows' own sums

/// Moves the sums of the columns one row down. kSign: the sign of the outgoing row in the pairs.
template <int kSign>
void move_down(Moments& m, const std::int32_t* pairs) {
  const I i32;
  const VI difference_signs = lanes::Set(i32, Wide::pair_of(1, -kSign));
  const VI sum_signs = lanes::Set(i32, Wide::pair_of(1, kSign));
  std::int32_t* const sums = m.column_sum.data() + m.lead;
  std::int32_t* const energies = m.column_energy.data() + m.lead;
  for (int e = m.first, end = m.first + m.width; e < end; e += lane_count<Wide>()) {
    const VI pair = lanes::LoadU(i32, pairs + e);
    const VI change = lanes::DotPairs(i32, pair, difference_signs);
    const VI squares = lanes::Mul(change, lanes::DotPairs(i32, pair, sum_signs));  // a² − b² = (a − b)(a + b)
    lanes::StoreU(lanes::Add(lanes::LoadU(i32, sums + e), change), i32, sums + e);
    lanes::StoreU(lanes::Add(lanes::LoadU(i32, energies + e), squares), i32, energies + e);
  }
}

inline void sum_up_columns(Moments& m) {
  const std::int32_t* const column_sum = m.column_sum.data();
  const std::int32_t* const column_energy = m.column_energy.data();
  std::int32_t* const sum_before = m.sum_before.data();
  std::int32_t* const energy_before = m.energy_before.data();
  const lanes::CappedTag<std::int32_t, 4> d;
  auto sum = lanes::Zero(d);
  auto energy = lanes::Zero(d);
  for (int e = 0, count = length(m.column_sum); e < count; e += static_cast<int>(lanes::Lanes(d))) {
    sum = lanes::RunningSum(d, sum, lanes::Load(d, column_sum + e));
    energy = lanes::RunningSum(d, energy, lanes::Load(d, column_energy + e));
    lanes::StoreU(sum, d, sum_before + e + 1);
    lanes::StoreU(energy, d, energy_before + e + 1);
  }
}

/// The sums of every window, from those of the columns. `rows`: rows of the window inside.
template <Cost kCost, bool kDouble>
void sum_windows(Moments& m, int rows) {
  const I i32;
  sum_up_columns(m);
  const std::int32_t* const sum_before = m.sum_before.data() + m.lead - m.half;
  const std::int32_t* const energy_before = m.energy_before.data() + m.lead - m.half;
  const std::int32_t* const columns = m.columns.data();
  std::int32_t* const sums = m.sum.data();
  std::int32_t* const energies = m.energy.data();
  [[maybe_unused]] std::int32_t* const variances = m.variance.data();
  [[maybe_unused]] float* const inverses = m.inverse.data();
  const int window = 2 * m.half + 1;
  for (int e = m.first, end = m.first + m.width; e < end; e += lane_count<Wide>()) {
    const VI sum = lanes::Sub(lanes::LoadU(i32, sum_before + e + window), lanes::LoadU(i32, sum_before + e));
    const VI energy =
        lanes::Sub(lanes::LoadU(i32, energy_before + e + window), lanes::LoadU(i32, energy_before + e));
    const VI n = lanes::Mul(lanes::Set(i32, rows), lanes::LoadU(i32, columns + e));
    lanes::StoreU(sum, i32, sums + e);
    lanes::StoreU(energy, i32, energies + e);
    if constexpr (kCost == Cost::zssd) {
      const VI variance = lanes::Sub(lanes::Mul(n, energy), lanes::Mul(sum, sum));
      lanes::StoreU(variance, i32, variances + e);
    }
    if constexpr (kCost == Cost::nssd || kCost == Cost::zncc)
      lanes::StoreU(inverse_root<kCost, kDouble>(n, energy, sum), F(), inverses + e);
  }
}

/// The same for windows cut by the right image.
template <Cost kCost, bool kDouble>
void sum_cut_windows(const Moments& left, int rows, CutWindows& cut) {
  const lanes::CappedTag<std::int32_t, 4> few;
  const int half = cut.half;
  const std::int32_t* const sum_before = left.sum_before.data() + left.lead + left.first;  // [x]
  const std::int32_t* const energy_before = left.energy_before.data() + left.lead + left.first;
  std::int32_t* sums = cut.sum.data() + kMargin;
  std::int32_t* energies = cut.energy.data() + kMargin;
  for (int x = cut.first_x, end = x + cut.count, stride = cut.stride; x < end; ++x) {
    const auto sum_up_to = lanes::Set(few, sum_before[x + half + 1]);
    const auto energy_up_to = lanes::Set(few, energy_before[x + half + 1]);
    for (int i = 0; i < half; i += static_cast<int>(lanes::Lanes(few))) {
      const int d = x - half + 1 + i;
      lanes::StoreU(lanes::Sub(sum_up_to, lanes::LoadU(few, sum_before + d)), few, sums + i);
      lanes::StoreU(lanes::Sub(energy_up_to, lanes::LoadU(few, energy_before + d)), few, energies + i);
    }
    sums += stride;
    energies += stride;
  }
  const I i32;
  for (int e = kMargin, end = kMargin + cut.count * cut.stride; e < end; e += lane_count<Wide>()) {
    const VI n = lanes::Mul(lanes::Set(i32, rows), lanes::Load(i32, cut.columns.data() + e));
    const VI energy = lanes::Load(i32, cut.energy.data() + e);
    const VI sum = lanes::Load(i32, cut.sum.data() + e);
    lanes::Store(inverse_root<kCost, kDouble>(n, energy, sum), F(), cut.inverse.data() + e);
  }
}

/// Without clipping at the left or right: the sums of each image.
CAIRN_LANES_INLINE LeftSums own_left_sums(const Rows<Wide>& in, int x) {
  const I i32;
  const F f;
  const int e = in.g.pad + x;
  const int n = in.rows * (2 * in.g.half + 1);
  return {lanes::Set(i32, n),
          lanes::Mul(lanes::Set(i32, n), lanes::Set(i32, in.g.unscale)),
          lanes::Set(i32, in.l[e]),
          lanes::Set(i32, in.ll[e]),
          lanes::Set(f, 1.0F / static_cast<float>(n)),
          lanes::Set(f, in.inverse_l[e])};
}
CAIRN_LANES_INLINE RightSums own_right_sums(const Rows<Wide>& in, int j) {
  return {lanes::LoadU(I(), in.r + j), lanes::LoadU(I(), in.rr + j), lanes::LoadU(F(), in.inverse_r + j)};
}

/// The sum over the left window's columns from max(begin, d) to min(end, width + d) − 1, lane by lane.
CAIRN_LANES_INLINE VI clipped_left_sum(const std::int32_t* before, const Geometry& g, int begin, int end,
                                       int i) {
  const I i32;
  const VI d = lanes::CountFrom(i32, g.first_d + i);
  const std::int32_t* const at = before + g.pad;  // [x]
  const VI low = lanes::IfThenElse(lanes::Gt(d, lanes::Set(i32, begin)),
                                   lanes::LoadU(i32, at + g.first_d + i), lanes::Set(i32, at[begin]));
  const VI high =
      lanes::IfThenElse(lanes::Lt(d, lanes::Set(i32, end - g.width)),
                        lanes::LoadU(i32, at + g.width + g.first_d + i), lanes::Set(i32, at[end]));
  return lanes::Sub(high, low);
}

/// The sum over the partners of the same columns. A partner outside has a column of 0 and need not be
/// skipped.
CAIRN_LANES_INLINE VI clipped_right_sum(const std::int32_t* before, const Geometry& g, int begin, int end,
                                        int i) {
  const I i32;
  const std::int32_t* const at = before + i;  // [first lane]
  return lanes::Sub(lanes::LoadU(i32, at + g.first_lane(begin) + 1),
                    lanes::LoadU(i32, at + g.first_lane(end - 1)));
}

/// The same near the left and right borders: over columns inside both images, lane by lane.
template <Cost kCost, bool kDouble>
CAIRN_LANES_INLINE VF clipped_cost(const Rows<Wide>& in, VI box, int x, int i) {
  const I i32;
  const F f;
  const Geometry& g = in.g;
  const int begin = std::max(x - g.half, 0);
  const int end = std::min(x + g.half + 1, g.width);
  const VI d = lanes::CountFrom(i32, g.first_d + i);
  const VI columns = lanes::Sub(lanes::Min(lanes::Set(i32, end), lanes::Add(lanes::Set(i32, g.width), d)),
                                lanes::Max(lanes::Set(i32, begin), d));
  LeftSums left;
  left.n = lanes::Mul(lanes::Set(i32, in.rows), columns);
  left.n_of_box = lanes::Mul(left.n, lanes::Set(i32, g.unscale));
  left.inverse_n = lanes::Div(lanes::Set(f, 1.0F), lanes::ConvertTo(f, left.n));
  const int least_d = g.first_d + i;
  const int most_d = least_d + lane_count<Wide>() - 1;
  if (begin >= most_d && end <= g.width + least_d) {
    // Only the border of the left image itself clips its window.
    const int e = g.pad + x;
    left.l = lanes::Set(i32, in.l[e]);
    left.ll = lanes::Set(i32, in.ll[e]);
    left.inverse_l = lanes::Set(f, in.inverse_l[e]);
  } else {
    left.l = clipped_left_sum(in.l_before, g, begin, end, i);
    left.ll = clipped_left_sum(in.ll_before, g, begin, end, i);
    left.inverse_l = inverse_root<kCost, kDouble>(left.n, left.ll, left.l);
  }
  RightSums right = own_right_sums(in, g.first_lane(x) + i);
  // The right windows are already clipped by their own image, unless the left one clips more.
  if (end - begin < 2 * g.half + 1) {
    right.r = clipped_right_sum(in.r_before, g, begin, end, i);
    right.rr = clipped_right_sum(in.rr_before, g, begin, end, i);
    right.inverse_r = inverse_root<kCost, kDouble>(left.n, right.rr, right.r);
  }
  return cost_of<kCost, kDouble>(box, left, right);
}

/// The same if only the left border of the right image cuts windows, at least one of them.
template <Cost kCost, bool kDouble>
CAIRN_LANES_INLINE VF cut_cost(const Rows<Wide>& in, VI box, int x, int i) {
  const I i32;
  const F f;
  const Geometry& g = in.g;
  const VI d = lanes::CountFrom(i32, g.first_d + i);
  const auto cut = lanes::Gt(d, lanes::Set(i32, x - g.half));
  const auto cut_f = lanes::RebindMask(f, cut);
  const int at = kMargin + (x - in.cut_first_x) * in.cut_stride + g.first_d + i - (x - g.half + 1);
  const int e = g.pad + x;
  const VI columns =
      lanes::Min(lanes::Set(i32, 2 * g.half + 1), lanes::Sub(lanes::Set(i32, x + g.half + 1), d));
  LeftSums left;
  left.n = lanes::Mul(lanes::Set(i32, in.rows), columns);
  left.n_of_box = lanes::Mul(left.n, lanes::Set(i32, g.unscale));
  left.l = lanes::IfThenElse(cut, lanes::LoadU(i32, in.cut_l + at), lanes::Set(i32, in.l[e]));
  left.ll = lanes::IfThenElse(cut, lanes::LoadU(i32, in.cut_ll + at), lanes::Set(i32, in.ll[e]));
  left.inverse_n = lanes::Div(lanes::Set(f, 1.0F), lanes::ConvertTo(f, left.n));
  left.inverse_l =
      lanes::IfThenElse(cut_f, lanes::LoadU(f, in.cut_inverse_l + at), lanes::Set(f, in.inverse_l[e]));
  return cost_of<kCost, kDouble>(box, left, own_right_sums(in, g.first_lane(x) + i));
}

// ----------------------------------------------------------------------------------------------------
// Running sums

/// The change of the columns in this row: the pairs of a left pixel and of its candidates.
template <Cost kCost, class Width>
CAIRN_LANES_INLINE lanes::Vec<typename Width::SumTag> change_of(lanes::Vec<typename Width::SumTag> left,
                                                                lanes::Vec<typename Width::SumTag> right) {
  const typename Width::SumTag d;
  if constexpr (correlates(kCost)) {
    return lanes::DotPairs(d, left, right);
  } else {
    return lanes::AbsChange<Width::kShift>(d, left, right);
  }
}
/// The same near the border. `left`: the pair of a pixel in every lane; `j`: position of its candidates.
template <Cost kCost, class Width, bool kBorder>
CAIRN_LANES_INLINE lanes::Vec<typename Width::SumTag> change_of(const Rows<Width>& in,
                                                                lanes::Vec<typename Width::SumTag> left,
                                                                int j) {
  const typename Width::SumTag d;
  const auto change = change_of<kCost, Width>(left, lanes::LoadU(d, in.right_pairs + j));
  // Partners outside the image do not count; for correlations they are 0 anyway.
  return kBorder && !correlates(kCost) ? lanes::And(change, lanes::LoadU(d, in.inside + j)) : change;
}

/// Updates the columns of left pixel x with this row, and the box with them.
template <Cost kCost, class Width, int kLanes, bool kBorder>
CAIRN_LANES_INLINE void enter(const Rows<Width>& in, int first, int x,
                              lanes::Vec<typename Width::SumTag> (&box)[kVectors<Width, kLanes>]) {
  const typename Width::SumTag d;
  typename Width::Sum* const sums = in.column_sums + in.g.column(x, first);
  const int j = in.g.first_lane(x) + first;
  const auto left = lanes::Set(d, in.left_pairs[in.g.pad + x]);
  CAIRN_UNROLL
  for (int v = 0; v < kVectors<Width, kLanes>; ++v) {
    const int at = v * lane_count<Width>();
    const auto column =
        lanes::Add(lanes::Load(d, sums + at), change_of<kCost, Width, kBorder>(in, left, j + at));
    lanes::Store(column, d, sums + at);
    box[v] = lanes::Add(box[v], column);
  }
}

/// Before the first pixel of a row: initialises the box of a tile with the columns x < end.
template <Cost kCost, class Width, int kLanes>
void begin_box(const Rows<Width>& rows, int first, int end) {
  const typename Width::SumTag d;
  const Rows<Width> in(rows);
  lanes::Vec<typename Width::SumTag> box[kVectors<Width, kLanes>];
  for (int i = 0; i < kLanes; ++i) in.box[first + i] = Width::empty_box(i);
  CAIRN_UNROLL
  for (int v = 0; v < kVectors<Width, kLanes>; ++v)
    box[v] = lanes::Load(d, in.box + first + v * lane_count<Width>());
  for (int x = 0; x < end; ++x) enter<kCost, Width, kLanes, true>(in, first, x, box);
  CAIRN_UNROLL
  for (int v = 0; v < kVectors<Width, kLanes>; ++v)
    lanes::Store(box[v], d, in.box + first + v * lane_count<Width>());
}

/// The cost of a box, kNone without candidate: lanes from i on of left pixel x. Only with kBorder can
/// candidates be missing, or windows be clipped.
template <Cost kCost, class Width, bool kDouble, bool kBorder>
CAIRN_LANES_INLINE lanes::Vec<typename Width::CostTag> cost_at(const Rows<Width>& in, int x, int i,
                                                               lanes::Vec<typename Width::SumTag> box,
                                                               const LeftSums& left) {
  const typename Width::CostTag d;
  const typename Width::SumTag d_sum;
  const Geometry& g = in.g;
  const int j = g.first_lane(x) + i;
  lanes::Vec<typename Width::CostTag> cost;
  bool some_missing = kBorder;
  if constexpr (std::is_base_of_v<Narrow, Width>) {
    cost = box;
  } else if constexpr (!correlates(kCost)) {
    cost = cost_of<kCost>(box);
  } else {
    const int least_d = g.first_d + i;
    const int most_d = least_d + lane_count<Width>() - 1;
    if (kBorder && (least_d > x || most_d < x - g.width + 1)) return lanes::Set(d, kNoCost);
    const bool clips = x < g.half || x >= g.width - g.half + std::min(0, least_d);
    if (kBorder && clips) {
      cost = clipped_cost<kCost, kDouble>(in, box, x, i);
    } else if (kBorder && x < g.half + most_d) {
      cost = cut_cost<kCost, kDouble>(in, box, x, i);
    } else {
      cost = cost_of<kCost, kDouble>(box, left, own_right_sums(in, j));
      some_missing = i + lane_count<Width>() > g.count;
    }
  }
  if (some_missing) {
    const auto exists = lanes::And(lanes::LoadU(d_sum, in.inside + j), lanes::Load(d_sum, in.within + i));
    const auto outside = lanes::RebindMask(d, lanes::Eq(exists, lanes::Zero(d_sum)));
    cost = lanes::IfThenElse(outside, lanes::Set(d, kNone<typename Width::Cost>), cost);
  }
  return cost;
}

/// Writes the costs of a pixel into its block.
template <Cost kCost, class Width, int kLanes>
CAIRN_LANES_INLINE void keep_costs(bool equal_tags,
                                   lanes::Vec<typename Width::SumTag> (&keys)[kVectors<Width, kLanes>],
                                   typename Width::Cost* costs) {
  constexpr int kCount = kVectors<Width, kLanes>;
  const typename Width::CostTag d;
  if (equal_tags) {
    CAIRN_UNROLL
    for (int v = 0; v < kCount; ++v) keys[v] = with_equal_tag<Width>(keys[v]);
  }
  CAIRN_UNROLL
  for (int v = 0; v < kCount; ++v)
    lanes::Store(cost_of_key<kCost, Width>(keys[v]), d, costs + v * lane_count<Width>());
}

/// The winners of left pixels x_begin … x_end − 1 among the lanes of a tile, and their costs if the block
/// keeps them. For each pixel a column joins the box and one leaves it. `pixel`: index of the first one in
/// its block.
///
/// Not to be inlined: as a separate function it gets all registers.
template <Cost kCost, class Width, bool kDouble, int kLanes, Place kPlace>
CAIRN_NOINLINE void slide(const Rows<Width>& rows, int first, int x_begin, int x_end, int pixel,
                          const Block<Width>& block) {
  constexpr int kCount = kVectors<Width, kLanes>;
  constexpr bool kBorder = kPlace != Place::inside;
  const typename Width::SumTag d;
  const Rows<Width> in(rows);
  const int half = in.g.half;
  const auto winners = block.winners[static_cast<std::size_t>(first / kTile)].places();
  const bool keeps_costs = !block.costs.empty();
  const bool equal_tags = block.equal_tags;
  const std::ptrdiff_t stride = block.costs.stride;
  typename Width::Cost* costs = keeps_costs ? block.costs.of(pixel) + first : nullptr;
  lanes::Vec<typename Width::SumTag> box[kCount];
  CAIRN_UNROLL
  for (int v = 0; v < kCount; ++v) box[v] = lanes::Load(d, in.box + first + v * lane_count<Width>());

  for (int x = x_begin; x < x_end; ++x) {
    if constexpr (kPlace != Place::right_end) enter<kCost, Width, kLanes, kBorder>(in, first, x + half, box);
    const typename Width::Sum* const leaves = in.column_sums + in.g.column(x - half - 1, first);
    LeftSums left;
    if constexpr (correlates(kCost)) left = own_left_sums(in, x);
    lanes::Vec<typename Width::SumTag> keys[1][kCount];
    CAIRN_UNROLL
    for (int v = 0; v < kCount; ++v) {
      const int at = v * lane_count<Width>();
      box[v] = lanes::Sub(box[v], lanes::Load(d, leaves + at));
      keys[0][v] = as_key<Width>(cost_at<kCost, Width, kDouble, kBorder>(in, x, first + at, box[v], left));
    }
    winners.find(pixel, keys);
    ++pixel;
    if (!keeps_costs) continue;
    keep_costs<kCost, Width, kLanes>(equal_tags, keys[0], costs);
    costs += stride;
  }
  CAIRN_UNROLL
  for (int v = 0; v < kCount; ++v) lanes::Store(box[v], d, in.box + first + v * lane_count<Width>());
}

/// The input and output of a walk along a row for one left pixel and the lanes of a tile: pointers that
/// advance together.
struct Cursor {
  const std::int32_t* left_pair;    // of the pixel whose column joins the window
  const std::int32_t* right_pairs;  // of that pixel's partners
  std::int32_t* joins;
  const std::int32_t* leaves;

  Cursor(const Rows<Wide>& in, int first, int x)
      : left_pair(in.left_pairs + in.g.pad + x + in.g.half),
        right_pairs(in.right_pairs + in.g.first_lane(x + in.g.half) + first),
        joins(in.column_sums + in.g.column(x + in.g.half, first)),
        leaves(in.column_sums + in.g.column(x - in.g.half - 1, first)) {}

  /// Advances by `pixels` to the right. `lanes_used`: of the tile.
  CAIRN_LANES_INLINE void move(int pixels, int lanes_used) {
    left_pair += pixels;
    right_pairs -= pixels;
    joins += pixels * lanes_used;
    leaves += pixels * lanes_used;
  }
};
/// The same for the sums of the windows, for costs that need them.
struct MomentsCursor {
  const std::int32_t* l = nullptr;
  const std::int32_t* ll = nullptr;
  const float* inverse_l = nullptr;
  const std::int32_t* r = nullptr;
  const std::int32_t* rr = nullptr;
  const float* inverse_r = nullptr;

  MomentsCursor() = default;
  /// `variances`: use variances instead of energies.
  MomentsCursor(const Rows<Wide>& in, int first, int x, bool variances)
      : l(in.l + in.g.pad + x),
        ll((variances ? in.variance_l : in.ll) + in.g.pad + x),
        inverse_l(in.inverse_l + in.g.pad + x),
        r(in.r + in.g.first_lane(x) + first),
        rr((variances ? in.variance_r : in.rr) + in.g.first_lane(x) + first),
        inverse_r(in.inverse_r + in.g.first_lane(x) + first) {}

  CAIRN_LANES_INLINE void move(int pixels) {
    l += pixels;
    ll += pixels;
    inverse_l += pixels;
    r -= pixels;
    rr -= pixels;
    inverse_r -= pixels;
  }
};

/// Moves the box to the left pixel `i` after the cursor. Performs each step for all vectors before the next
/// step, so that no instruction waits for the previous one.
template <Cost kCost, bool kDouble, int kLanes, bool kWhole>
CAIRN_LANES_INLINE void move_inside(const Cursor& at, const MomentsCursor& moments, int i,
                                    const LeftSums& window, VI (&box)[kVectors<Wide, kLanes>],
                                    VI (&keys)[kVectors<Wide, kLanes>]) {
  constexpr int kCount = kVectors<Wide, kLanes>;
  constexpr int kStep = kLanes / kCount;
  const I d;
  const F f;
  const VI left_pair = lanes::Set(d, at.left_pair[i]);
  VI column[kCount];
  CAIRN_UNROLL
  for (int v = 0; v < kCount; ++v)
    column[v] = change_of<kCost, Wide>(left_pair, lanes::LoadU(d, at.right_pairs - i + v * kStep));
  CAIRN_UNROLL
  for (int v = 0; v < kCount; ++v) {
    std::int32_t* const joins = at.joins + i * kLanes + v * kStep;
    column[v] = lanes::Add(lanes::Load(d, joins), column[v]);
    lanes::Store(column[v], d, joins);
  }
  CAIRN_UNROLL
  for (int v = 0; v < kCount; ++v) {
    const VI leaves = lanes::Load(d, at.leaves + i * kLanes + v * kStep);
    box[v] = lanes::Sub(lanes::Add(box[v], column[v]), leaves);
  }
  if constexpr (correlates(kCost)) {
    LeftSums left = window;
    left.l = lanes::Set(d, moments.l[i]);
    left.ll = lanes::Set(d, moments.ll[i]);
    left.inverse_l = lanes::Set(f, moments.inverse_l[i]);
    CAIRN_UNROLL
    for (int v = 0; v < kCount; ++v) {
      const int lane = v * kStep - i;
      const RightSums right{lanes::LoadU(d, moments.r + lane), lanes::LoadU(d, moments.rr + lane),
                            lanes::LoadU(f, moments.inverse_r + lane)};
      if constexpr (kWhole) {
        keys[v] = as_key<Wide>(cost_of_whole<kCost>(box[v], left, right));
      } else {
        keys[v] = as_key<Wide>(cost_of<kCost, kDouble>(box[v], left, right));
      }
    }
  } else {
    CAIRN_UNROLL
    for (int v = 0; v < kCount; ++v) keys[v] = as_key<Wide>(cost_of<kCost>(box[v]));
  }
}

/// slide() for Place::inside. kWhole: all rows of the window exist, and box sums are scaled for that.
template <Cost kCost, bool kDouble, int kLanes, bool kWhole>
CAIRN_NOINLINE void slide_inside(const Rows<Wide>& in, int first, int x_begin, int x_end, int pixel,
                                 const Block<Wide>& block) {
  constexpr int kCount = kVectors<Wide, kLanes>;
  const I d;
  const auto winners = block.winners[static_cast<std::size_t>(first / kTile)].places();
  const bool keeps_costs = !block.costs.empty();
  const std::ptrdiff_t stride = block.costs.stride;
  float* costs = keeps_costs ? block.costs.of(pixel) + first : nullptr;
  LeftSums window{};
  MomentsCursor moments;
  if constexpr (correlates(kCost)) {
    window = own_left_sums(in, x_begin);  // n is the same for all
    moments = MomentsCursor(in, first, x_begin, kWhole && kCost == Cost::zssd);
  }
  std::int32_t* const kept_box = in.box + first;
  VI box[kCount];
  CAIRN_UNROLL
  for (int v = 0; v < kCount; ++v) box[v] = lanes::Load(d, kept_box + v * lane_count<Wide>());
  Cursor at(in, first, x_begin);
  const int last_pixel = pixel + x_end - x_begin;
  const auto move_on = [&]<int kPixels>() {
    VI keys[kPixels][kCount];
    CAIRN_UNROLL
    for (int i = 0; i < kPixels; ++i)
      move_inside<kCost, kDouble, kLanes, kWhole>(at, moments, i, window, box, keys[i]);
    at.move(kPixels, kLanes);
    if constexpr (correlates(kCost)) moments.move(kPixels);
    winners.find(pixel, keys);
    if (!keeps_costs) return;
    CAIRN_UNROLL
    for (int i = 0; i < kPixels; ++i) keep_costs<kCost, Wide, kLanes>(false, keys[i], costs + i * stride);
    costs += kPixels * stride;
  };
  if constexpr (lanes::kManyCosts) {
    constexpr int kPixels = lanes::kFolded<I>;
    for (; !keeps_costs && pixel + kPixels <= last_pixel; pixel += kPixels)
      move_on.template operator()<kPixels>();
  }
  for (; pixel < last_pixel; ++pixel) move_on.template operator()<1>();
  CAIRN_UNROLL
  for (int v = 0; v < kCount; ++v) lanes::Store(box[v], d, kept_box + v * lane_count<Wide>());
}

/// slide(), or a faster equivalent.
template <Cost kCost, class Width, bool kDouble, int kLanes, Place kPlace>
void slide_along(const Rows<Width>& in, int first, int x_begin, int x_end, int pixel,
                 const Block<Width>& block) {
  if constexpr (kPlace != Place::inside || !std::is_same_v<Width, Wide>) {
    slide<kCost, Width, kDouble, kLanes, kPlace>(in, first, x_begin, x_end, pixel, block);
  } else {
    if constexpr (takes_covariance(kCost) && !kDouble) {
      if (in.g.scale == in.rows * (2 * in.g.half + 1)) {
        slide_inside<kCost, kDouble, kLanes, true>(in, first, x_begin, x_end, pixel, block);
        return;
      }
    }
    slide_inside<kCost, kDouble, kLanes, false>(in, first, x_begin, x_end, pixel, block);
  }
}

}  // namespace
}  // namespace cairn::kernels::CAIRN_KERNEL_TARGET
