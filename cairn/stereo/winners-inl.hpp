// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// No include guard: compiled once for each target, over the vocabulary `lanes` of that target.
//
// Evaluation of the costs of a pixel. `Width` is their type: Wide or Narrow.

namespace cairn::kernels::CAIRN_KERNEL_TARGET {
namespace {

constexpr int kBlock = 64;        // left pixels whose costs are kept at a time
constexpr int kRightBlock = 16;   // number of these passed on at a time: the lanes of a vector
constexpr int kPartialSums = 16;  // of a mean: the k-th adds candidates k, k + 16, …, whatever the lanes

/// The value for Matches.
template <class Width>
CAIRN_LANES_INLINE float as_cost(typename Width::Cost lane) {
  if constexpr (std::is_same_v<Width, Wide>) {
    return lane;
  } else {
    return lane == kNone<std::int16_t> ? kNoCost : static_cast<float>((lane + 32768) >> Width::kShift);
  }
}

/// An integer key in the order of the costs; integers compare faster than floats. A cost below 0 by rounding
/// counts as 0; its key is below 0.
template <class Width>
CAIRN_LANES_INLINE lanes::Vec<typename Width::SumTag> as_key(lanes::Vec<typename Width::CostTag> cost) {
  if constexpr (std::is_same_v<Width, Wide>) {
    return lanes::BitCast(I(), cost);
  } else {
    return cost;
  }
}

/// The minimum costs of left pixels among the lanes of a tile, and the first lanes with them.
template <class Width>
struct TileWinners {
  Scratch<float> costs;  // [pixel]
  Scratch<std::int32_t> first_lanes;
  explicit TileWinners(int pixels) : costs(pixels), first_lanes(pixels) {}

  /// Output positions of winners, as a separate object: avoids reloads for each pixel.
  struct Places {
    float* costs;
    std::int32_t* first_lanes;
    /// For kCount pixels from `pixel` on.
    template <int kCount>
    CAIRN_LANES_INLINE void find(int pixel,
                                 const lanes::Vec<typename Width::SumTag> (&keys)[1][kCount]) const {
      const typename Width::SumTag d;
      const auto least = lanes::LeastLane(d, lanes::LeastOf(keys[0]));
      first_lanes[pixel] = lanes::FirstUpTo(d, keys[0], lanes::Set(d, least));
      costs[pixel] = as_cost<Width>(least);
    }
    [[nodiscard]] CAIRN_LANES_INLINE VF cost(int pixel) const { return lanes::Load(F(), costs + pixel); }
    [[nodiscard]] CAIRN_LANES_INLINE VI lane(int pixel) const {
      return lanes::Load(I(), first_lanes + pixel);
    }
  };
  [[nodiscard]] Places places() const { return {costs.data(), first_lanes.data()}; }
};
template <>
struct TileWinners<Wide> {
  Scratch<float> costs;
  Scratch<std::int32_t> first_lanes;
  explicit TileWinners(int pixels) : costs(pixels), first_lanes(pixels) {}

  struct Places {
    float* costs;
    std::int32_t* first_lanes;
    template <int kPixels, int kCount>
    CAIRN_LANES_INLINE void find(int pixel, const VI (&keys)[kPixels][kCount]) const {
      const I d;
      if constexpr (kPixels == 1) {
        // Through a float register, which is also a vector register.
        const F f;
        const float least_lane = lanes::LeastLane(f, lanes::BitCast(f, lanes::LeastOf(keys[0])));
        const VF least = lanes::Max(lanes::Set(f, least_lane), lanes::Zero(f));
        first_lanes[pixel] = lanes::FirstUpTo(d, keys[0], lanes::BitCast(d, least));
        costs[pixel] = lanes::GetLane(least);
      } else {
        const lanes::Folded<I> folded;
        VI least[kPixels];
        CAIRN_UNROLL
        for (int i = 0; i < kPixels; ++i) least[i] = lanes::LeastOf(keys[i]);
        const auto all = lanes::Max(lanes::FoldEach<lanes::Lesser>(d, least), lanes::Zero(folded));
        const lanes::Folded<F> costs_of_all;
        lanes::StoreU(lanes::BitCast(costs_of_all, all), costs_of_all, costs + pixel);
        CAIRN_UNROLL
        for (int i = 0; i < kPixels; ++i) {
          const VI most = lanes::BitCast(d, lanes::Set(F(), costs[pixel + i]));
          first_lanes[pixel + i] = lanes::FirstUpTo(d, keys[i], most);
        }
      }
    }
    [[nodiscard]] CAIRN_LANES_INLINE VF cost(int pixel) const { return lanes::Load(F(), costs + pixel); }
    [[nodiscard]] CAIRN_LANES_INLINE VI lane(int pixel) const {
      return lanes::Load(I(), first_lanes + pixel);
    }
  };
  [[nodiscard]] Places places() const { return {costs.data(), first_lanes.data()}; }
};
template <>
struct TileWinners<TaggedCost> {
  /// [pixel]: the sum with its tag, from 0 on; above its 16 bits, the index among eight lanes.
  Scratch<std::int32_t> tagged;
  explicit TileWinners(int pixels) : tagged(pixels) {}

