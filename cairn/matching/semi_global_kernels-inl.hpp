// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// No include guard: compiled once for each target, over the vocabulary `bytes` of that target.
//
// How paths are followed. Vectors run along the disparity, one byte for each candidate. Lanes beyond the last
// candidate have a cost of 255; sums saturate, so that their L stays 255, and no real lane ever takes
// anything from them: a real L is at most 54 + 127. For the same reason a saturated L + P1 changes nothing.
//
// What a path adds to C is at most P2. Only that is kept of the vertical paths, both in the same byte.

namespace cairn::kernels::CAIRN_KERNEL_TARGET {
namespace {

constexpr std::uint8_t kNoLane = 255;
constexpr int kOutsideCost = 12;        // of 24 bits
constexpr std::int16_t kNoSum = 32767;  // of a candidate that does not exist
constexpr int kBlock = 16;              // left pixels whose sums are held at a time
constexpr int kBlockMargin = 32;        // lanes without candidate before and after a pixel's sums

template <class D>
CAIRN_LANES_INLINE int lane_count(D d) {
  return static_cast<int>(bytes::Lanes(d));
}
template <class D>
using Wide = bytes::Repartition<std::int16_t, D>;

// ---------------------------------------------------------------------------------------------------------------
// Census and smoothing

/// The five rows around a row, each with its border replicated. Row y − 2 … y + 2 stands in slot y mod 5.
class PaddedRows {
 public:
  static constexpr int kBorder = 2;
  PaddedRows(View<const Gray> image, bool mirrored)
      : image_(image),
        mirrored_(mirrored),
        stride_(round_up(image.width() + 2 * kBorder + 64, 64)),
        rows_(5 * stride_) {}

  void load(int y) {
    const Gray* from = image_.row(std::clamp(y, 0, image_.height() - 1));
    std::uint8_t* to = slot(y);
    const int width = image_.width();
    if (mirrored_) {
      std::reverse_copy(from, from + width, to + kBorder);
    } else {
      std::copy_n(from, width, to + kBorder);
    }
    std::fill_n(to, kBorder, to[kBorder]);
    std::fill_n(to + kBorder + width, kBorder, to[kBorder + width - 1]);
  }
  /// Its first real pixel.
  [[nodiscard]] const std::uint8_t* row(int y) const { return slot(y) + kBorder; }

