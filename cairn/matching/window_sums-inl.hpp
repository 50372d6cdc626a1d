// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// No include guard: compiled once for each target, over the vocabulary `lanes` of that target.
//
// Running sums over windows, and the costs that they make.

namespace cairn::kernels::CAIRN_KERNEL_TARGET {
namespace {

/// Sums of one image's own windows for the current row, each clipped at that image's borders. Entries: the
/// pixels of the row in the order of its pairs, with margins before and after.
struct Moments {
  int half;
  int first;                            // entry of a pixel
  int width;                            // so many are
  Scratch<std::int32_t> column_sum;     // [entry + half]
  Scratch<std::int32_t> column_energy;  // likewise, of squares
  Scratch<std::int32_t>
      sum_before;  // [entry + half]: over the columns before the entry; may wrap, differences do not
  Scratch<std::int32_t> energy_before;
  Scratch<std::int32_t> columns;  // [entry]: of the window, those inside the image
  Scratch<std::int32_t> sum;
  Scratch<std::int32_t> energy;
  Scratch<float> inverse;  // root, as the operator asks for it

  /// Operators that compare nothing but differences need none.
  Moments(const Geometry& g, bool wanted)
      : half(g.half),
        first(g.pad),
        width(wanted ? g.width : 0),
        column_sum(wanted ? round_up(g.length + 2 * half + 16, 16) : 0),
        column_energy(column_sum.size()),
        sum_before(column_sum.size() + 1),
        energy_before(column_sum.size() + 1),
        columns(wanted ? g.length + 16 : 0),
        sum(columns.size()),
        energy(columns.size()),
        inverse(columns.size()) {
    for (int x = 0; x < width; ++x) {
      columns[first + x] = std::min(x + half, width - 1) - std::max(x - half, 0) + 1;
    }
  }
};

/// What one row of the right image (the left row's own, or one of its band) is correlated with.
template <class Width>
struct Strip {
  using Sum = typename Width::Sum;
  int row;                   // of the right image, relative to the left one's
  int rows = 0;              // of the window, those inside both images
  Scratch<Sum> column_sums;  // Geometry::column(); in units of 1/2^Width::kShift
  Scratch<Sum> box;          // [lane]
  Scratch<Sum> left_pairs;   // [pad + x]
  Scratch<Sum> right_pairs;  // reversed
  Moments left;
  Moments right;

