// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// No include guard: compiled once for each target, over the vocabulary `lanes` of that target.
//
// What is asked of a pixel's costs once they are there. `Width` says how wide they are: Wide or Narrow.

namespace cairn::kernels::CAIRN_KERNEL_TARGET {
namespace {

constexpr int kBlock = 16;  // left pixels whose costs are held at a time

/// As Matches has it.
template <class Width>
CAIRN_LANES_INLINE float as_cost(typename Width::Cost lane) {
  if constexpr (std::is_same_v<Width, Wide>) {
    return lane;
  } else {
    return lane == kNone<std::int16_t> ? kNoCost : static_cast<float>((lane + 32768) >> Width::kShift);
  }
}

/// The least costs of a row's left pixels among a tile's lanes, and the first lanes that have them.
template <class Width>
struct TileWinners {
  Scratch<float> costs;  // [x]
  Scratch<std::int32_t> first_lanes;
  explicit TileWinners(int width) : costs(width), first_lanes(width) {}

  template <int kCount>
  CAIRN_LANES_INLINE void find(int x, const lanes::Vec<typename Width::CostTag> (&cost)[kCount]) const {
    typename Width::Cost least;
    first_lanes[x] = lanes::FirstLeast(typename Width::CostTag(), cost, least);
    costs[x] = as_cost<Width>(least);
  }
  [[nodiscard]] CAIRN_LANES_INLINE VF cost(int x) const { return lanes::Load(F(), costs.data() + x); }
  [[nodiscard]] CAIRN_LANES_INLINE VI lane(int x) const { return lanes::Load(I(), first_lanes.data() + x); }
};
template <>
struct TileWinners<Tagged> {
  /// [x]: the sum with its tag, from 0 on; above its 16 bits, which of eight lanes.
  Scratch<std::int32_t> tagged;
  explicit TileWinners(int width) : tagged(width) {}