 private:
  [[nodiscard]] std::uint8_t* slot(int y) const { return rows_.data() + (y + 5) % 5 * stride_; }
  View<const Gray> image_;
  bool mirrored_;
  int stride_;
  Scratch<std::uint8_t> rows_;
};

/// Eight of the window's comparisons make a byte; the centre is none of them.
template <bool kMirrored>
void census_row(const PaddedRows& rows, int y, int width, std::uint8_t* bits, int plane) {
  const bytes::CappedTag<std::uint8_t, 64> d;
  for (int x = 0; x < width; x += lane_count(d)) {
    const auto centre = bytes::LoadU(d, rows.row(y) + x);
    auto byte = bytes::Zero(d);
    int k = 0;
    for (int v = -2; v <= 2; ++v) {
      for (int u = -2; u <= 2; ++u) {
        if (u == 0 && v == 0) continue;
        const auto other = bytes::LoadU(d, rows.row(y + v) + x + (kMirrored ? -u : u));
        const auto bit = bytes::Set(d, static_cast<std::uint8_t>(1 << k % 8));
        byte = bytes::Or(byte, bytes::IfThenZeroElse(bytes::Eq(bytes::Max(other, centre), other), bit));
        if (++k % 8 != 0) continue;
        bytes::StoreU(byte, d, bits + (k / 8 - 1) * plane + x);
        byte = bytes::Zero(d);
      }
    }
  }
}

inline void smooth_row(const PaddedRows& rows, int y, int width, std::uint16_t* down, Gray* smooth) {
  for (int x = -2; x < width + 2; ++x) {
    const int outer = rows.row(y - 2)[x] + rows.row(y + 2)[x];
    const int inner = rows.row(y - 1)[x] + rows.row(y + 1)[x];
    down[x + 2] = static_cast<std::uint16_t>(6 * outer + 58 * inner + 128 * rows.row(y)[x]);
  }
  for (int x = 0; x < width; ++x) {
    const std::uint16_t* v = down + x;
    const int sum = 6 * (v[0] + v[4]) + 58 * (v[1] + v[3]) + 128 * v[2];
    smooth[x] = static_cast<Gray>((sum + (1 << 15)) >> 16);
  }
}

inline void describe_rows(const SemiGlobalTask& task, int first, int last) {
  const int width = task.layout.width;
  PaddedRows left(task.left, false);
  PaddedRows right(task.right, true);
  Scratch<std::uint16_t> down(width + 2 * PaddedRows::kBorder);
  for (int y = first - 2; y < first + 2; ++y) left.load(y), right.load(y);
  for (int y = first; y < last; ++y) {
    left.load(y + 2);
    right.load(y + 2);
    census_row<false>(left, y, width, task.left_bits.row(y), round_up(width, 64));
    census_row<true>(right, y, width, task.right_bits.row(y) + task.layout.pad(), task.layout.length());
    smooth_row(left, y, width, down.data(), task.smooth.row(y));
  }
}

// ---------------------------------------------------------------------------------------------------------------
// One step of a path

/// P2 of the step between two neighbours.
CAIRN_LANES_INLINE std::uint8_t large_penalty(const SemiGlobalTask& task, Gray a, Gray b) {
  return task.penalties.large[static_cast<std::size_t>(std::abs(a - b))];
}

/// Goes on by one pixel: `along` holds the L of the pixel before and gets this one's. `least` is the least of
/// the former in every lane; the least of the latter is returned. Where a path begins, all of them are 0.
/// use(i, C, L − C) is called for each vector.
template <class D, class Use>
CAIRN_LANES_INLINE bytes::Vec<D> go_on(D d, const std::uint8_t* costs, std::uint8_t* along,
                                       bytes::Vec<D> least, bytes::Vec<D> small, bytes::Vec<D> large,
                                       int lanes, const Use& use) {
  const auto none = bytes::Set(d, kNoLane);
  auto before = none;
  auto here = bytes::Load(d, along);
  auto least_now = none;
  for (int i = 0; i < lanes; i += lane_count(d)) {
    const auto next = i + lane_count(d) < lanes ? bytes::Load(d, along + i + lane_count(d)) : none;
    const auto neighbour = bytes::Min(bytes::SlideUp(d, before, here), bytes::SlideDown(d, here, next));
    const auto kept = bytes::Min(here, bytes::SaturatedAdd(neighbour, small));
    const auto step = bytes::Min(bytes::Sub(kept, least), large);  // Eq. 13 less C
    const auto cost = bytes::Load(d, costs + i);
    const auto sum = bytes::SaturatedAdd(cost, step);
    bytes::Store(sum, d, along + i);
    least_now = bytes::Min(least_now, sum);
    use(i, cost, step);
    before = here;
    here = next;
  }
  return bytes::MinOfAll(d, least_now);
}

/// What is done with L − C: kept, added to what is there, or added up with all the rest.
template <class D>
struct Keep {
  D d;
  std::uint8_t* steps;
  template <class V>
  CAIRN_LANES_INLINE void operator()(int i, V, V step) const {
    bytes::Store(step, d, steps + i);
  }
};
template <class D>
struct Accumulate {
  D d;
  std::uint8_t* steps;
  template <class V>
  CAIRN_LANES_INLINE void operator()(int i, V, V step) const {
    bytes::Store(bytes::Add(step, bytes::Load(d, steps + i)), d, steps + i);
  }
};
template <class D>
struct SumUp {
  D d;
  const std::uint8_t* vertical;
  const std::uint8_t* back;
  std::int16_t* sums;
  template <class V>
  CAIRN_LANES_INLINE void operator()(int i, V cost, V step) const {
    const auto horizontal = bytes::Add(step, bytes::Load(d, back + i));
    const auto twice = bytes::Add(cost, cost);
    bytes::StoreSum(d, bytes::Add(twice, twice), horizontal, bytes::Load(d, vertical + i), sums + i);
  }
};

// ---------------------------------------------------------------------------------------------------------------
// Costs, and the path down

/// Columns first … last − 1 of all rows.
template <class D>
class Descent {
 public:
  Descent(const SemiGlobalTask& task, int first, int last)
      : task_(task),
        g_(task.layout),
        first_(first),
        last_(last),
        sums_(3 * (last - first) * g_.lanes),
        along_((last - first) * g_.lanes),
        least_(last - first),
        beyond_(g_.lanes) {
    std::fill(beyond_.data() + g_.count, beyond_.data() + g_.lanes, kNoLane);
  }