  Strip(int strip_row, const Geometry& g, bool with_moments)
      : row(strip_row),
        column_sums(g.columns() * g.lanes),
        box(g.lanes),
        left_pairs(g.length + 16),
        right_pairs(g.length + 16),
        left(g, with_moments),
        right(g, with_moments) {}
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

/// Lays the pixels of two rows side by side, one that comes in and one that goes out, the latter times kSign.
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
/// The same, the last pixel first.
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

/// Which candidates there are at all: all bits set, or none.
template <class Width>
struct Existence {
  using Sum = typename Width::Sum;
  Scratch<Sum> inside;  // of a reversed row: is there such a pixel?
  Scratch<Sum> within;  // [lane]: is there such a candidate?
  explicit Existence(const Geometry& g) : inside(g.length + 16), within(g.lanes) {
    std::fill_n(inside.data() + g.pad, g.width, Sum{-1});
    std::fill_n(within.data(), g.count, Sum{-1});
  }
};

/// A strip's and its geometry's numbers as plain locals: the compiler must assume that a vector store changes
/// whatever is reached through a reference, and would fetch it anew for every vector.
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
  const float* inverse_l;
  const std::int32_t* r;
  const std::int32_t* rr;
  const float* inverse_r;
  const std::int32_t* l_before;  // [entry + half]
  const std::int32_t* ll_before;
  const std::int32_t* r_before;
  const std::int32_t* rr_before;

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
        inverse_l(strip.left.inverse.data()),
        r(strip.right.sum.data()),
        rr(strip.right.energy.data()),
        inverse_r(strip.right.inverse.data()),
        l_before(strip.left.sum_before.data()),
        ll_before(strip.left.energy_before.data()),
        r_before(strip.right.sum_before.data()),
        rr_before(strip.right.energy_before.data()) {}
};

// ----------------------------------------------------------------------------------------------------
// Formulas: pixel_math.hpp, lane by lane

/// n·a − b·c, rounded once. In 32 bits where the result is known to fit them, whatever the products do.
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

/// The sums that turn a box sum into a cost, in the notation of pixel_math.hpp: of the left window, and of
/// the right ones.
struct LeftSums {
  VI n, l, ll;
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
  return kCost == Cost::zsad ? lanes::Mul(cost, lanes::Set(F(), 1.0F / pixel_math::kMeanSteps)) : cost;
}

template <Cost kCost, bool kDouble>
CAIRN_LANES_INLINE VF cost_of(VI box, const LeftSums& left, const RightSums& right) {
  const F f;
  if constexpr (kCost == Cost::zncc) {
    const VF correlation = lanes::Mul(difference<kDouble>(left.n, box, left.l, right.r),
                                      lanes::Mul(left.inverse_l, right.inverse_r));
    return lanes::Max(lanes::Zero(f), lanes::Sub(lanes::Set(f, 1.0F), correlation));
  } else {
    // Σ(L−R)² = ΣL² + ΣR² − 2ΣLR
    const VI ssd = lanes::Sub(lanes::Add(left.ll, right.rr), lanes::Add(box, box));
    if constexpr (kCost == Cost::ssd) {
      return lanes::ConvertTo(f, ssd);
    } else if constexpr (kCost == Cost::nssd) {
      const VF inverse = lanes::Mul(left.inverse_l, right.inverse_r);
      return lanes::IfThenElse(lanes::Gt(inverse, lanes::Zero(f)),
                               lanes::Mul(lanes::ConvertTo(f, ssd), inverse),
                               lanes::Set(f, pixel_math::kNoEnergyCost));
    } else {
      const VI l_minus_r = lanes::Sub(left.l, right.r);
      return lanes::Mul(difference<kDouble>(left.n, ssd, l_minus_r, l_minus_r), left.inverse_n);
    }
  }
}

// ----------------------------------------------------------------------------------------------------
// The windows' own sums

/// The columns' sums, one row further down. kSign: with which the pairs hold the row that goes out.
template <int kSign>
void move_down(Moments& m, const std::int32_t* pairs) {
  const I i32;
  const VI difference_signs = lanes::Set(i32, Wide::pair_of(1, -kSign));
  const VI sum_signs = lanes::Set(i32, Wide::pair_of(1, kSign));
  std::int32_t* const sums = m.column_sum.data() + m.half;
  std::int32_t* const energies = m.column_energy.data() + m.half;
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
  for (int e = 0, count = m.column_sum.size(); e < count; e += static_cast<int>(lanes::Lanes(d))) {
    sum = lanes::RunningSum(d, sum, lanes::Load(d, column_sum + e));
    energy = lanes::RunningSum(d, energy, lanes::Load(d, column_energy + e));
    lanes::StoreU(sum, d, sum_before + e + 1);
    lanes::StoreU(energy, d, energy_before + e + 1);
  }
}

/// Every window's own sums, out of the columns'. `rows`: of the window, those inside.
template <Cost kCost, bool kDouble>
void sum_windows(Moments& m, int rows) {
  const I i32;
  sum_up_columns(m);
  const std::int32_t* const sum_before = m.sum_before.data();
  const std::int32_t* const energy_before = m.energy_before.data();
  const std::int32_t* const columns = m.columns.data();
  std::int32_t* const sums = m.sum.data();
  std::int32_t* const energies = m.energy.data();
  float* const inverses = m.inverse.data();
  const int window = 2 * m.half + 1;
  for (int e = m.first, end = m.first + m.width; e < end; e += lane_count<Wide>()) {
    const VI sum = lanes::Sub(lanes::LoadU(i32, sum_before + e + window), lanes::LoadU(i32, sum_before + e));
    const VI energy =
        lanes::Sub(lanes::LoadU(i32, energy_before + e + window), lanes::LoadU(i32, energy_before + e));
    const VI n = lanes::Mul(lanes::Set(i32, rows), lanes::LoadU(i32, columns + e));
    lanes::StoreU(sum, i32, sums + e);
    lanes::StoreU(energy, i32, energies + e);
    lanes::StoreU(inverse_root<kCost, kDouble>(n, energy, sum), F(), inverses + e);
  }
}

/// Where no window is clipped at the left or right: each image's own.
CAIRN_LANES_INLINE LeftSums own_left_sums(const Rows<Wide>& in, int x) {
  const I i32;
  const F f;
  const int e = in.g.pad + x;
  const int n = in.rows * (2 * in.g.half + 1);
  return {lanes::Set(i32, n), lanes::Set(i32, in.l[e]), lanes::Set(i32, in.ll[e]),
          lanes::Set(f, 1.0F / static_cast<float>(n)), lanes::Set(f, in.inverse_l[e])};
}
CAIRN_LANES_INLINE RightSums own_right_sums(const Rows<Wide>& in, int j) {
  return {lanes::LoadU(I(), in.r + j), lanes::LoadU(I(), in.rr + j), lanes::LoadU(F(), in.inverse_r + j)};
}

/// The sum over the left window's columns from max(begin, d) to min(end, width + d) − 1, lane by lane.
CAIRN_LANES_INLINE VI clipped_left_sum(const std::int32_t* before, const Geometry& g, int begin, int end,
                                       int i) {
  const I i32;
  const VI d = lanes::CountFrom(i32, g.first_d + i);
  const std::int32_t* const at = before + g.half + g.pad;  // [x]
  const VI low = lanes::IfThenElse(lanes::Gt(d, lanes::Set(i32, begin)),
                                   lanes::LoadU(i32, at + g.first_d + i), lanes::Set(i32, at[begin]));
  const VI high =
      lanes::IfThenElse(lanes::Lt(d, lanes::Set(i32, end - g.width)),
                        lanes::LoadU(i32, at + g.width + g.first_d + i), lanes::Set(i32, at[end]));
  return lanes::Sub(high, low);
}

/// The sum over the same columns' partners. Where a partner lies outside, its column is 0 and need not be
/// left out.
CAIRN_LANES_INLINE VI clipped_right_sum(const std::int32_t* before, const Geometry& g, int begin, int end,
                                        int i) {
  const I i32;
  const std::int32_t* const at = before + g.half + i;  // [first lane]
  return lanes::Sub(lanes::LoadU(i32, at + g.first_lane(begin) + 1),
                    lanes::LoadU(i32, at + g.first_lane(end - 1)));
}

/// The same near the left and right borders: of those columns alone that lie inside both images, lane by
/// lane.
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
  left.l = clipped_left_sum(in.l_before, g, begin, end, i);
  left.ll = clipped_left_sum(in.ll_before, g, begin, end, i);
  left.inverse_n = lanes::Div(lanes::Set(f, 1.0F), lanes::ConvertTo(f, left.n));
  left.inverse_l = inverse_root<kCost, kDouble>(left.n, left.ll, left.l);
  RightSums right = own_right_sums(in, g.first_lane(x) + i);
  // The right windows are clipped by their own image already, unless the left one cuts off more.
  if (end - begin < 2 * g.half + 1) {
    right.r = clipped_right_sum(in.r_before, g, begin, end, i);
    right.rr = clipped_right_sum(in.rr_before, g, begin, end, i);
    right.inverse_r = inverse_root<kCost, kDouble>(left.n, right.rr, right.r);
  }
  return cost_of<kCost, kDouble>(box, left, right);
}

// ----------------------------------------------------------------------------------------------------
// Running sums

/// By how much the columns of a left pixel change with this row. `left`: its pair in every lane; `j`: where
/// its partners stand.
template <Cost kCost, class Width, bool kBorder>
CAIRN_LANES_INLINE lanes::Vec<typename Width::SumTag> change_of(const Rows<Width>& in,
                                                                lanes::Vec<typename Width::SumTag> left,
                                                                int j) {
  const typename Width::SumTag d;
  const auto right = lanes::LoadU(d, in.right_pairs + j);
  if constexpr (correlates(kCost)) {
    return lanes::DotPairs(d, left, right);
  } else {
    const auto change = lanes::AbsChange<Width::kShift>(d, left, right);
    // Partners outside the image count for nothing; of correlations they are 0 anyway.
    return kBorder ? lanes::And(change, lanes::LoadU(d, in.inside + j)) : change;
  }
}

/// The columns of left pixel x with this row, and the box with them.
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

/// Before a row's first pixel: the columns x < end join the box of a tile, which starts anew.
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

/// The cost that a box makes, kNone where there is no candidate: lanes i and on of left pixel x. Only with
/// kBorder can there be none, or a window be clipped.
template <Cost kCost, class Width, bool kDouble, bool kBorder>
CAIRN_LANES_INLINE lanes::Vec<typename Width::CostTag> cost_at(const Rows<Width>& in, int x, int i,
                                                               lanes::Vec<typename Width::SumTag> box,
                                                               const LeftSums& left) {
  const typename Width::CostTag d;
  const typename Width::SumTag d_sum;
  const Geometry& g = in.g;
  const int j = g.first_lane(x) + i;
  lanes::Vec<typename Width::CostTag> cost;
  if constexpr (std::is_base_of_v<Narrow, Width>) {
    cost = box;
  } else if constexpr (!correlates(kCost)) {
    cost = cost_of<kCost>(box);
  } else {
    const int least_d = g.first_d + i;
    const int most_d = least_d + lane_count<Width>() - 1;
    if (kBorder && (least_d > x || most_d < x - g.width + 1)) return lanes::Set(d, kNoCost);
    const bool clips = x < g.half + std::max(0, most_d) || x >= g.width - g.half + std::min(0, least_d);
    cost = kBorder && clips ? clipped_cost<kCost, kDouble>(in, box, x, i)
                            : cost_of<kCost, kDouble>(box, left, own_right_sums(in, j));
  }
  if constexpr (kBorder) {
    const auto exists = lanes::And(lanes::LoadU(d_sum, in.inside + j), lanes::Load(d_sum, in.within + i));
    const auto outside = lanes::RebindMask(d, lanes::Eq(exists, lanes::Zero(d_sum)));
    cost = lanes::IfThenElse(outside, lanes::Set(d, kNone<typename Width::Cost>), cost);
  }
  return cost;
}

/// The winners of left pixels x_begin … x_end − 1 among the lanes of a tile, and where the block keeps them
/// their costs. For each a column joins the box and one leaves it. `pixel`: number of the first one in its
/// block.
///
/// Not to be inlined: on its own it gets all registers.
template <Cost kCost, class Width, bool kDouble, int kLanes, Place kPlace>
CAIRN_NOINLINE void slide(const Rows<Width>& rows, int first, int x_begin, int x_end, int pixel,
                          const Block<Width>& block) {
  constexpr int kCount = kVectors<Width, kLanes>;
  constexpr bool kBorder = kPlace != Place::inside;
  const typename Width::SumTag d;
  const typename Width::CostTag d_cost;
  const Rows<Width> in(rows);
  const int half = in.g.half;
  const auto winners = block.winners[static_cast<std::size_t>(first / kTile)].places();
  const bool keeps_costs = !block.costs.empty();
  const bool equal_tags = block.equal_tags;
  const std::ptrdiff_t stride = block.costs.stride;
  typename Width::Cost* costs = keeps_costs ? block.costs.of(pixel) + first : nullptr;
  lanes::Vec<typename Width::SumTag> box[kCount];
  lanes::Vec<typename Width::CostTag> cost[kCount];
  CAIRN_UNROLL
  for (int v = 0; v < kCount; ++v) box[v] = lanes::Load(d, in.box + first + v * lane_count<Width>());
  for (int x = x_begin; x < x_end; ++x) {
    if constexpr (kPlace != Place::right_end) enter<kCost, Width, kLanes, kBorder>(in, first, x + half, box);
    const typename Width::Sum* const leaves = in.column_sums + in.g.column(x - half - 1, first);
    LeftSums left;
    if constexpr (correlates(kCost)) left = own_left_sums(in, x);
    CAIRN_UNROLL
    for (int v = 0; v < kCount; ++v) {
      const int at = v * lane_count<Width>();
      box[v] = lanes::Sub(box[v], lanes::Load(d, leaves + at));
      cost[v] = cost_at<kCost, Width, kDouble, kBorder>(in, x, first + at, box[v], left);
    }
    winners.find(pixel, cost);
    ++pixel;
    if (!keeps_costs) continue;
    if (equal_tags) {
      CAIRN_UNROLL
      for (int v = 0; v < kCount; ++v) cost[v] = with_equal_tag<Width>(cost[v]);
    }
    CAIRN_UNROLL
    for (int v = 0; v < kCount; ++v) lanes::Store(cost[v], d_cost, costs + v * lane_count<Width>());
    costs += stride;
  }
  CAIRN_UNROLL
  for (int v = 0; v < kCount; ++v) lanes::Store(box[v], d, in.box + first + v * lane_count<Width>());
}

}  // namespace
}  // namespace cairn::kernels::CAIRN_KERNEL_TARGET
