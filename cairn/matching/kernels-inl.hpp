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
// columns[x][i] is the sum over the window's rows of what pixel x and its partner i have in common (a
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
  /// The candidates of x that lie inside the right image: lanes begin … end − 1.
  [[nodiscard]] int begin(int x) const { return std::clamp(x - width + 1 - first_d, 0, count); }
  [[nodiscard]] int end(int x) const { return std::clamp(x - first_d + 1, begin(x), count); }
};

/// Sums of one image's own windows for the current row, each clipped at that image's borders.
struct Moments {
  int half;
  int count;  // entries: a row's pixels, in the order of its pairs
  Scratch<std::int32_t> column_sum;
  Scratch<std::int32_t> column_energy;
  Scratch<std::uint32_t>
      sum_before;  // over the columns left of an entry's window; may wrap, differences do not
  Scratch<std::uint32_t> energy_before;
  Scratch<std::int32_t> columns;  // of the window, those inside the image
  Scratch<std::int32_t> sum;
  Scratch<std::int32_t> energy;
  Scratch<float> inverse;  // as the operator asks for it

  /// Of a row of `length` entries, of which `width` from `first` on are pixels.
  Moments(int length, int first, int width, int window_half)
      : half(window_half),
        count(round_up(length, 16)),
        column_sum(count + 2 * half + 16),
        column_energy(count + 2 * half + 16),
        sum_before(count + 2 * half + 17),
        energy_before(count + 2 * half + 17),
        columns(count),
        sum(count),
        energy(count),
        inverse(count) {
    for (int x = 0; x < width; ++x) {
      columns[first + x] = std::min(x + half, width - 1) - std::max(x - half, 0) + 1;
    }
  }

  [[nodiscard]] std::int32_t sum_over(int first, int last) const {
    return static_cast<std::int32_t>(sum_before[last + 1 + half] - sum_before[first + half]);
  }
  [[nodiscard]] std::int32_t energy_over(int first, int last) const {
    return static_cast<std::int32_t>(energy_before[last + 1 + half] - energy_before[first + half]);
  }
};

/// What one row of the right image (the left row's own, or one of its band) is correlated with.
struct Strip {
  int row;                        // of the right image, relative to the left one's
  int rows = 0;                   // of the window, those inside both images
  Scratch<std::int32_t> columns;  // [x][lane], and one more column that stays 0
  Scratch<std::int32_t> box;      // [lane]
  Scratch<std::int32_t> left_pairs;
  Scratch<std::int32_t> right_pairs;  // reversed
  Moments left;
  Moments right;

  Strip(int strip_row, const Geometry& g, bool with_moments)
      : row(strip_row),
        columns((g.width + 1) * g.lanes),
        box(g.lanes),
        left_pairs(round_up(g.width, 16) + 16),
        right_pairs(g.length),
        left(with_moments ? g.width : 0, 0, with_moments ? g.width : 0, g.half),
        right(with_moments ? g.length : 0, g.pad, with_moments ? g.width : 0, g.half) {}
};

/// A window of the left pixel and its partners, lane by lane: where clipping makes every candidate's window
/// different.
struct LaneSums {
  Scratch<std::int32_t> n, l, ll, r, rr;
  Scratch<float> inverse_l, inverse_r, inverse_n;
  explicit LaneSums(int lanes)
      : n(lanes),
        l(lanes),
        ll(lanes),
        r(lanes),
        rr(lanes),
        inverse_l(lanes),
        inverse_r(lanes),
        inverse_n(lanes) {}
};

/// The sums that turn a pixel's box sums into costs. Away from the borders, the left ones are the same for
/// every lane.
struct PixelSums {
  std::int32_t n = 0;
  std::int32_t l = 0;
  std::int32_t ll = 0;
  float inverse_l = 0;
  float inverse_n = 0;
  const std::int32_t* r = nullptr;
  const std::int32_t* rr = nullptr;
  const float* inverse_r = nullptr;
};

// ---------------------------------------------------------------------------------------------------------------
// Formulas: pixel_math.hpp, lane by lane

template <bool kBorder>
CAIRN_LANES_INLINE VI left_sum(std::int32_t same, const Scratch<std::int32_t>& per_lane, int i) {
  if constexpr (kBorder) {
    return lanes::Load(I(), per_lane.data() + i);
  } else {
    return lanes::Set(I(), same);
  }
}
template <bool kBorder>
CAIRN_LANES_INLINE VF left_factor(float same, const Scratch<float>& per_lane, int i) {
  if constexpr (kBorder) {
    return lanes::Load(F(), per_lane.data() + i);
  } else {
    return lanes::Set(F(), same);
  }
}