  void run() {
    sum_rows(0);
    for (int y = 0; y < g_.height; ++y) {
      if (y + 1 < g_.height) sum_rows(y + 1);
      go_down(y);
    }
  }

 private:
  /// Σh over three neighbours of row y.
  [[nodiscard]] std::uint8_t* sums(int y) const {
    return sums_.data() + std::clamp(y, 0, g_.height - 1) % 3 * (last_ - first_) * g_.lanes;
  }

  void sum_rows(int y) {
    const D d;
    const std::uint8_t* left = task_.left_bits.row(y);
    const std::uint8_t* right = task_.right_bits.row(y);
    const std::uint8_t* inside = task_.inside.row(0);
    const int left_plane = round_up(g_.width, 64);
    const int right_plane = g_.length();
    for (int i = 0; i < g_.lanes; i += lane_count(d)) {
      const auto differences = [&](int x) CAIRN_LANES_ATTR {
        const std::uint8_t* l = left + x;
        const int j = g_.first_lane(x) + i;
        const bytes::Vec<D> a[3] = {bytes::Set(d, l[0]), bytes::Set(d, l[left_plane]),
                                    bytes::Set(d, l[2 * left_plane])};
        const bytes::Vec<D> b[3] = {bytes::LoadU(d, right + j), bytes::LoadU(d, right + right_plane + j),
                                    bytes::LoadU(d, right + 2 * right_plane + j)};
        const auto exists = bytes::LoadU(d, inside + j);
        const auto half = bytes::Set(d, static_cast<std::uint8_t>(kOutsideCost));
        return bytes::Or(bytes::And(bytes::CountDifferentBits(d, a, b), exists), bytes::AndNot(exists, half));
      };
      auto before = differences(std::max(0, first_ - 1));
      auto here = differences(first_);
      for (int x = first_; x < last_; ++x) {
        const auto after = differences(std::min(x + 1, g_.width - 1));
        bytes::Store(bytes::Add(bytes::Add(before, here), after), d, sums(y) + (x - first_) * g_.lanes + i);
        before = here;
        here = after;
      }
    }
  }

  void go_down(int y) {
    const D d;
    const auto small = bytes::Set(d, task_.penalties.small);
    const Gray* smooth = task_.smooth.row(y);
    const Gray* smooth_above = task_.smooth.row(std::max(0, y - 1));
    for (int x = first_; x < last_; ++x) {
      const int at = (x - first_) * g_.lanes;
      std::uint8_t* costs = task_.costs.row(y) + x * g_.lanes;
      average(sums(y - 1) + at, sums(y) + at, sums(y + 1) + at, costs);
      const auto large = bytes::Set(d, large_penalty(task_, smooth[x], smooth_above[x]));
      const auto least = go_on(d, costs, along_.data() + at, bytes::Set(d, least_[x - first_]), small, large,
                               g_.lanes, Keep<D>{d, task_.steps.row(y) + x * g_.lanes});
      least_[x - first_] = bytes::GetLane(least);
    }
  }

  void average(const std::uint8_t* above, const std::uint8_t* here, const std::uint8_t* below,
               std::uint8_t* costs) const {
    const D d;
    for (int i = 0; i < g_.lanes; i += lane_count(d)) {
      const auto sum = bytes::Add(bytes::Add(bytes::Load(d, above + i), bytes::Load(d, here + i)),
                                  bytes::Add(bytes::Load(d, below + i), bytes::Set(d, std::uint8_t{2})));
      bytes::Store(bytes::Or(bytes::ShiftRight<2>(sum), bytes::Load(d, beyond_.data() + i)), d, costs + i);
    }
  }

