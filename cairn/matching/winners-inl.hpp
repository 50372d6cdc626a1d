// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// No include guard: compiled once for each target, over the vocabulary `lanes` of that target.
//
// What is asked of a pixel's costs once they are there. `Width` says how wide they are: Wide or Narrow.

namespace cairn::kernels::CAIRN_KERNEL_TARGET {
namespace {

constexpr int kBlock = 16;  // left pixels whose costs are held at a time

/// What stands for the cost where there is no candidate: more than any cost.
template <class Lane>
constexpr Lane kNone = std::numeric_limits<Lane>::max();
template <>
constexpr float kNone<float> = kNoCost;

/// As Matches has it.
CAIRN_LANES_INLINE float as_cost(float lane) {
  return lane;
}
CAIRN_LANES_INLINE float as_cost(std::int16_t lane) {
  return lane == kNone<std::int16_t> ? kNoCost : static_cast<float>(lane + 32768);
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

/// The first lane that costs `least`. One of them does.
template <class Width>
CAIRN_LANES_INLINE int first_lane_of(const typename Width::Cost* costs, int count,
                                     typename Width::Cost least) {
  using Lane = typename Width::Cost;
  const typename Width::CostTag d;
  const auto wanted = lanes::Set(d, least);
  const auto step = lanes::Set(d, static_cast<Lane>(lane_count<Width>()));
  const auto none = lanes::Set(d, kNone<Lane>);
  auto lane = lanes::Iota(d, Lane{0});
  auto first = none;
  for (int i = 0; i < count; i += lane_count<Width>()) {
    const auto found = lanes::Eq(lanes::Load(d, costs + i), wanted);
    first = lanes::Min(first, lanes::IfThenElse(found, lane, none));
    lane = lanes::Add(lane, step);
  }
  return static_cast<int>(lanes::LeastLane(d, first));
}

/// The costs number k, k + 16, … of a pixel for as many k from `residue` on as there are lanes; none counts
/// 0.
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
CAIRN_LANES_INLINE VF partial_sums(const std::int16_t* costs, int count, int residue) {
  const I i32;
  VI sum = lanes::Zero(i32);
  for (int i = residue; i < count; i += pixel_math::kPartialSums) {
    const VI cost = lanes::Add(lanes::LoadWidened(i32, costs + i), lanes::Set(i32, 32768));
    sum = lanes::Add(sum, lanes::IfThenZeroElse(lanes::Eq(cost, lanes::Set(i32, 65535)), cost));
  }
  return lanes::ConvertTo(F(), sum);
}

/// pixel_math::sum_of_partials() of them all: the same halvings, vectors first, then lanes.
template <class Lane>
CAIRN_LANES_INLINE float sum_of_costs(const Lane* costs, int count) {
  constexpr int kLanes = static_cast<int>(lanes::MaxLanes(F()));
  constexpr int kVectors = pixel_math::kPartialSums / kLanes;
  VF sums[kVectors];
  for (int v = 0; v < kVectors; ++v) sums[v] = partial_sums(costs, count, v * kLanes);
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

/// Keeps in `best` the lesser costs, and in `row_of` which row they came from. Equal costs stay with the
/// earlier row.
template <class Width>
void keep_lesser(const CostBlock<typename Width::Cost>& block, int row, int pixels, int count,
                 CostBlock<typename Width::Cost>& best, CostBlock<typename Width::Cost>& row_of) {
  using Lane = typename Width::Cost;
  const typename Width::CostTag d;
  const auto this_row = lanes::Set(d, static_cast<Lane>(row));
  for (int pixel = 0; pixel < pixels; ++pixel) {
    const Lane* const costs = block.of(pixel);
    Lane* const known_costs = best.of(pixel);
    Lane* const known_rows = row_of.of(pixel);
    for (int i = 0; i < count; i += lane_count<Width>()) {
      const auto cost = lanes::Load(d, costs + i);
      const auto known = lanes::Load(d, known_costs + i);
      const auto better = lanes::Lt(cost, known);
      lanes::Store(lanes::IfThenElse(better, this_row, lanes::Load(d, known_rows + i)), d, known_rows + i);
      lanes::Store(lanes::Min(cost, known), d, known_costs + i);
    }
  }
}

}  // namespace
}  // namespace cairn::kernels::CAIRN_KERNEL_TARGET