/// n·a − b·c, rounded once. Narrow where the result is known to fit 32 bits, whatever the products do.
template <bool kWide>
CAIRN_LANES_INLINE VF difference(VI n, VI a, VI b, VI c) {
  if constexpr (kWide) {
    return lanes::WideDifference(F(), n, a, b, c);
  } else {
    return lanes::ConvertTo(F(), lanes::Sub(lanes::Mul(n, a), lanes::Mul(b, c)));
  }
}

template <Cost kCost, bool kWide, bool kBorder>
CAIRN_LANES_INLINE VF cost_of(VI box, const PixelSums& p, const LaneSums& per_lane, int i) {
  const F f;
  const I i32;
  if constexpr (kCost == Cost::sad) {
    return lanes::ConvertTo(f, box);
  } else if constexpr (kCost == Cost::zsad) {
    return lanes::Mul(lanes::ConvertTo(f, box), lanes::Set(f, 1.0F / pixel_math::kMeanSteps));
  } else if constexpr (kCost == Cost::zncc) {
    const VF covariance =
        difference<kWide>(left_sum<kBorder>(p.n, per_lane.n, i), box, left_sum<kBorder>(p.l, per_lane.l, i),
                          lanes::LoadU(i32, p.r + i));
    const VF inverse = lanes::Mul(left_factor<kBorder>(p.inverse_l, per_lane.inverse_l, i),
                                  lanes::LoadU(f, p.inverse_r + i));
    return lanes::Max(lanes::Zero(f), lanes::Sub(lanes::Set(f, 1.0F), lanes::Mul(covariance, inverse)));
  } else {
    const VI energies = lanes::Add(left_sum<kBorder>(p.ll, per_lane.ll, i), lanes::LoadU(i32, p.rr + i));
    const VI ssd = lanes::Sub(energies, lanes::Add(box, box));  // Σ(L−R)² = ΣL² + ΣR² − 2ΣLR
    if constexpr (kCost == Cost::ssd) {
      return lanes::ConvertTo(f, ssd);
    } else if constexpr (kCost == Cost::nssd) {
      const VF inverse = lanes::Mul(left_factor<kBorder>(p.inverse_l, per_lane.inverse_l, i),
                                    lanes::LoadU(f, p.inverse_r + i));
      return lanes::IfThenElse(lanes::Gt(inverse, lanes::Zero(f)),
                               lanes::Mul(lanes::ConvertTo(f, ssd), inverse),
                               lanes::Set(f, pixel_math::kNoEnergyCost));
    } else {
      const VI l_minus_r = lanes::Sub(left_sum<kBorder>(p.l, per_lane.l, i), lanes::LoadU(i32, p.r + i));
      const VF spread = difference<kWide>(left_sum<kBorder>(p.n, per_lane.n, i), ssd, l_minus_r, l_minus_r);
      return lanes::Mul(spread, left_factor<kBorder>(p.inverse_n, per_lane.inverse_n, i));
    }
  }
}

// ---------------------------------------------------------------------------------------------------------------
// Running sums

/// One step to the right: the column that comes in changes by this row, and joins the box; another leaves it.
struct Step {
  std::int32_t left_pair;
  const std::int32_t* right_pairs;
  const std::int32_t* signs;  // sums of differences only: (1, −1), 0 where a column has no partner
  std::int32_t* incoming;
  const std::int32_t* outgoing;
};

/// What the incoming column changes by.
template <Cost kCost, bool kBorder>
CAIRN_LANES_INLINE VI change_of(const Step& step, int i) {
  const I i32;
  const VI left = lanes::Set(i32, step.left_pair);
  const VI right = lanes::LoadU(i32, step.right_pairs + i);
  if constexpr (correlates(kCost)) {
    return lanes::DotPairs(i32, left, right);
  } else if constexpr (kBorder) {
    return lanes::DotPairs(i32, lanes::AbsDiffPairs(i32, left, right), lanes::LoadU(i32, step.signs + i));
  } else {
    return lanes::DotPairs(i32, lanes::AbsDiffPairs(i32, left, right), lanes::Set(i32, pair_of(1, -1)));
  }
}