  const SemiGlobalTask& task_;
  const SearchLayout& g_;
  int first_;
  int last_;
  Scratch<std::uint8_t> sums_;  // of three rows
  Scratch<std::uint8_t> along_;
  Scratch<std::uint8_t> least_;
  Scratch<std::uint8_t> beyond_;  // 255 in lanes without candidate
};

// ---------------------------------------------------------------------------------------------------------------
// The path up

template <class D>
void go_up(const SemiGlobalTask& task, int first, int last, int top, int bottom) {
  const D d;
  const int lanes = task.layout.lanes;
  const auto small = bytes::Set(d, task.penalties.small);
  std::uint8_t* along = task.along.row(0);
  std::uint8_t* least = task.least.row(0);
  for (int y = bottom - 1; y >= top; --y) {
    const Gray* smooth = task.smooth.row(y);
    const Gray* smooth_below = task.smooth.row(std::min(y + 1, task.layout.height - 1));
    for (int x = first; x < last; ++x) {
      const auto large = bytes::Set(d, large_penalty(task, smooth[x], smooth_below[x]));
      const auto now = go_on(d, task.costs.row(y) + x * lanes, along + x * lanes, bytes::Set(d, least[x]),
                             small, large, lanes, Accumulate<D>{d, task.steps.row(y) + x * lanes});
      least[x] = bytes::GetLane(now);
    }
  }
}

// ---------------------------------------------------------------------------------------------------------------
// The paths to the left and to the right, and the winners

struct Winner {
  std::int16_t sum = kNoSum;
  int lane = 0;
  std::int32_t total = 0;  // of all candidates
};

/// Rows first … last − 1.
template <class D>
class Crossing {
 public:
  explicit Crossing(const SemiGlobalTask& task)
      : task_(task),
        g_(task.layout),
        stride_(g_.lanes + 2 * kBlockMargin),
        back_(g_.width * g_.lanes),
        along_(g_.lanes),
        sums_(kBlock * stride_),
        lane_numbers_(32),
        right_sum_(task.evidence == Evidence::full ? g_.length() : 0),
        right_lane_(task.evidence == Evidence::full ? g_.length() : 0) {
    std::fill_n(sums_.data(), sums_.size(), kNoSum);
    std::iota(lane_numbers_.data(), lane_numbers_.data() + lane_numbers_.size(), std::int16_t{0});
  }

  void run(int first, int last) {
    for (int y = first; y < last; ++y) {
      go_left(y);
      go_right(y);
    }
  }

 private:
  void go_left(int y) {
    const D d;
    const auto small = bytes::Set(d, task_.penalties.small);
    const Gray* smooth = task_.smooth.row(y);
    std::fill_n(along_.data(), g_.lanes, std::uint8_t{0});
    auto least = bytes::Zero(d);
    for (int x = g_.width - 1; x >= 0; --x) {
      const auto large =
          bytes::Set(d, large_penalty(task_, smooth[x], smooth[std::min(x + 1, g_.width - 1)]));
      least = go_on(d, task_.costs.row(y) + x * g_.lanes, along_.data(), least, small, large, g_.lanes,
                    Keep<D>{d, back_.data() + x * g_.lanes});
    }
  }

  void go_right(int y) {
    const D d;
    const auto small = bytes::Set(d, task_.penalties.small);
    const Gray* smooth = task_.smooth.row(y);
    std::fill_n(along_.data(), g_.lanes, std::uint8_t{0});
    std::fill_n(right_sum_.data(), right_sum_.size(), kNoSum);
    auto least = bytes::Zero(d);
    for (int x_first = 0; x_first < g_.width; x_first += kBlock) {
      const int pixels = std::min(kBlock, g_.width - x_first);
      for (int x = x_first; x < x_first + pixels; ++x) {
        const int at = x * g_.lanes;
        const auto large = bytes::Set(d, large_penalty(task_, smooth[x], smooth[std::max(x - 1, 0)]));
        least = go_on(d, task_.costs.row(y) + at, along_.data(), least, small, large, g_.lanes,
                      SumUp<D>{d, task_.steps.row(y) + at, back_.data() + at, sums_of(x - x_first)});
      }
      settle(x_first, pixels, y);
    }
    if (task_.evidence == Evidence::full) settle_right(y);
  }

  [[nodiscard]] std::int16_t* sums_of(int pixel) const {
    return sums_.data() + pixel * stride_ + kBlockMargin;
  }