  struct Places {
    std::int32_t* tagged;
    template <int kCount>
    CAIRN_LANES_INLINE void find(int pixel, const lanes::Vec<TaggedCost::SumTag> (&keys)[1][kCount]) const {
      tagged[pixel] = lanes::LeastOfEights(TaggedCost::SumTag(), keys[0]);
    }
    [[nodiscard]] CAIRN_LANES_INLINE VF cost(int pixel) const {
      const VI sum = lanes::And(lanes::Load(I(), tagged + pixel), lanes::Set(I(), 65535));
      const auto none = lanes::RebindMask(F(), lanes::Eq(sum, lanes::Set(I(), 65535)));
      return lanes::IfThenElse(none, lanes::Set(F(), kNoCost),
                               lanes::ConvertTo(F(), lanes::ShiftRight<TaggedCost::kShift>(sum)));
    }
    [[nodiscard]] CAIRN_LANES_INLINE VI lane(int pixel) const {
      const VI both = lanes::Load(I(), tagged + pixel);
      const VI tag = lanes::And(both, lanes::Set(I(), 7));
      return lanes::Add(lanes::ShiftLeft<3>(tag), lanes::ShiftRight<16>(both));
    }
  };
  [[nodiscard]] Places places() const { return {tagged.data()}; }
};

/// Equalises tags, so that equal costs compare as equal.
template <class Width>
CAIRN_LANES_INLINE lanes::Vec<typename Width::SumTag> with_equal_tag(lanes::Vec<typename Width::SumTag> key) {
  if constexpr (std::is_same_v<Width, TaggedCost>) {
    return lanes::Or(key, lanes::Set(typename Width::SumTag(), std::int16_t{7}));
  } else {
    return key;
  }
}
/// The cost of a key, clamped to ≥ 0.
template <Cost kCost, class Width>
CAIRN_LANES_INLINE lanes::Vec<typename Width::CostTag> cost_of_key(lanes::Vec<typename Width::SumTag> key) {
  if constexpr (kCost == Cost::zncc) {
    return lanes::BitCast(F(), lanes::Max(key, lanes::Zero(I())));
  } else if constexpr (std::is_same_v<Width, Wide>) {
    return lanes::BitCast(F(), key);
  } else {
    return key;
  }
}

/// The costs of a block of left pixels, with margins of kNone before, between and after them.
template <class Lane>
struct CostBlock {
  int stride;
  Scratch<Lane> costs;
  explicit CostBlock(int lanes_used)
      : stride(lanes_used > 0 ? lanes_used + kMargin : 0), costs(stride > 0 ? kBlock * stride + kMargin : 0) {
    clear();
  }
  [[nodiscard]] bool empty() const { return stride == 0; }
  void clear() { std::fill_n(costs.data(), costs.size(), kNone<Lane>); }
  [[nodiscard]] Lane* of(std::ptrdiff_t pixel) const { return costs.data() + kBefore + pixel * stride; }
};

/// The winners of one right row, in reversed order.
template <class Lane>
struct RightRow {
  Scratch<Lane> cost;
  Scratch<Lane> lane;  // in the type of the cost, so that one mask serves both
  explicit RightRow(int length) : cost(length + 64), lane(length + 64) { clear(); }
  void clear() { std::fill_n(cost.data(), cost.size(), kNone<Lane>); }
};

/// Keeps in `least`, for each pixel of a block, the minimum with that of a tile. `first`: first lane of the
/// tile.
template <class Width, int kLanes>
void keep_least(const CostBlock<typename Width::Cost>& block, int first,
                std::array<typename Width::Cost, kBlock>& least) {
  using Tag = typename Width::CostTag;
  const Tag d;
  const lanes::Folded<Tag> folded;
  constexpr int kPixels = lanes::kFolded<Tag>;
  const typename Width::Cost* costs = block.of(0) + first;
  const std::ptrdiff_t stride = block.stride;
  for (int pixel = 0; pixel < kBlock; pixel += kPixels) {
    lanes::Vec<Tag> of_pixel[kPixels];
    CAIRN_UNROLL
    for (int i = 0; i < kPixels; ++i) {
      of_pixel[i] = lanes::Load(d, costs);
      CAIRN_UNROLL
      for (int v = 1; v < kVectors<Width, kLanes>; ++v)
        of_pixel[i] = lanes::Min(of_pixel[i], lanes::Load(d, costs + v * lane_count<Width>()));
      costs += stride;
    }
    const auto of_tile = lanes::FoldEach<lanes::Lesser>(d, of_pixel);
    lanes::Store(lanes::Min(of_tile, lanes::Load(folded, least.data() + pixel)), folded,
                 least.data() + pixel);
  }
}

/// Copies four costs from `at` on, and sets the first three of them to kNone.
template <class Width>
CAIRN_LANES_INLINE void take_three(typename Width::Cost* at, typename Width::Cost* four) {
  using Lane = typename Width::Cost;
  constexpr Lane kMin = std::numeric_limits<Lane>::lowest();
  alignas(16) static constexpr Lane kTaken[4] = {kNone<Lane>, kNone<Lane>, kNone<Lane>, kMin};
  const lanes::CappedTag<Lane, 4> d;
  for (int i = 0; i < 4; i += static_cast<int>(lanes::Lanes(d))) {
    const auto costs = lanes::LoadU(d, at + i);
    lanes::Store(costs, d, four + i);
    lanes::StoreU(lanes::Max(costs, lanes::Load(d, kTaken + i)), d, at + i);
  }
}

/// The costs k, k + 16, … of a pixel for as many k from `residue` on as there are lanes; missing ones count
/// as 0.
template <class Width>
CAIRN_LANES_INLINE VF partial_sums(const float* costs, int count, int residue) {
  const F f;
  VF sum = lanes::Zero(f);
  for (int i = residue; i < count; i += kPartialSums) {
    const VF cost = lanes::Load(f, costs + i);
    sum = lanes::Add(sum, lanes::IfThenZeroElse(lanes::Eq(cost, lanes::Set(f, kNoCost)), cost));
  }
  return sum;
}
/// As integers; each is below 2^24, so floats would be exact too.
template <class Width>
CAIRN_LANES_INLINE VF partial_sums(const std::int16_t* costs, int count, int residue) {
  const I i32;
  VI sum = lanes::Zero(i32);
  for (int i = residue; i < count; i += kPartialSums) {
    const VI cost = lanes::Add(lanes::LoadWidened(i32, costs + i), lanes::Set(i32, 32768));
    sum = lanes::Add(sum, lanes::IfThenZeroElse(lanes::Eq(cost, lanes::Set(i32, 65535)),
                                                lanes::ShiftRight<Width::kShift>(cost)));
  }
  return lanes::ConvertTo(F(), sum);
}

/// The sum of all of them by repeated halving, vectors first, then lanes. It does not depend on the number of
/// lanes.
template <class Width>
CAIRN_LANES_INLINE float sum_by_parts(const typename Width::Cost* costs, int count) {
  constexpr int kLanes = static_cast<int>(lanes::MaxLanes(F()));
  constexpr int kSums = kPartialSums / kLanes;
  VF sums[kSums];
  for (int v = 0; v < kSums; ++v) sums[v] = partial_sums<Width>(costs, count, v * kLanes);
  for (int half = kSums / 2; half > 0; half /= 2) {
    for (int v = 0; v < half; ++v) sums[v] = lanes::Add(sums[v], sums[v + half]);
  }
  return lanes::SumByHalves(F(), sums[0]);
}

/// The sums of the stored costs of a block, for each pixel.
template <class Width>
void sums_of_kept(const CostBlock<std::int16_t>& block, int count, std::array<std::int32_t, kBlock>& sums) {
  using Tag = typename Width::CostTag;
  using SumTag = lanes::SumTag<Tag>;
  const Tag d;
  constexpr int kPixels = lanes::kFolded<SumTag>;
  const std::int16_t* const costs_0 = block.of(0);
  const std::ptrdiff_t stride = block.stride;
  for (int pixel = 0; pixel < kBlock; pixel += kPixels) {
    lanes::Vec<SumTag> of_pixel[kPixels];
    CAIRN_UNROLL
    for (int i = 0; i < kPixels; ++i) {
      const std::int16_t* const costs = costs_0 + (pixel + i) * stride;
      of_pixel[i] = lanes::ZeroSum(d);
      for (int first = 0; first < count; first += kTile / 2) {
        CAIRN_UNROLL
        for (int v = 0; v < kVectors<Width, kTile / 2>; ++v) {
          const auto some = lanes::Load(d, costs + first + v * lane_count<Width>());
          of_pixel[i] = lanes::AddPairs(d, of_pixel[i], some);
        }
      }
    }
    lanes::Store(lanes::FoldEach<lanes::Sum>(SumTag(), of_pixel), lanes::Folded<SumTag>(),
                 sums.data() + pixel);
  }
}

/// The result of sum_by_parts(), from the sum of `count` stored costs, `missing` of which are none. Below
/// 2^24 all parts are exact in any order.
template <class Width>
CAIRN_LANES_INLINE VF sum_from_kept(const std::int32_t* sum_of_kept, int count, VI missing) {
  const I i32;
  constexpr int kTag = (1 << Width::kShift) - 1;
  const VI from_0 = lanes::Add(lanes::Load(i32, sum_of_kept), lanes::Set(i32, (32768 - kTag) * count));
  const VI of_none = lanes::Mul(missing, lanes::Set(i32, 65535 >> Width::kShift));
  return lanes::ConvertTo(F(), lanes::Sub(lanes::ShiftRight<Width::kShift>(from_0), of_none));
}

/// Stored costs as values for Matches.
CAIRN_LANES_INLINE VF as_costs(Wide, VF kept) {
  return kept;
}
template <class Width>
CAIRN_LANES_INLINE VF as_costs(Width, VI kept) {
  const VI from_0 = lanes::Add(kept, lanes::Set(I(), 32768));
  const auto none = lanes::RebindMask(F(), lanes::Eq(from_0, lanes::Set(I(), 65535)));
  return lanes::IfThenElse(none, lanes::Set(F(), kNoCost),
                           lanes::ConvertTo(F(), lanes::ShiftRight<Width::kShift>(from_0)));
}
CAIRN_LANES_INLINE VF as_costs(Wide, const float* kept) {
  return lanes::LoadU(F(), kept);
}
template <class Width>
CAIRN_LANES_INLINE VF as_costs(Width, const std::int16_t* kept) {
  return as_costs(Width(), lanes::LoadWidened(I(), kept));
}

/// Indices of lanes, stored in the type of the costs.
CAIRN_LANES_INLINE VI as_lanes(Wide, const float* kept) {
  return lanes::ConvertTo(I(), lanes::LoadU(F(), kept));
}
template <class Width>
CAIRN_LANES_INLINE VI as_lanes(Width, const std::int16_t* kept) {
  return lanes::LoadWidened(I(), kept);
}

/// The better of a right pixel's result so far and a new one, both with the lane. A right pixel meets its
/// left pixels from left to right, hence its candidates in ascending order: strict comparison keeps the
/// smallest disparity. Between the rows of a band this does not hold, and ties are decided by the lane
/// (kTies).
template <class Width, bool kTies, class V>
CAIRN_LANES_INLINE void keep_lesser(V& least, V& where, V cost, V lane) {
  auto better = lanes::Lt(cost, least);
  if constexpr (kTies) {
    better = lanes::Or(better, lanes::And(lanes::Eq(cost, least), lanes::Lt(lane, where)));
  }
  where = lanes::IfThenElse(better, lane, where);
  least = lanes::Min(cost, least);
}

/// Passes the costs of the left pixels begin … end − 1 of a block to the matching right pixels. `x_first`: of
/// the block.
template <class Width, bool kTies>
void update_right(const CostBlock<typename Width::Cost>& block, const Geometry& g, int x_first, int begin,
                  int end, RightRow<typename Width::Cost>& right) {
  using Lane = typename Width::Cost;
  const typename Width::CostTag d;
  const auto one = lanes::Set(d, Lane{1});
  const int pixels = end - begin;
  Lane* const right_cost = right.cost.data() + g.first_lane(x_first + end - 1);
  Lane* const right_lane = right.lane.data() + g.first_lane(x_first + end - 1);
  const Lane* const first_costs = block.of(begin) - pixels + 1;
  const std::ptrdiff_t next = block.stride + 1;
  for (int j = 0, count = g.count + pixels - 1; j < count; j += lane_count<Width>()) {
    auto least = lanes::LoadU(d, right_cost + j);
    auto where = lanes::LoadU(d, right_lane + j);
    auto lane = lanes::CountFrom(d, static_cast<Lane>(j - pixels + 1));
    const Lane* costs = first_costs + j;
    for (int pixel = 0; pixel < pixels; ++pixel) {
      keep_lesser<Width, kTies>(least, where, lanes::LoadU(d, costs), lane);
      lane = lanes::Add(lane, one);
      costs += next;
    }
    lanes::StoreU(least, d, right_cost + j);
    lanes::StoreU(where, d, right_lane + j);
  }
}

/// The minimum costs of eight left pixels, one lane further for each. Their index replaces the tag, which is
/// 7, and so identifies the pixel of the minimum.
CAIRN_LANES_INLINE lanes::Vec<TaggedCost::CostTag> least_of_eight(const std::int16_t* costs,
                                                                  std::ptrdiff_t next) {
  const TaggedCost::CostTag d;
  auto least = lanes::LoadU(d, costs + 7 * next);
  CAIRN_UNROLL
  for (int pixel = 0; pixel < 7; ++pixel) {
    const auto number = lanes::Set(d, static_cast<std::int16_t>(pixel - 7));
    least = lanes::Min(least, lanes::Add(lanes::LoadU(d, costs + pixel * next), number));
  }
  return least;
}

/// The same for kRightBlock pixels: data stored is reloaded by the next ones at the same positions.
template <bool kTies>
void update_right(const CostBlock<std::int16_t>& block, const Geometry& g, int x_first, int begin,
                  RightRow<std::int16_t>& right) {
  const TaggedCost::CostTag d;
  const auto tag = lanes::Set(d, std::int16_t{7});
  std::int16_t* const right_cost = right.cost.data() + g.first_lane(x_first + begin + kRightBlock - 1);
  std::int16_t* const right_lane = right.lane.data() + g.first_lane(x_first + begin + kRightBlock - 1);
  const std::ptrdiff_t next = block.stride + 1;
  for (int j = 0, count = g.count + kRightBlock - 1; j < count; j += lane_count<TaggedCost>()) {
    auto least = lanes::LoadU(d, right_cost + j);
    auto where = lanes::LoadU(d, right_lane + j);
    CAIRN_UNROLL
    for (int pixel = 0; pixel < kRightBlock; pixel += 8) {
      const int first = j - kRightBlock + 1 + pixel;
      const auto cost = least_of_eight(block.of(begin + pixel) + first, next);
      const auto lane =
          lanes::Add(lanes::CountFrom(d, static_cast<std::int16_t>(first)), lanes::And(cost, tag));
      keep_lesser<TaggedCost, kTies>(least, where, lanes::Or(cost, tag), lane);
    }
    lanes::StoreU(least, d, right_cost + j);
    lanes::StoreU(where, d, right_lane + j);
  }
}

/// … and for all pixels of a block.
template <class Width, bool kTies>
void update_right(const CostBlock<typename Width::Cost>& block, const Geometry& g, int x_first, int pixels,
                  RightRow<typename Width::Cost>& right) {
  for (int begin = 0; begin < pixels; begin += kRightBlock) {
    const int end = std::min(begin + kRightBlock, pixels);
    if constexpr (std::is_same_v<Width, TaggedCost>) {
      if (end - begin == kRightBlock) {
        update_right<kTies>(block, g, x_first, begin, right);
        continue;
      }
    }
    update_right<Width, kTies>(block, g, x_first, begin, end, right);
  }
}

/// Keeps the lower costs in `best`.
template <class Width>
void keep_lesser(const CostBlock<typename Width::Cost>& block, int pixels, int count,
                 CostBlock<typename Width::Cost>& best) {
  const typename Width::CostTag d;
  for (int pixel = 0; pixel < pixels; ++pixel) {
    const typename Width::Cost* const costs = block.of(pixel);
    typename Width::Cost* const known = best.of(pixel);
    for (int i = 0; i < count; i += lane_count<Width>()) {
      lanes::Store(lanes::Min(lanes::Load(d, costs + i), lanes::Load(d, known + i)), d, known + i);
    }
  }
}

/// The results for adjacent left pixels, before evaluation.
template <class Width>
struct Block {
  CostBlock<typename Width::Cost> costs;  // empty if not needed
  std::vector<TileWinners<Width>> winners;
  bool equal_tags;  // of all costs
  Block(const Geometry& g, int pixels, MatchMaps maps)
      : costs(maps == MatchMaps::winner ? 0 : g.lanes), equal_tags(maps == MatchMaps::full) {
    for (int first = 0; first < g.lanes; first += kTile) winners.emplace_back(pixels);
  }
};

/// The winners of the left pixels of a row among all tiles and rows.
struct RowWinners {
  Scratch<float> cost;  // [x]
  Scratch<std::int32_t> lane;
  Scratch<std::int8_t> row;
  explicit RowWinners(int width) : cost(width), lane(width), row(width) {}