template <Cost kCost, bool kBorder>
CAIRN_LANES_INLINE VI updated_column(const Step& step, int i) {
  const I i32;
  const VI column = lanes::Add(lanes::Load(i32, step.incoming + i), change_of<kCost, kBorder>(step, i));
  lanes::Store(column, i32, step.incoming + i);
  return column;
}

/// Before a row's first pixel: the column alone, the box not yet complete.
template <Cost kCost>
void update_column(const Step& step, std::int32_t* box, int lanes_used) {
  const I i32;
  for (int i = 0; i < lanes_used; i += lane_count()) {
    const VI column = updated_column<kCost, true>(step, i);
    lanes::Store(lanes::Add(lanes::Load(i32, box + i), column), i32, box + i);
  }
}

/// One pixel's costs, all lanes.
template <Cost kCost, bool kWide, bool kBorder>
CAIRN_LANES_INLINE void slide(const Step& step, std::int32_t* box_sums, const PixelSums& sums,
                              const LaneSums& per_lane, int lanes_used, float* costs) {
  const I i32;
  for (int i = 0; i < lanes_used; i += lane_count()) {
    const VI column = updated_column<kCost, kBorder>(step, i);
    const VI box =
        lanes::Sub(lanes::Add(lanes::Load(i32, box_sums + i), column), lanes::Load(i32, step.outgoing + i));
    lanes::Store(box, i32, box_sums + i);
    lanes::Store(cost_of<kCost, kWide, kBorder>(box, sums, per_lane, i), F(), costs + i);
  }
}

// ---------------------------------------------------------------------------------------------------------------
// Moments

/// n·e − s² for zncc, e for nssd: what the inverse root is taken of.
template <Cost kCost>
CAIRN_LANES_INLINE VF inverse_of(VI n, VI energy, VI sum) {
  if constexpr (kCost == Cost::nssd) {
    return lanes::InverseRoot(F(), lanes::Set(I(), 1), energy, lanes::Zero(I()));
  } else {
    return lanes::InverseRoot(F(), n, energy, sum);
  }
}
template <Cost kCost>
float inverse_of(std::int64_t n, std::int64_t energy, std::int64_t sum) {
  return pixel_math::inverse_root(kCost == Cost::nssd ? energy : n * energy - sum * sum);
}

/// The columns' sums, one row further down. `pairs`: as the image has them, nothing negated.
inline void move_down(Moments& m, const std::int32_t* pairs) {
  const I i32;
  const VI difference_signs = lanes::Set(i32, pair_of(1, -1));
  const VI sum_signs = lanes::Set(i32, pair_of(1, 1));
  for (int e = 0; e < m.count; e += lane_count()) {
    const VI pair = lanes::LoadU(i32, pairs + e);
    const VI change = lanes::DotPairs(i32, pair, difference_signs);
    const VI squares = lanes::Mul(change, lanes::DotPairs(i32, pair, sum_signs));  // a² − b² = (a − b)(a + b)
    std::int32_t* sum = m.column_sum.data() + m.half + e;
    std::int32_t* energy = m.column_energy.data() + m.half + e;
    lanes::StoreU(lanes::Add(lanes::LoadU(i32, sum), change), i32, sum);
    lanes::StoreU(lanes::Add(lanes::LoadU(i32, energy), squares), i32, energy);
  }
}

