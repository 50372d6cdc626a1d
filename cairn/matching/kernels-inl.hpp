// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// No include guard: compiled once for each target, over the vocabulary `lanes` of that target.
//
// How a row is matched. Vectors run along the disparity: lane i of left pixel x stands for d = first_d + i.
// The right row is kept reversed, so that the partners x − d of one left pixel lie side by side in memory:
//
//   reversed index j = pad + width − 1 − x_right         partner of lane i:  j = first_lane(x) + i
//
// column_sums[x][i] is the sum over the window's rows of what pixel x and its partner i have in common (a
// product, or an absolute difference). One row further down it changes by the row that comes in and the row
// that goes out. Both stand side by side in one 32-bit number (a pair of 16-bit ones), and one multiply-add
// of pairs gives the change. One pixel further right, the box sum gains a column and loses one. So a
// candidate's price does not depend on the window, and what is kept is one row of columns, never a volume of
// costs.
//
// A column without partner inside the right image sums up to 0 and thus leaves the window: that is the
// clipping.

namespace cairn::kernels::CAIRN_KERNEL_TARGET {
namespace {

using F = lanes::CappedTag<float, pixel_math::kPartialSums>;
using I = lanes::Rebind<std::int32_t, F>;
using VF = lanes::Vec<F>;
using VI = lanes::Vec<I>;

CAIRN_LANES_INLINE int lane_count() {
  return static_cast<int>(lanes::Lanes(F()));
}

constexpr int kBlock = 16;   // left pixels whose costs are held at a time
constexpr int kMargin = 32;  // lanes without candidate before and after a pixel's costs

constexpr bool correlates(Cost cost) {
  return cost != Cost::sad && cost != Cost::zsad;
}

/// Two 16-bit numbers in one lane: the row that comes in and the one that goes out.
CAIRN_LANES_INLINE std::int32_t pair_of(int incoming, int outgoing) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(outgoing) << 16 |
                                   (static_cast<std::uint32_t>(incoming) & 0xFFFFU));
}

/// The search, and where the partners of a left pixel stand in the reversed right row.
struct Geometry {
  int width;
  int height;
  int half;     // of the window, rounded down
  int first_d;  // px
  int count;    // candidates
  int lanes;    // the same, rounded up to a whole number of vectors
  int pad;      // entries before the reversed row
  int length;   // of a reversed row with all its margins

  explicit Geometry(const MatchTask& task)
      : width(task.out.best.width()),
        height(task.out.best.height()),
        half(task.config.window_size / 2),
        first_d(task.config.min_disparity),
        count(task.config.num_disparities),
        lanes(round_up(count, 16)),
        pad(std::max(0, -first_d)),
        length(round_up(pad + width + std::max(0, first_d) + lanes + kMargin, 16)) {}

  [[nodiscard]] int reversed(int x_right) const { return pad + width - 1 - x_right; }
  [[nodiscard]] int first_lane(int x) const { return reversed(x - first_d); }
  /// Where a left pixel's column stands, its lanes i and on; x = −1: the one that stays 0. Sixteen lanes of
  /// all columns lie together, so that a walk along the row reads memory in its order.
  [[nodiscard]] std::ptrdiff_t column(int x, int i) const {
    return static_cast<std::ptrdiff_t>(i & ~15) * (width + 1) + (x + 1) * 16 + (i & 15);
  }
  /// The candidates of x that lie inside the right image: lanes begin … end − 1.
  [[nodiscard]] int begin(int x) const { return std::clamp(x - width + 1 - first_d, 0, count); }
  [[nodiscard]] int end(int x) const { return std::clamp(x - first_d + 1, begin(x), count); }
};

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

  Moments(const Geometry& g, int first_entry)
      : half(g.half),
        first(first_entry),
        width(g.width),
        column_sum(g.length + 2 * half + 16),
        column_energy(g.length + 2 * half + 16),
        sum_before(g.length + 2 * half + 17),
        energy_before(g.length + 2 * half + 17),
        columns(g.length + 16),
        sum(g.length + 16),
        energy(g.length + 16),
        inverse(g.length + 16) {
    for (int x = 0; x < width; ++x) {
      columns[first + x] = std::min(x + half, width - 1) - std::max(x - half, 0) + 1;
    }
  }
};