  /// Writes a block's evidence. One question after the other for all its pixels, so that no pixel waits for
  /// its own answer.
  void settle(int x_first, int pixels, int y) {
    std::array<Winner, kBlock> winners;
    for (int i = 0; i < pixels; ++i) {
      const int begin = g_.begin(x_first + i);
      const int end = g_.end(x_first + i);
      winners[static_cast<std::size_t>(i)] = begin == 0 && end == g_.lanes ? find_winner<false>(i, begin, end)
                                                                           : find_winner<true>(i, begin, end);
    }
    for (int i = 0; i < pixels; ++i) {
      const auto& [sum, lane, total] = winners[static_cast<std::size_t>(i)];
      const bool found = sum < kNoSum;
      task_.out.best(x_first + i, y) = found ? static_cast<std::int16_t>(g_.first_d + lane) : kNoMatch;
      task_.out.cost(x_first + i, y) = cost_of(sum);
    }
    if (task_.evidence == Evidence::winner) return;
    const bool full = task_.evidence == Evidence::full;
    if (full) update_right(x_first, pixels);
    for (int i = 0; i < pixels; ++i) {
      const auto& [sum, lane, total] = winners[static_cast<std::size_t>(i)];
      const int x = x_first + i;
      const bool found = sum < kNoSum;
      const auto candidates = static_cast<float>(std::max(1, g_.end(x) - g_.begin(x)));
      if (full) task_.out.mean_cost(x, y) = found ? static_cast<float>(total) / candidates : kNoCost;
      task_.out.cost_before(x, y) = found ? cost_of(sums_of(i)[lane - 1]) : kNoCost;
      task_.out.cost_after(x, y) = found ? cost_of(sums_of(i)[lane + 1]) : kNoCost;
      task_.out.runner_up(x, y) = cost_of(least_beside(i, lane));
    }
  }

  static float cost_of(std::int16_t sum) { return sum < kNoSum ? static_cast<float>(sum) : kNoCost; }

  /// 0, 1, 2 … Loaded: compilers put Iota() together lane by lane.
  [[nodiscard]] CAIRN_LANES_INLINE bytes::Vec<Wide<D>> first_lanes() const {
    return bytes::Load(Wide<D>(), lane_numbers_.data());
  }

  /// The least sum of a pixel, and its first lane. With kBorder, also takes out the lanes without candidate.
  template <bool kBorder>
  Winner find_winner(int pixel, int begin, int end) {
    const Wide<D> d;
    const bytes::Repartition<std::int32_t, D> d_total;
    std::int16_t* sums = sums_of(pixel);
    const auto none = bytes::Set(d, kNoSum);
    const auto vector = bytes::Set(d, static_cast<std::int16_t>(lane_count(d)));
    auto least = none;
    auto where = bytes::Zero(d);
    auto total = bytes::Zero(d_total);
    auto lane = first_lanes();
    for (int i = 0; i < g_.lanes; i += lane_count(d)) {
      auto sum = bytes::Load(d, sums + i);
      if constexpr (kBorder) {
        const auto outside = bytes::Or(bytes::Lt(lane, bytes::Set(d, static_cast<std::int16_t>(begin))),
                                       bytes::Gt(lane, bytes::Set(d, static_cast<std::int16_t>(end - 1))));
        total = bytes::AddPairs(d, total, bytes::IfThenZeroElse(outside, sum));
        sum = bytes::IfThenElse(outside, none, sum);
        bytes::Store(sum, d, sums + i);
      } else {
        total = bytes::AddPairs(d, total, sum);
      }
      where = bytes::IfThenElse(bytes::Lt(sum, least), lane, where);
      least = bytes::Min(sum, least);
      lane = bytes::Add(lane, vector);
    }
    const auto least_of_all = bytes::MinOfAll(d, least);
    const auto first = bytes::MinOfAll(d, bytes::IfThenElse(bytes::Eq(least, least_of_all), where, none));
    return {bytes::GetLane(least_of_all), bytes::GetLane(first), bytes::SumOfAll(d_total, total)};
  }