/// Every window's own sums, out of the columns'. `rows`: of the window, those inside.
template <Cost kCost>
void sum_windows(Moments& m, int rows) {
  const I i32;
  std::uint32_t sum = 0;
  std::uint32_t energy = 0;
  for (int e = 0; e < m.count + 2 * m.half; ++e) {
    sum += static_cast<std::uint32_t>(m.column_sum[e]);
    energy += static_cast<std::uint32_t>(m.column_energy[e]);
    m.sum_before[e + 1] = sum;
    m.energy_before[e + 1] = energy;
  }
  const auto* sum_before = reinterpret_cast<const std::int32_t*>(m.sum_before.data());
  const auto* energy_before = reinterpret_cast<const std::int32_t*>(m.energy_before.data());
  const int window = 2 * m.half + 1;
  for (int e = 0; e < m.count; e += lane_count()) {
    const VI l = lanes::Sub(lanes::LoadU(i32, sum_before + e + window), lanes::LoadU(i32, sum_before + e));
    const VI ll =
        lanes::Sub(lanes::LoadU(i32, energy_before + e + window), lanes::LoadU(i32, energy_before + e));
    lanes::Store(l, i32, m.sum.data() + e);
    lanes::Store(ll, i32, m.energy.data() + e);
    if constexpr (kCost == Cost::nssd || kCost == Cost::zncc) {
      const VI n = lanes::Mul(lanes::Set(i32, rows), lanes::Load(i32, m.columns.data() + e));
      lanes::Store(inverse_of<kCost>(n, ll, l), F(), m.inverse.data() + e);
    }
  }
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
  const int first = g.first_lane(x_first + pixels - 1);
  for (int j = 0; j < g.count + pixels - 1; j += lane_count()) {
    float* const cost_at = right.cost.data() + first + j;
    float* const lane_at = right.lane.data() + first + j;
    VF least = lanes::LoadU(f, cost_at);
    VF where = lanes::LoadU(f, lane_at);
    VF lane = lanes::Iota(f, static_cast<float>(j - pixels + 1));
    const float* costs = block.of(0) + j - pixels + 1;
    for (int pixel = 0; pixel < pixels; ++pixel) {
      const VF cost = lanes::LoadU(f, costs);
      auto better = lanes::Lt(cost, least);
      if constexpr (kTies) {
        better = lanes::Or(better, lanes::And(lanes::Eq(cost, least), lanes::Lt(lane, where)));
      }
      where = lanes::IfThenElse(better, lane, where);
      least = lanes::Min(cost, least);
      lane = lanes::Add(lane, one);
      costs += block.stride + 1;
    }
    lanes::StoreU(least, f, cost_at);
    lanes::StoreU(where, f, lane_at);
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
        signs_(g_.length),
        per_lane_(g_.lanes),
        block_(g_.lanes),
        least_(radius_ > 0 ? g_.lanes : 0),
        row_of_(radius_ > 0 ? g_.lanes : 0) {
    std::fill_n(signs_.data() + g_.pad, g_.width, pair_of(1, -1));
    strips_.emplace_back(0, g_, correlates(kCost));
    for (int k = 1; k <= radius_; ++k) {
      strips_.emplace_back(-k, g_, correlates(kCost));
      strips_.emplace_back(k, g_, correlates(kCost));
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
        const std::int32_t pair = strip.left_pairs[x];
        strip.left_pairs[x] = pair_of(pair & 0xFFFF, -(pair >> 16));
      }
    }
  }

  /// A row of −1 does not exist; it is all zeros in both images.
  template <class Pixel>
  void load_pairs(Strip& strip, View<const Pixel> left, View<const Pixel> right, int incoming, int outgoing) {
    const auto* zeros = reinterpret_cast<const Pixel*>(zeros_.data());
    const Pixel* in = incoming >= 0 ? left.row(incoming) : zeros;
    const Pixel* out = outgoing >= 0 ? left.row(outgoing) : zeros;
    std::int32_t* pairs = strip.left_pairs.data();
    for (int x = 0; x < g_.width; ++x) pairs[x] = pair_of(in[x], out[x]);

    in = incoming >= 0 ? right.row(incoming + strip.row) : zeros;
    out = outgoing >= 0 ? right.row(outgoing + strip.row) : zeros;
    pairs = strip.right_pairs.data() + g_.reversed(g_.width - 1);
    for (int i = 0, x = g_.width - 1; i < g_.width; ++i, --x) pairs[i] = pair_of(in[x], out[x]);
  }

  [[nodiscard]] Step step(const Strip& strip, int x_in, int x_out) const {
    const bool comes = x_in < g_.width;
    // The column number `width` is 0 and stays so: nothing comes in, or nothing goes out.
    const auto column = [&](int x) {
      return strip.columns.data() + static_cast<std::ptrdiff_t>(x) * g_.lanes;
    };
    return {comes ? strip.left_pairs[x_in] : 0,
            comes ? strip.right_pairs.data() + g_.first_lane(x_in) : zeros_.data(),
            comes ? signs_.data() + g_.first_lane(x_in) : zeros_.data(), column(comes ? x_in : g_.width),
            column(x_out >= 0 ? x_out : g_.width)};
  }

  void update_all_columns(Strip& strip) {
    for (int x = 0; x < g_.width; ++x) update_column<kCost>(step(strip, x, -1), strip.box.data(), g_.lanes);
  }

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
        sum_windows<kCost>(strip.left, strip.rows);
        sum_windows<kCost>(strip.right, strip.rows);
      }
      std::fill_n(strip.box.data(), g_.lanes, 0);
      for (int x = 0; x < std::min(g_.half, g_.width); ++x) {
        update_column<kCost>(step(strip, x, -1), strip.box.data(), g_.lanes);
      }
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
      for (int i = 0; i < pixels; ++i) costs_of(strip, x_first + i, block_.of(i));
      if (full_ && mine(y + strip.row)) {
        RightRow& right = right_row(y + strip.row);
        radius_ > 0 ? update_right<true>(block_, g_, x_first, pixels, right)
                    : update_right<false>(block_, g_, x_first, pixels, right);
      }
      if (radius_ > 0) keep_lesser(block_, strip.row, pixels, g_.lanes, least_, row_of_);
    }
    if (mine(y)) settle(radius_ > 0 ? least_ : block_, x_first, pixels, y);
  }

  void costs_of(Strip& strip, int x, float* costs) {
    const Step next = step(strip, x + g_.half, x - g_.half - 1);
    if (at_border(x)) {
      PixelSums sums;
      if constexpr (correlates(kCost)) sums = sum_lanes(strip, x);
      slide<kCost, kWide, true>(next, strip.box.data(), sums, per_lane_, g_.lanes, costs);
    } else {
      PixelSums sums;
      if constexpr (correlates(kCost)) sums = sums_of(strip, x);
      slide<kCost, kWide, false>(next, strip.box.data(), sums, per_lane_, g_.lanes, costs);
    }
    std::fill(costs, costs + g_.begin(x), kNoCost);
    std::fill(costs + g_.end(x), costs + g_.lanes, kNoCost);
  }

  /// Some candidate's window is clipped at the left or right.
  [[nodiscard]] bool at_border(int x) const {
    const int nearest = x - g_.first_d - g_.count + 1;  // the leftmost partner
    const int furthest = x - g_.first_d;
    return std::min(x, nearest) < g_.half || std::max(x, furthest) + g_.half >= g_.width;
  }

  // -- the windows' sums
  // -----------------------------------------------------------------------------------------

  /// Away from the borders: nothing is clipped.
  [[nodiscard]] PixelSums sums_of(const Strip& strip, int x) const {
    const int j = g_.first_lane(x);
    const std::int32_t n = strip.rows * (2 * g_.half + 1);
    return {n,
            strip.left.sum[x],
            strip.left.energy[x],
            strip.left.inverse[x],
            1.0F / static_cast<float>(n),
            strip.right.sum.data() + j,
            strip.right.energy.data() + j,
            strip.right.inverse.data() + j};
  }

  /// At the borders: per_lane_ takes up both images' own windows, then those are put right that the other
  /// image clips more than their own does.
  PixelSums sum_lanes(const Strip& strip, int x) {
    const int begin = g_.begin(x);
    const int end = g_.end(x);
    const int j = g_.first_lane(x);
    LaneSums& to = per_lane_;
    for (int i = begin; i < end; ++i) {
      const int x_right = x - g_.first_d - i;
      const int arm_left = std::min(g_.half, std::min(x, x_right));
      const int arm_right = std::min(g_.half, g_.width - 1 - std::max(x, x_right));
      const int n = strip.rows * (arm_left + arm_right + 1);
      to.n[i] = n;
      to.inverse_n[i] = 1.0F / static_cast<float>(n);
      to.l[i] = strip.left.sum_over(x - arm_left, x + arm_right);
      to.ll[i] = strip.left.energy_over(x - arm_left, x + arm_right);
      to.r[i] = strip.right.sum_over(j + i - arm_right, j + i + arm_left);
      to.rr[i] = strip.right.energy_over(j + i - arm_right, j + i + arm_left);
      to.inverse_l[i] = inverse_of<kCost>(n, to.ll[i], to.l[i]);
      to.inverse_r[i] = inverse_of<kCost>(n, to.rr[i], to.r[i]);
    }
    PixelSums sums;
    sums.r = to.r.data();
    sums.rr = to.rr.data();
    sums.inverse_r = to.inverse_r.data();
    return sums;
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
  Scratch<std::int32_t> signs_;
  LaneSums per_lane_;
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