/// What one row of the right image (the left row's own, or one of its band) is correlated with.
struct Strip {
  int row;                            // of the right image, relative to the left one's
  int rows = 0;                       // of the window, those inside both images
  Scratch<std::int32_t> column_sums;  // Geometry::column()
  Scratch<std::int32_t> box;          // [lane]
  Scratch<std::int32_t> left_pairs;   // [pad + x]
  Scratch<std::int32_t> right_pairs;  // reversed
  Moments left;
  Moments right;

  Strip(int strip_row, const Geometry& g)
      : row(strip_row),
        column_sums((g.width + 1) * g.lanes),
        box(g.lanes),
        left_pairs(g.length + 16),
        right_pairs(g.length + 16),
        left(g, g.pad),
        right(g, g.pad) {}
};

/// A strip's and its geometry's numbers as plain locals: the compiler must assume that a vector store changes
/// whatever is reached through a reference, and would fetch it anew for every vector.
struct Rows {
  Geometry g;
  int rows;
  std::int32_t* column_sums;
  std::int32_t* box;
  const std::int32_t* left_pairs;
  const std::int32_t* right_pairs;
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

  Rows(const Strip& strip, const Geometry& geometry)
      : g(geometry),
        rows(strip.rows),
        column_sums(strip.column_sums.data()),
        box(strip.box.data()),
        left_pairs(strip.left_pairs.data()),
        right_pairs(strip.right_pairs.data()),
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

// ---------------------------------------------------------------------------------------------------------------
// Formulas: pixel_math.hpp, lane by lane

/// n·a − b·c, rounded once. Narrow where the result is known to fit 32 bits, whatever the products do.
template <bool kWide>
CAIRN_LANES_INLINE VF difference(VI n, VI a, VI b, VI c) {
  if constexpr (kWide) {
    return lanes::WideDifference(F(), n, a, b, c);
  } else {
    return lanes::ConvertTo(F(), lanes::Sub(lanes::Mul(n, a), lanes::Mul(b, c)));
  }
}

/// 1/√(n·energy − sum²) for zncc, 1/√energy for nssd; 0 where that is 1/0.
template <Cost kCost, bool kWide>
CAIRN_LANES_INLINE VF inverse_root(VI n, VI energy, VI sum) {
  const F f;
  if constexpr (kCost != Cost::nssd && kCost != Cost::zncc) return lanes::Zero(f);
  const VF v = kCost == Cost::nssd ? lanes::ConvertTo(f, energy) : difference<kWide>(n, energy, sum, sum);
  return lanes::IfThenElseZero(lanes::Gt(v, lanes::Zero(f)), lanes::Div(lanes::Set(f, 1.0F), lanes::Sqrt(v)));
}

/// The sums that turn a box sum into a cost, in the notation of pixel_math.hpp.
struct Sums {
  VI n, l, ll, r, rr;
  VF inverse_n, inverse_l, inverse_r;
};

/// sad, zsad: the box sum is the cost.
template <Cost kCost>
CAIRN_LANES_INLINE VF cost_of(VI box) {
  const VF cost = lanes::ConvertTo(F(), box);
  return kCost == Cost::zsad ? lanes::Mul(cost, lanes::Set(F(), 1.0F / pixel_math::kMeanSteps)) : cost;
}

template <Cost kCost, bool kWide>
CAIRN_LANES_INLINE VF cost_of(VI box, const Sums& s) {
  const F f;
  if constexpr (kCost == Cost::zncc) {
    const VF correlation =
        lanes::Mul(difference<kWide>(s.n, box, s.l, s.r), lanes::Mul(s.inverse_l, s.inverse_r));
    return lanes::Max(lanes::Zero(f), lanes::Sub(lanes::Set(f, 1.0F), correlation));
  } else {
    const VI ssd = lanes::Sub(lanes::Add(s.ll, s.rr), lanes::Add(box, box));  // Σ(L−R)² = ΣL² + ΣR² − 2ΣLR
    if constexpr (kCost == Cost::ssd) {
      return lanes::ConvertTo(f, ssd);
    } else if constexpr (kCost == Cost::nssd) {
      const VF inverse = lanes::Mul(s.inverse_l, s.inverse_r);
      return lanes::IfThenElse(lanes::Gt(inverse, lanes::Zero(f)),
                               lanes::Mul(lanes::ConvertTo(f, ssd), inverse),
                               lanes::Set(f, pixel_math::kNoEnergyCost));
    } else {
      const VI l_minus_r = lanes::Sub(s.l, s.r);
      return lanes::Mul(difference<kWide>(s.n, ssd, l_minus_r, l_minus_r), s.inverse_n);
    }
  }
}

// ---------------------------------------------------------------------------------------------------------------
// The windows' own sums

/// The columns' sums, one row further down. `pairs`: as the image has them, nothing negated.
inline void move_down(Moments& m, const std::int32_t* pairs) {
  const I i32;
  const VI difference_signs = lanes::Set(i32, pair_of(1, -1));
  const VI sum_signs = lanes::Set(i32, pair_of(1, 1));
  std::int32_t* const sums = m.column_sum.data() + m.half;
  std::int32_t* const energies = m.column_energy.data() + m.half;
  for (int e = m.first, end = m.first + m.width; e < end; e += lane_count()) {
    const VI pair = lanes::LoadU(i32, pairs + e);
    const VI change = lanes::DotPairs(i32, pair, difference_signs);
    const VI squares = lanes::Mul(change, lanes::DotPairs(i32, pair, sum_signs));  // a² − b² = (a − b)(a + b)
    lanes::StoreU(lanes::Add(lanes::LoadU(i32, sums + e), change), i32, sums + e);
    lanes::StoreU(lanes::Add(lanes::LoadU(i32, energies + e), squares), i32, energies + e);
  }
}

inline void sum_up(const Scratch<std::int32_t>& columns, const Scratch<std::int32_t>& before) {
  const std::int32_t* const column = columns.data();
  std::int32_t* const out = before.data();
  std::uint32_t sum = 0;
  for (int e = 0, count = columns.size(); e < count; ++e) {
    sum += static_cast<std::uint32_t>(column[e]);
    out[e + 1] = static_cast<std::int32_t>(sum);
  }
}

/// Every window's own sums, out of the columns'. `rows`: of the window, those inside.
template <Cost kCost, bool kWide>
void sum_windows(Moments& m, int rows) {
  const I i32;
  sum_up(m.column_sum, m.sum_before);
  sum_up(m.column_energy, m.energy_before);
  const std::int32_t* const sum_before = m.sum_before.data();
  const std::int32_t* const energy_before = m.energy_before.data();
  const std::int32_t* const columns = m.columns.data();
  std::int32_t* const sums = m.sum.data();
  std::int32_t* const energies = m.energy.data();
  float* const inverses = m.inverse.data();
  const int window = 2 * m.half + 1;
  for (int e = m.first, end = m.first + m.width; e < end; e += lane_count()) {
    const VI sum = lanes::Sub(lanes::LoadU(i32, sum_before + e + window), lanes::LoadU(i32, sum_before + e));
    const VI energy =
        lanes::Sub(lanes::LoadU(i32, energy_before + e + window), lanes::LoadU(i32, energy_before + e));
    const VI n = lanes::Mul(lanes::Set(i32, rows), lanes::LoadU(i32, columns + e));
    lanes::StoreU(sum, i32, sums + e);
    lanes::StoreU(energy, i32, energies + e);
    lanes::StoreU(inverse_root<kCost, kWide>(n, energy, sum), F(), inverses + e);
  }
}

/// Of left pixel x and its partners from lane i on, where no window is clipped at the left or right: each
/// image's own.
CAIRN_LANES_INLINE Sums own_sums(const Rows& in, int x, int i) {
  const I i32;
  const F f;
  const int e = in.g.pad + x;
  const int j = in.g.first_lane(x) + i;
  const int n = in.rows * (2 * in.g.half + 1);
  return {lanes::Set(i32, n),
          lanes::Set(i32, in.l[e]),
          lanes::Set(i32, in.ll[e]),
          lanes::LoadU(i32, in.r + j),
          lanes::LoadU(i32, in.rr + j),
          lanes::Set(f, 1.0F / static_cast<float>(n)),
          lanes::Set(f, in.inverse_l[e]),
          lanes::LoadU(f, in.inverse_r + j)};
}

/// The sum over the left window's columns from max(begin, d) to min(end, width + d) − 1, lane by lane.
CAIRN_LANES_INLINE VI clipped_left_sum(const std::int32_t* before, const Geometry& g, int begin, int end,
                                       int i) {
  const I i32;
  const VI d = lanes::Iota(i32, g.first_d + i);
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
template <Cost kCost, bool kWide>
CAIRN_LANES_INLINE Sums clipped_sums(const Rows& in, int x, int i) {
  const I i32;
  const F f;
  const Geometry& g = in.g;
  const int begin = std::max(x - g.half, 0);
  const int end = std::min(x + g.half + 1, g.width);
  const VI d = lanes::Iota(i32, g.first_d + i);
  const VI columns = lanes::Sub(lanes::Min(lanes::Set(i32, end), lanes::Add(lanes::Set(i32, g.width), d)),
                                lanes::Max(lanes::Set(i32, begin), d));
  const VI n = lanes::Mul(lanes::Set(i32, in.rows), columns);
  const VI l = clipped_left_sum(in.l_before, g, begin, end, i);
  const VI ll = clipped_left_sum(in.ll_before, g, begin, end, i);
  const VI r = clipped_right_sum(in.r_before, g, begin, end, i);
  const VI rr = clipped_right_sum(in.rr_before, g, begin, end, i);
  return {n,
          l,
          ll,
          r,
          rr,
          lanes::Div(lanes::Set(f, 1.0F), lanes::ConvertTo(f, n)),
          inverse_root<kCost, kWide>(n, ll, l),
          inverse_root<kCost, kWide>(n, rr, r)};
}

// ---------------------------------------------------------------------------------------------------------------
// Running sums

/// By how much the columns of left pixel x change with this row, lanes i and on.
template <Cost kCost, bool kBorder>
CAIRN_LANES_INLINE VI change_of(const Rows& in, int x, int i) {
  const I i32;
  const Geometry& g = in.g;
  const int j = g.first_lane(x) + i;
  const VI left = lanes::Set(i32, in.left_pairs[g.pad + x]);
  const VI right = lanes::LoadU(i32, in.right_pairs + j);
  if constexpr (correlates(kCost)) return lanes::DotPairs(i32, left, right);
  VI signs = lanes::Set(i32, pair_of(1, -1));
  if constexpr (kBorder) {
    // Partners stand at the entries from pad to pad + width − 1; others count for nothing.
    const VI entry = lanes::Iota(i32, j);
    const auto inside = lanes::And(lanes::Gt(entry, lanes::Set(i32, g.pad - 1)),
                                   lanes::Lt(entry, lanes::Set(i32, g.pad + g.width)));
    signs = lanes::IfThenElseZero(inside, signs);
  }
  return lanes::DotPairs(i32, lanes::AbsDiffPairs(i32, left, right), signs);
}

template <Cost kCost, bool kBorder>
CAIRN_LANES_INLINE VI updated_column(const Rows& in, int x, int i) {
  const I i32;
  std::int32_t* const sums = in.column_sums + in.g.column(x, i);
  const VI column = lanes::Add(lanes::Load(i32, sums), change_of<kCost, kBorder>(in, x, i));
  lanes::Store(column, i32, sums);
  return column;
}

/// Before a row's first pixel: the columns x < end join the box, which starts anew.
template <Cost kCost>
void begin_box(const Strip& strip, const Geometry& g, int end) {
  const I i32;
  const Rows in(strip, g);
  for (int i = 0; i < in.g.lanes; i += lane_count()) {
    VI box = lanes::Zero(i32);
    for (int x = 0; x < end; ++x) box = lanes::Add(box, updated_column<kCost, true>(in, x, i));
    lanes::Store(box, i32, in.box + i);
  }
}

/// The costs of left pixels x_begin … x_end − 1, lanes i and on. For each a column joins the box and one
/// leaves it.
template <Cost kCost, bool kWide, bool kBorder>
void slide(const Strip& strip, const Geometry& geometry, int x_begin, int x_end, int i, float* costs,
           std::ptrdiff_t stride) {
  const I i32;
  const Rows in(strip, geometry);
  const int half = in.g.half;
  VI box = lanes::Load(i32, in.box + i);
  for (int x = x_begin; x < x_end; ++x) {
    if (!kBorder || x + half < in.g.width) {
      box = lanes::Add(box, updated_column<kCost, kBorder>(in, x + half, i));
    }
    const int leaving = kBorder ? std::max(x - half - 1, -1) : x - half - 1;
    box = lanes::Sub(box, lanes::Load(i32, in.column_sums + in.g.column(leaving, i)));
    if constexpr (!correlates(kCost)) {
      lanes::Store(cost_of<kCost>(box), F(), costs);
    } else if constexpr (kBorder) {
      lanes::Store(cost_of<kCost, kWide>(box, clipped_sums<kCost, kWide>(in, x, i)), F(), costs);
    } else {
      lanes::Store(cost_of<kCost, kWide>(box, own_sums(in, x, i)), F(), costs);
    }
    costs += stride;
  }
  lanes::Store(box, i32, in.box + i);
}

// ---------------------------------------------------------------------------------------------------------------
// Winners

/// The least cost of a pixel and its first lane.
struct Winner {
  float cost;
  int lane;
};

CAIRN_LANES_INLINE Winner least_of(const float* costs, int lanes_used) {
  const F f;
  VF least = lanes::Set(f, kNoCost);
  VF where = lanes::Zero(f);  // lane numbers as floats: exact, and blended by the same mask
  for (int i = 0; i < lanes_used; i += lane_count()) {
    const VF cost = lanes::Load(f, costs + i);
    where = lanes::IfThenElse(lanes::Lt(cost, least), lanes::Set(f, static_cast<float>(i)), where);
    least = lanes::Min(cost, least);
  }
  const VF least_of_all = lanes::MinOfLanes(f, least);
  const VF first = lanes::IfThenElse(lanes::Eq(least, least_of_all), lanes::Add(where, lanes::Iota(f, 0.0F)),
                                     lanes::Set(f, kNoCost));
  return {lanes::GetLane(least_of_all), static_cast<int>(lanes::GetLane(lanes::MinOfLanes(f, first)))};
}

CAIRN_LANES_INLINE float least_cost(const float* costs, int lanes_used) {
  const F f;
  VF least = lanes::Set(f, kNoCost);
  for (int i = 0; i < lanes_used; i += lane_count()) least = lanes::Min(lanes::Load(f, costs + i), least);
  return lanes::GetLane(lanes::MinOfLanes(f, least));
}

CAIRN_LANES_INLINE float sum_of_costs(const float* costs, int lanes_used) {
  const F f;
  const VF none = lanes::Set(f, kNoCost);
  alignas(64) float partial[pixel_math::kPartialSums];
  for (int residue = 0; residue < pixel_math::kPartialSums; residue += lane_count()) {
    VF sum = lanes::Zero(f);
    for (int i = residue; i < lanes_used; i += pixel_math::kPartialSums) {
      const VF cost = lanes::Load(f, costs + i);
      sum = lanes::Add(sum, lanes::IfThenZeroElse(lanes::Eq(cost, none), cost));
    }
    lanes::Store(sum, f, partial + residue);
  }
  return pixel_math::sum_of_partials(partial);
}

/// The costs of a block of left pixels, a margin of kNoCost around each pixel's lanes.
struct CostBlock {
  int stride;
  Scratch<float> costs;
  explicit CostBlock(int lanes_used) : stride(lanes_used + 2 * kMargin), costs(kBlock * stride) {
    std::fill_n(costs.data(), kBlock * stride, kNoCost);
  }
  [[nodiscard]] float* of(int pixel) const { return costs.data() + pixel * stride + kMargin; }
};

/// The winners of one right row, reversed like the row itself.
struct RightRow {
  Scratch<float> cost;
  Scratch<float> lane;  // of first_d
  explicit RightRow(int length) : cost(length + kMargin), lane(length + kMargin) { clear(); }
  void clear() { std::fill_n(cost.data(), cost.size(), kNoCost); }
};

/// Hands a block's costs to the right pixels that they are about. A right pixel meets its left pixels from
/// left to right, its candidates thus in ascending order: strictly less keeps the smallest disparity. Between
/// the rows of a band that is no longer so, and equal costs are decided by the lane (kTies).
template <bool kTies>
void update_right(const CostBlock& block, const Geometry& g, int x_first, int pixels, RightRow& right) {
  const F f;
  const VF one = lanes::Set(f, 1.0F);
  float* const right_cost = right.cost.data() + g.first_lane(x_first + pixels - 1);
  float* const right_lane = right.lane.data() + g.first_lane(x_first + pixels - 1);
  const float* const first_costs = block.of(0) - pixels + 1;
  const std::ptrdiff_t next = block.stride + 1;
  for (int j = 0, end = g.count + pixels - 1; j < end; j += lane_count()) {
    VF least = lanes::LoadU(f, right_cost + j);
    VF where = lanes::LoadU(f, right_lane + j);
    VF lane = lanes::Iota(f, static_cast<float>(j - pixels + 1));
    const float* costs = first_costs + j;
    for (int pixel = 0; pixel < pixels; ++pixel) {
      const VF cost = lanes::LoadU(f, costs);
      auto better = lanes::Lt(cost, least);
      if constexpr (kTies) {
        better = lanes::Or(better, lanes::And(lanes::Eq(cost, least), lanes::Lt(lane, where)));
      }
      where = lanes::IfThenElse(better, lane, where);
      least = lanes::Min(cost, least);
      lane = lanes::Add(lane, one);
      costs += next;
    }
    lanes::StoreU(least, f, right_cost + j);
    lanes::StoreU(where, f, right_lane + j);
  }
}

/// Keeps in `best` the lesser costs, and in `row_of` which row they came from. Equal costs stay with the
/// earlier row.
inline void keep_lesser(const CostBlock& block, int row, int pixels, int lanes_used, CostBlock& best,
                        CostBlock& row_of) {
  const F f;
  const VF this_row = lanes::Set(f, static_cast<float>(row));
  for (int pixel = 0; pixel < pixels; ++pixel) {
    for (int i = 0; i < lanes_used; i += lane_count()) {
      const VF cost = lanes::Load(f, block.of(pixel) + i);
      const VF known = lanes::Load(f, best.of(pixel) + i);
      const VF known_row = lanes::Load(f, row_of.of(pixel) + i);
      lanes::Store(lanes::IfThenElse(lanes::Lt(cost, known), this_row, known_row), f, row_of.of(pixel) + i);
      lanes::Store(lanes::Min(cost, known), f, best.of(pixel) + i);
    }
  }
}

// ---------------------------------------------------------------------------------------------------------------
// A band of rows

template <Cost kCost, bool kWide>
class Band {
 public:
  Band(const MatchTask& task, int first, int last)
      : task_(task),
        g_(task),
        full_(task.config.evidence == Evidence::full),
        radius_(task.config.row_band),
        first_(first),
        last_(last),
        // The right rows at the band's ends are also matched by left rows beyond them.
        first_matched_(full_ ? std::max(0, first - radius_) : first),
        last_matched_(full_ ? std::min(g_.height, last + radius_) : last),
        zeros_(std::max(g_.length, g_.width)),
        block_(g_.lanes),
        least_(radius_ > 0 ? g_.lanes : 0),
        row_of_(radius_ > 0 ? g_.lanes : 0) {
    strips_.emplace_back(0, g_);
    for (int k = 1; k <= radius_; ++k) {
      strips_.emplace_back(-k, g_);
      strips_.emplace_back(k, g_);
    }
    for (int i = 0; full_ && i < 2 * radius_ + 1; ++i) right_rows_.emplace_back(g_.length);
  }

  void run() {
    for (Strip& strip : strips_) {
      for (int y = first_matched_ - g_.half; y < first_matched_ + g_.half; ++y) {
        load_rows(strip, y, y - 2 * g_.half - 1);
        update_all_columns(strip);
      }
    }
    for (int y = first_matched_; y < last_matched_; ++y) {
      match_row(y);
      if (full_ && y - radius_ >= first_) finish_right(y - radius_);
    }
    for (int y = std::max(first_, last_matched_ - radius_); full_ && y < last_; ++y) finish_right(y);
  }

 private:
  [[nodiscard]] bool mine(int y) const { return y >= first_ && y < last_; }
  /// Left row y and its partner in the strip both exist.
  [[nodiscard]] bool inside(const Strip& strip, int y) const {
    return y >= 0 && y < g_.height && y + strip.row >= 0 && y + strip.row < g_.height;
  }

  // -- rows
  // ------------------------------------------------------------------------------------------------------

  /// Lays the row that comes in and the one that goes out side by side, and moves the moments down.
  void load_rows(Strip& strip, int incoming, int outgoing) {
    const bool comes = inside(strip, incoming);
    const bool goes = inside(strip, outgoing) && outgoing >= first_matched_ - g_.half;
    if constexpr (kCost == Cost::zsad) {
      load_pairs(strip, task_.left_flat, task_.right_flat, comes ? incoming : -1, goes ? outgoing : -1);
    } else {
      load_pairs(strip, task_.left, task_.right, comes ? incoming : -1, goes ? outgoing : -1);
    }
    strip.rows += (comes ? 1 : 0) - (goes ? 1 : 0);
    if constexpr (correlates(kCost)) {
      move_down(strip.left, strip.left_pairs.data());
      move_down(strip.right, strip.right_pairs.data());
      // The product that goes out is taken away.
      for (int x = 0; x < g_.width; ++x) {
        std::int32_t& pair = strip.left_pairs[g_.pad + x];
        pair = pair_of(pair & 0xFFFF, -(pair >> 16));
      }
    }
  }

  /// A row of −1 does not exist; it is all zeros in both images.
  template <class Pixel>
  void load_pairs(Strip& strip, View<const Pixel> left, View<const Pixel> right, int incoming, int outgoing) {
    const auto* zeros = reinterpret_cast<const Pixel*>(zeros_.data());
    const Pixel* in = incoming >= 0 ? left.row(incoming) : zeros;
    const Pixel* out = outgoing >= 0 ? left.row(outgoing) : zeros;
    std::int32_t* pairs = strip.left_pairs.data() + g_.pad;
    for (int x = 0; x < g_.width; ++x) pairs[x] = pair_of(in[x], out[x]);

    in = incoming >= 0 ? right.row(incoming + strip.row) : zeros;
    out = outgoing >= 0 ? right.row(outgoing + strip.row) : zeros;
    pairs = strip.right_pairs.data() + g_.reversed(g_.width - 1);
    for (int i = 0, x = g_.width - 1; i < g_.width; ++i, --x) pairs[i] = pair_of(in[x], out[x]);
  }

  void update_all_columns(Strip& strip) { begin_box<kCost>(strip, g_, g_.width); }

  // -- one row's costs
  // -------------------------------------------------------------------------------------------

  void match_row(int y) {
    for (Strip& strip : strips_) {
      load_rows(strip, y + g_.half, y - g_.half - 1);
      if (!wanted(strip, y)) {
        update_all_columns(strip);
        continue;
      }
      if constexpr (correlates(kCost)) {
        sum_windows<kCost, kWide>(strip.left, strip.rows);
        sum_windows<kCost, kWide>(strip.right, strip.rows);
      }
      begin_box<kCost>(strip, g_, std::min(g_.half, g_.width));
    }
    for (int x = 0; x < g_.width; x += kBlock) match_block(x, std::min(kBlock, g_.width - x), y);
  }

  /// The strip's costs for left row y go into a map of this band.
  [[nodiscard]] bool wanted(const Strip& strip, int y) const {
    return inside(strip, y) && (mine(y) || (full_ && mine(y + strip.row)));
  }

  void match_block(int x_first, int pixels, int y) {
    if (radius_ > 0) std::fill_n(least_.costs.data(), kBlock * least_.stride, kNoCost);
    for (Strip& strip : strips_) {
      if (!wanted(strip, y)) continue;
      fill_costs(strip, x_first, pixels);
      if (full_ && mine(y + strip.row)) {
        RightRow& right = right_row(y + strip.row);
        radius_ > 0 ? update_right<true>(block_, g_, x_first, pixels, right)
                    : update_right<false>(block_, g_, x_first, pixels, right);
      }
      if (radius_ > 0) keep_lesser(block_, strip.row, pixels, g_.lanes, least_, row_of_);
    }
    if (mine(y)) settle(radius_ > 0 ? least_ : block_, x_first, pixels, y);
  }

  void fill_costs(Strip& strip, int x_first, int pixels) {
    const int x_last = x_first + pixels;
    for (int i = 0; i < g_.lanes; i += lane_count()) {
      const int least_d = g_.first_d + i;
      const int most_d = least_d + lane_count() - 1;
      // Left of x_begin no lane's window has a column yet. From x_inside to x_border − 1 nothing is clipped.
      const int x_begin = std::clamp(least_d - g_.half, x_first, x_last);
      const int x_inside = std::clamp(g_.half + std::max(0, most_d), x_begin, x_last);
      const int x_border = std::clamp(g_.width - g_.half + std::min(0, least_d), x_inside, x_last);
      const auto slide_over = [&]<bool kBorder>(int begin, int end) {
        slide<kCost, kWide, kBorder>(strip, g_, begin, end, i, block_.of(begin - x_first) + i, block_.stride);
      };
      slide_over.template operator()<true>(x_begin, x_inside);
      slide_over.template operator()<false>(x_inside, x_border);
      slide_over.template operator()<true>(x_border, x_last);
    }
    for (int i = 0; i < pixels; ++i) {
      float* const costs = block_.of(i);
      std::fill(costs, costs + g_.begin(x_first + i), kNoCost);
      std::fill(costs + g_.end(x_first + i), costs + g_.lanes, kNoCost);
    }
  }

  // -- results
  // ---------------------------------------------------------------------------------------------------

  RightRow& right_row(int y) { return right_rows_[static_cast<std::size_t>(y % (2 * radius_ + 1))]; }

  /// Writes a block's evidence. One question after the other for all its pixels, so that no pixel waits for
  /// its own answer.
  void settle(const CostBlock& block, int x_first, int pixels, int y) {
    std::array<Winner, kBlock> winners;
    for (int i = 0; i < pixels; ++i) winners[static_cast<std::size_t>(i)] = least_of(block.of(i), g_.lanes);
    for (int i = 0; i < pixels; ++i) {
      const auto [cost, lane] = winners[static_cast<std::size_t>(i)];
      const int x = x_first + i;
      const bool found = g_.begin(x) < g_.end(x);
      task_.out.best(x, y) = found ? static_cast<std::int16_t>(g_.first_d + lane) : kNoMatch;
      task_.out.cost(x, y) = cost;
      if (radius_ > 0) {
        task_.out.row_offset(x, y) = found ? static_cast<std::int8_t>(row_of_.of(i)[lane]) : std::int8_t{0};
      }
    }
    if (!full_) return;
    for (int i = 0; i < pixels; ++i) {
      const int x = x_first + i;
      const int candidates = g_.end(x) - g_.begin(x);
      const float sum = sum_of_costs(block.of(i), g_.lanes);
      task_.out.mean_cost(x, y) = candidates > 0 ? sum / static_cast<float>(candidates) : kNoCost;
    }
    for (int i = 0; i < pixels; ++i) {
      float* const best = block.of(i) + winners[static_cast<std::size_t>(i)].lane;
      task_.out.cost_before(x_first + i, y) = best[-1];
      task_.out.cost_after(x_first + i, y) = best[1];
      best[-1] = best[0] = best[1] = kNoCost;  // so that the runner-up is the least of what is left
    }
    for (int i = 0; i < pixels; ++i) task_.out.runner_up(x_first + i, y) = least_cost(block.of(i), g_.lanes);
  }

  void finish_right(int y) {
    RightRow& right = right_row(y);
    for (int x = 0; x < g_.width; ++x) {
      const int j = g_.reversed(x);
      const bool found = right.cost[j] < kNoCost;
      task_.out.best_right(x, y) =
          found ? static_cast<std::int16_t>(g_.first_d + static_cast<int>(right.lane[j])) : kNoMatch;
    }
    right.clear();
  }

  const MatchTask& task_;
  Geometry g_;
  bool full_;
  int radius_;  // of the band of right rows
  int first_;
  int last_;
  int first_matched_;
  int last_matched_;
  Scratch<std::int32_t> zeros_;
  CostBlock block_;
  CostBlock least_;   // over the rows of the band
  CostBlock row_of_;  // these
  std::vector<Strip> strips_;
  std::vector<RightRow> right_rows_;
};

template <Cost kCost, bool kWide>
void run_band(const MatchTask& task, int first, int last) {
  Band<kCost, kWide>(task, first, last).run();
}

template <Cost kCost>
void run_band(const MatchTask& task, int first, int last, int narrow_pixels) {
  const int n = task.config.window_size * task.config.window_size;
  n <= narrow_pixels ? run_band<kCost, false>(task, first, last) : run_band<kCost, true>(task, first, last);
}

}  // namespace

void match_rows(const MatchTask& task, int first, int last) {
  // The largest n for which n²·255² (zssd), n²·127.5² (zncc) are below 2^31.
  constexpr int kNarrowZssd = 181;
  constexpr int kNarrowZncc = 363;
  switch (task.config.cost) {
    case Cost::sad:
      return run_band<Cost::sad, false>(task, first, last);
    case Cost::ssd:
      return run_band<Cost::ssd, false>(task, first, last);
    case Cost::zsad:
      return run_band<Cost::zsad, false>(task, first, last);
    case Cost::zssd:
      return run_band<Cost::zssd>(task, first, last, kNarrowZssd);
    case Cost::nssd:
      return run_band<Cost::nssd, false>(task, first, last);
    case Cost::zncc:
      return run_band<Cost::zncc>(task, first, last, kNarrowZncc);
  }
}

}  // namespace cairn::kernels::CAIRN_KERNEL_TARGET