  /// Starts with the first tile of the same row, for the left pixels `begin` (a multiple of 16) to end − 1.
  template <class Width>
  void start(const TileWinners<Width>& tile, int begin, int end) const {
    const auto found = tile.places();
    float* const costs = cost.data();
    std::int32_t* const first_lanes = lane.data();
    for (int x = begin; x < end; x += lane_count<Wide>()) {
      lanes::Store(found.cost(x - begin), F(), costs + x);
      lanes::Store(found.lane(x - begin), I(), first_lanes + x);
    }
    std::fill(&row[begin], row.data() + end, std::int8_t{0});
  }
  /// A later result wins if its cost is lower, and between rows also at equal cost if its disparity is
  /// smaller.
  template <class Width>
  void keep(const TileWinners<Width>& tile, int first, int of_row, int begin, int end) const {
    const F f;
    const I i32;
    const auto found = tile.places();
    for (int x = begin; x < end; x += lane_count<Wide>()) {
      const VF its_cost = found.cost(x - begin);
      const VI its_lane = lanes::Add(found.lane(x - begin), lanes::Set(i32, first));
      const VF known_cost = lanes::Load(f, &cost[x]);
      const VI known_lane = lanes::Load(i32, &lane[x]);
      const auto before = lanes::RebindMask(f, lanes::Lt(its_lane, known_lane));
      const auto better =
          lanes::Or(lanes::Lt(its_cost, known_cost), lanes::And(lanes::Eq(its_cost, known_cost), before));
      const auto better_lane = lanes::RebindMask(i32, better);
      lanes::Store(lanes::IfThenElse(better, its_cost, known_cost), f, &cost[x]);
      lanes::Store(lanes::IfThenElse(better_lane, its_lane, known_lane), i32, &lane[x]);
      const VI known_row = lanes::LoadWidened(i32, &row[x]);
      lanes::StoreNarrowed(i32, lanes::IfThenElse(better_lane, lanes::Set(i32, of_row), known_row), &row[x]);
    }
  }
};

}  // namespace
}  // namespace cairn::kernels::CAIRN_KERNEL_TARGET