  template <int kCount>
  CAIRN_LANES_INLINE void find(int x, const lanes::Vec<Tagged::CostTag> (&cost)[kCount]) const {
    tagged[x] = lanes::LeastOfEights(Tagged::CostTag(), cost);
  }
  [[nodiscard]] CAIRN_LANES_INLINE VF cost(int x) const {
    const VI sum = lanes::And(lanes::Load(I(), tagged.data() + x), lanes::Set(I(), 65535));
    const auto none = lanes::RebindMask(F(), lanes::Eq(sum, lanes::Set(I(), 65535)));
    return lanes::IfThenElse(none, lanes::Set(F(), kNoCost),
                             lanes::ConvertTo(F(), lanes::ShiftRight<Tagged::kShift>(sum)));
  }
  [[nodiscard]] CAIRN_LANES_INLINE VI lane(int x) const {
    const VI both = lanes::Load(I(), tagged.data() + x);
    const VI tag = lanes::And(both, lanes::Set(I(), 7));
    return lanes::Add(lanes::ShiftLeft<3>(tag), lanes::ShiftRight<16>(both));
  }
};

/// Tags are made equal, so that costs of different lanes can be compared.
template <class Width>
CAIRN_LANES_INLINE lanes::Vec<typename Width::CostTag> without_tag(lanes::Vec<typename Width::CostTag> cost) {
  if constexpr (std::is_same_v<Width, Tagged>) {
    return lanes::Or(cost, lanes::Set(typename Width::CostTag(), std::int16_t{7}));
  } else {
    return cost;
  }
}

/// The costs of a block of left pixels, a margin of kNone around each pixel's lanes.
template <class Lane>
struct CostBlock {
  int stride;
  Scratch<Lane> costs;
  explicit CostBlock(int lanes_used) : stride(lanes_used + 2 * kMargin), costs(kBlock * stride) { clear(); }
  void clear() { std::fill_n(costs.data(), costs.size(), kNone<Lane>); }
  [[nodiscard]] Lane* of(std::ptrdiff_t pixel) const { return costs.data() + pixel * stride + kMargin; }
};

/// The winners of one right row, reversed like the row itself.
template <class Lane>
struct RightRow {
  Scratch<Lane> cost;
  Scratch<Lane> lane;  // in the cost's own type, so that one mask serves both
  explicit RightRow(int length) : cost(length + kMargin), lane(length + kMargin) { clear(); }
  void clear() { std::fill_n(cost.data(), cost.size(), kNone<Lane>); }
};

template <class Width>
CAIRN_LANES_INLINE typename Width::Cost least_cost(const typename Width::Cost* costs, int count) {
  const typename Width::CostTag d;
  auto least = lanes::Load(d, costs);
  for (int i = lane_count<Width>(); i < count; i += lane_count<Width>()) {
    least = lanes::Min(lanes::Load(d, costs + i), least);
  }
  return lanes::LeastLane(d, least);
}

/// The costs number k, k + 16, … of a pixel for as many k from `residue` on as there are lanes; none counts
/// 0.
template <class Width>
CAIRN_LANES_INLINE VF partial_sums(const float* costs, int count, int residue) {
  const F f;
  VF sum = lanes::Zero(f);
  for (int i = residue; i < count; i += pixel_math::kPartialSums) {
    const VF cost = lanes::Load(f, costs + i);
    sum = lanes::Add(sum, lanes::IfThenZeroElse(lanes::Eq(cost, lanes::Set(f, kNoCost)), cost));
  }
  return sum;
}
/// As integers; each is below 2^24, so that as floats they would have been exact too.
template <class Width>
CAIRN_LANES_INLINE VF partial_sums(const std::int16_t* costs, int count, int residue) {
  const I i32;
  VI sum = lanes::Zero(i32);
  for (int i = residue; i < count; i += pixel_math::kPartialSums) {
    const VI cost = lanes::Add(lanes::LoadWidened(i32, costs + i), lanes::Set(i32, 32768));
    sum = lanes::Add(sum, lanes::IfThenZeroElse(lanes::Eq(cost, lanes::Set(i32, 65535)),
                                                lanes::ShiftRight<Width::kShift>(cost)));
  }
  return lanes::ConvertTo(F(), sum);
}

/// pixel_math::sum_of_partials() of them all: the same halvings, vectors first, then lanes.
template <class Width>
CAIRN_LANES_INLINE float sum_of_costs(const typename Width::Cost* costs, int count) {
  constexpr int kLanes = static_cast<int>(lanes::MaxLanes(F()));
  constexpr int kVectors = pixel_math::kPartialSums / kLanes;
  VF sums[kVectors];
  for (int v = 0; v < kVectors; ++v) sums[v] = partial_sums<Width>(costs, count, v * kLanes);
  for (int half = kVectors / 2; half > 0; half /= 2) {
    for (int v = 0; v < half; ++v) sums[v] = lanes::Add(sums[v], sums[v + half]);
  }
  return lanes::SumByHalves(F(), sums[0]);
}

/// Hands a block's costs to the right pixels that they are about. A right pixel meets its left pixels from
/// left to right, its candidates thus in ascending order: strictly less keeps the smallest disparity. Between
/// the rows of a band that is no longer so, and equal costs are decided by the lane (kTies).
template <class Width, bool kTies>
void update_right(const CostBlock<typename Width::Cost>& block, const Geometry& g, int x_first, int pixels,
                  RightRow<typename Width::Cost>& right) {
  using Lane = typename Width::Cost;
  const typename Width::CostTag d;
  const auto one = lanes::Set(d, Lane{1});
  Lane* const right_cost = right.cost.data() + g.first_lane(x_first + pixels - 1);
  Lane* const right_lane = right.lane.data() + g.first_lane(x_first + pixels - 1);
  const Lane* const first_costs = block.of(0) - pixels + 1;
  const std::ptrdiff_t next = block.stride + 1;
  for (int j = 0, end = g.count + pixels - 1; j < end; j += lane_count<Width>()) {
    auto least = lanes::LoadU(d, right_cost + j);
    auto where = lanes::LoadU(d, right_lane + j);
    auto lane = lanes::Iota(d, static_cast<Lane>(j - pixels + 1));
    const Lane* costs = first_costs + j;
    for (int pixel = 0; pixel < pixels; ++pixel) {
      const auto cost = lanes::LoadU(d, costs);
      auto better = lanes::Lt(cost, least);
      if constexpr (kTies) {
        better = lanes::Or(better, lanes::And(lanes::Eq(cost, least), lanes::Lt(lane, where)));
      }
      where = lanes::IfThenElse(better, lane, where);
      least = lanes::Min(cost, least);
      lane = lanes::Add(lane, one);
      costs += next;
    }
    lanes::StoreU(least, d, right_cost + j);
    lanes::StoreU(where, d, right_lane + j);
  }
}

/// Keeps in `best` the lesser costs.
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

/// The winners of a row's left pixels among all tiles and rows.
struct RowWinners {
  Scratch<float> cost;  // [x]
  Scratch<std::int32_t> lane;
  Scratch<std::int8_t> row;
  explicit RowWinners(int width) : cost(width), lane(width), row(width) {}

  /// With the first tile of the row's own height. Left pixels `begin` (a multiple of 16) to end − 1.
  template <class Width>
  void start(const TileWinners<Width>& tile, int begin, int end) const {
    for (int x = begin; x < end; x += lane_count<Wide>()) {
      lanes::Store(tile.cost(x), F(), &cost[x]);
      lanes::Store(tile.lane(x), I(), &lane[x]);
    }
    std::fill(&row[begin], row.data() + end, std::int8_t{0});
  }
  /// What comes later wins where it costs less, and between rows where it costs as little and is a smaller
  /// disparity.
  template <class Width>
  void keep(const TileWinners<Width>& tile, int first, int of_row, int begin, int end) const {
    const F f;
    const I i32;
    for (int x = begin; x < end; x += lane_count<Wide>()) {
      const VF its_cost = tile.cost(x);
      const VI its_lane = lanes::Add(tile.lane(x), lanes::Set(i32, first));
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