  /// The least sum of a pixel but for a lane and its two neighbours.
  [[nodiscard]] std::int16_t least_beside(int pixel, int winner) const {
    const Wide<D> d;
    const std::int16_t* sums = sums_of(pixel);
    const auto none = bytes::Set(d, kNoSum);
    const auto one = bytes::Set(d, std::int16_t{1});
    const auto vector = bytes::Set(d, static_cast<std::int16_t>(lane_count(d)));
    auto distance = bytes::Sub(first_lanes(), bytes::Set(d, static_cast<std::int16_t>(winner)));
    auto least = none;
    for (int i = 0; i < g_.lanes; i += lane_count(d)) {
      const auto far = bytes::Gt(bytes::Abs(distance), one);
      least = bytes::Min(least, bytes::IfThenElse(far, bytes::Load(d, sums + i), none));
      distance = bytes::Add(distance, vector);
    }
    return bytes::GetLane(bytes::MinOfAll(d, least));
  }

  /// Hands a block's sums to the right pixels that they are about. A right pixel meets its left pixels from
  /// left to right, its candidates thus in ascending order: strictly less keeps the smallest disparity.
  void update_right(int x_first, int pixels) {
    const Wide<D> d;
    const auto one = bytes::Set(d, std::int16_t{1});
    const int first = g_.first_lane(x_first + pixels - 1);
    for (int j = 0; j < g_.count + pixels - 1; j += lane_count(d)) {
      auto least = bytes::LoadU(d, right_sum_.data() + first + j);
      auto where = bytes::LoadU(d, right_lane_.data() + first + j);
      auto lane = bytes::Add(first_lanes(), bytes::Set(d, static_cast<std::int16_t>(j - pixels + 1)));
      const std::int16_t* sums = sums_of(0) + j - pixels + 1;
      for (int pixel = 0; pixel < pixels; ++pixel) {
        const auto sum = bytes::LoadU(d, sums);
        where = bytes::IfThenElse(bytes::Lt(sum, least), lane, where);
        least = bytes::Min(sum, least);
        lane = bytes::Add(lane, one);
        sums += stride_ + 1;
      }
      bytes::StoreU(least, d, right_sum_.data() + first + j);
      bytes::StoreU(where, d, right_lane_.data() + first + j);
    }
  }

  void settle_right(int y) {
    for (int x = 0; x < g_.width; ++x) {
      const int j = g_.reversed(x);
      task_.out.best_right(x, y) =
          right_sum_[j] < kNoSum ? static_cast<std::int16_t>(g_.first_d + right_lane_[j]) : kNoMatch;
    }
  }

  const SemiGlobalTask& task_;
  const SearchLayout& g_;
  int stride_;
  Scratch<std::uint8_t> back_;  // L − C of the path to the left, one row
  Scratch<std::uint8_t> along_;
  Scratch<std::int16_t> sums_;  // S of a block of pixels
  Scratch<std::int16_t> lane_numbers_;
  Scratch<std::int16_t> right_sum_;   // least S of the right pixels, reversed
  Scratch<std::int16_t> right_lane_;  // and its lane
};

// ---------------------------------------------------------------------------------------------------------------

using Narrow = bytes::CappedTag<std::uint8_t, 32>;  // does not waste half a vector on 32 candidates
using Full = bytes::CappedTag<std::uint8_t, 64>;

int lanes_of(int count) {
  const int vector = count <= 32 ? lane_count(Narrow()) : lane_count(Full());
  return round_up(count, std::max(16, vector));
}
bool narrow(const SemiGlobalTask& task) {
  return task.layout.count <= 32;
}

void match_down(const SemiGlobalTask& task, int first, int last) {
  narrow(task) ? Descent<Narrow>(task, first, last).run() : Descent<Full>(task, first, last).run();
}
void match_up(const SemiGlobalTask& task, int first, int last, int top, int bottom) {
  narrow(task) ? go_up<Narrow>(task, first, last, top, bottom) : go_up<Full>(task, first, last, top, bottom);
}
void match_across(const SemiGlobalTask& task, int first, int last) {
  narrow(task) ? Crossing<Narrow>(task).run(first, last) : Crossing<Full>(task).run(first, last);
}

}  // namespace

extern const SemiGlobalKernels kSemiGlobalKernels;
const SemiGlobalKernels kSemiGlobalKernels{lanes_of, describe_rows, match_down, match_up, match_across};

}  // namespace cairn::kernels::CAIRN_KERNEL_TARGET
