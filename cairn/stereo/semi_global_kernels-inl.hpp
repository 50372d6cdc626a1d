// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// No include guard: compiled once for each target, over the vocabulary `bytes` of that target.
//
// Path accumulation. Vectors run along the disparity, one byte per candidate. Lanes beyond the last candidate
// have a cost of 255; sums saturate, so their L stays 255 and no real lane takes a minimum from them: a real
// L is at most 54 + 127. For the same reason a saturated L + P1 has no effect.
//
// A path adds at most P2 to C. Only that part is stored for the vertical paths, both in the same byte.
#include <cairn/stereo/byte_lanes-inl.hpp>
#include <cairn/stereo/lanes-inl.hpp>

namespace cairn::kernels::CAIRN_KERNEL_TARGET {
namespace {

constexpr std::uint8_t kNoLane = 255;
constexpr int kOutsideCost = 12;        // of 24 bits
constexpr std::int16_t kNoSum = 32767;  // of a missing candidate
constexpr int kBlock = 32;              // left pixels whose sums are kept at a time
constexpr int kBlockMargin = 32;  // lanes without candidate before, between and after the sums of pixels

template <class D>
CAIRN_LANES_INLINE int lane_count(D d) {
  return static_cast<int>(bytes::Lanes(d));
}

// ---------------------------------------------------------------------------------------------------------------
// Census and smoothing

/// The five rows around a row, with replicated borders. Row y − 2 … y + 2 is in slot y mod 5.
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
  /// The first real pixel.
  [[nodiscard]] const std::uint8_t* row(int y) const { return slot(y) + kBorder; }

 private:
  [[nodiscard]] std::uint8_t* slot(int y) const { return rows_.data() + (y + 5) % 5 * stride_; }
  View<const Gray> image_;
  bool mirrored_;
  int stride_;
  Scratch<std::uint8_t> rows_;
};

/// Packs eight comparisons of the window into a byte; the centre is not compared.
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

/// P2 of the step between two neighbours. `large`: indexed by the intensity step.
CAIRN_LANES_INLINE std::uint8_t large_penalty(const std::uint8_t* large, Gray a, Gray b) {
  return large[std::abs(a - b)];
}

/// The L of one pixel of a path, in memory …
template <class D>
struct MemoryPath {
  D d;
  std::uint8_t* at;
  [[nodiscard]] CAIRN_LANES_INLINE bytes::Vec<D> get(int i) const { return bytes::Load(d, at + i); }
  CAIRN_LANES_INLINE void set(int i, bytes::Vec<D> along) const { bytes::Store(along, d, at + i); }
};
/// … and in a register, if one vector holds all of it.
template <class D>
struct RegisterPath {
  bytes::Vec<D>& all;
  [[nodiscard]] CAIRN_LANES_INLINE bytes::Vec<D> get(int) const { return all; }
  CAIRN_LANES_INLINE void set(int, bytes::Vec<D> along) const { all = along; }
};

/// From one pixel of a path to the next: the minimum of L there, and the penalties.
template <class D>
struct Transition {
  bytes::Vec<D> least;
  bytes::Vec<D> small;
  bytes::Vec<D> large;
};

/// Advances by one pixel: `along` holds the L of the previous pixel and receives that of this one. `least` is
/// the minimum of the former in every lane; returns the minimum of the latter. At the start of a path, all
/// are 0. Calls use(i, C, L − C) for each vector.
template <class D, class Along, class Use>
CAIRN_LANES_INLINE bytes::Vec<D> go_on(D d, const std::uint8_t* costs, const Along& along,
                                       const Transition<D>& by, int lanes, const Use& use) {
  const auto least = by.least, small = by.small, large = by.large;
  const auto none = bytes::Set(d, kNoLane);
  auto before = none;
  auto here = along.get(0);
  auto least_now = none;
  for (int i = 0; i < lanes; i += lane_count(d)) {
    const auto next = i + lane_count(d) < lanes ? along.get(i + lane_count(d)) : none;
    const auto neighbour = bytes::Min(bytes::SlideUp(d, before, here), bytes::SlideDown(d, here, next));
    const auto kept = bytes::Min(here, bytes::SaturatedAdd(neighbour, small));
    const auto step = bytes::Min(bytes::Sub(kept, least), large);  // Eq. 13 minus C
    const auto cost = bytes::Load(d, costs + i);
    const auto sum = bytes::SaturatedAdd(cost, step);
    along.set(i, sum);
    least_now = bytes::Min(least_now, sum);
    use(i, cost, step);
    before = here;
    here = next;
  }
  return bytes::MinOfAll(d, least_now);
}

/// The use of L − C: none, stored, added to the stored value, or added to the total.
struct Forget {
  template <class V>
  CAIRN_LANES_INLINE void operator()(int, V, V) const {}
};
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

/// Columns first … last − 1.
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
        cost_(g_.lanes),
        beyond_(g_.lanes) {
    std::fill(beyond_.data() + g_.count, beyond_.data() + g_.lanes, kNoLane);
  }

  /// All rows; keeps the last band.
  void run() {
    sum_rows(0);
    for (int y = 0; y < g_.height; ++y) {
      const int band = y / task_.band_rows;
      if (y == band * task_.band_rows) {
        std::copy_n(along_.data(), along_.size(), band_along(band));
        std::copy_n(least_.data(), least_.size(), band_least(band));
      }
      if (y + 1 < g_.height) sum_rows(y + 1);
      band + 1 == task_.bands() ? go_down<true>(y) : go_down<false>(y);
    }
  }
  /// The rows of a band.
  void run(int band) {
    std::copy_n(band_along(band), along_.size(), along_.data());
    std::copy_n(band_least(band), least_.size(), least_.data());
    const int top = band * task_.band_rows;
    const int bottom = std::min(g_.height, top + task_.band_rows);
    if (top > 0) sum_rows(top - 1);
    sum_rows(top);
    for (int y = top; y < bottom; ++y) {
      if (y + 1 < g_.height) sum_rows(y + 1);
      go_down<true>(y);
    }
  }

 private:
  [[nodiscard]] std::uint8_t* band_along(int band) const {
    return task_.band_along.row(band) + first_ * g_.lanes;
  }
  [[nodiscard]] std::uint8_t* band_least(int band) const { return task_.band_least.row(band) + first_; }

  /// Σh over three neighbours in row y.
  [[nodiscard]] std::uint8_t* sums(int y) const {
    return sums_.data() + std::clamp(y, 0, g_.height - 1) % 3 * (last_ - first_) * g_.lanes;
  }

  // Data behind pointers is copied first, here and below: for the compiler, a stored vector of bytes may
  // alias any of it.

  void sum_rows(int y) {
    const D d;
    const std::uint8_t* const left = task_.left_bits.row(y);
    const std::uint8_t* const right = task_.right_bits.row(y) + g_.first_lane(0);
    const std::uint8_t* const inside = task_.inside.row(0) + g_.first_lane(0);
    const int left_plane = round_up(g_.width, 64);
    const int right_plane = g_.length();
    const int lanes = g_.lanes;
    const int most_x = g_.width - 1;
    const int first = first_;
    const int last = last_;
    std::uint8_t* const out = sums(y);
    for (int i = 0; i < lanes; i += lane_count(d)) {
      const auto differences = [=](int x) CAIRN_LANES_ATTR {
        const std::uint8_t* l = left + x;
        const std::uint8_t* r = right - x + i;
        const bytes::Vec<D> a[3] = {bytes::Set(d, l[0]), bytes::Set(d, l[left_plane]),
                                    bytes::Set(d, l[2 * left_plane])};
        const bytes::Vec<D> b[3] = {bytes::LoadU(d, r), bytes::LoadU(d, r + right_plane),
                                    bytes::LoadU(d, r + 2 * right_plane)};
        const auto exists = bytes::LoadU(d, inside - x + i);
        const auto half = bytes::Set(d, static_cast<std::uint8_t>(kOutsideCost));
        return bytes::Or(bytes::And(bytes::CountDifferentBits(d, a, b), exists), bytes::AndNot(exists, half));
      };
      auto before = differences(std::max(0, first - 1));
      auto here = differences(first);
      for (int x = first; x < last; ++x) {
        const auto after = differences(std::min(x + 1, most_x));
        bytes::Store(bytes::Add(bytes::Add(before, here), after), d, out + (x - first) * lanes + i);
        before = here;
        here = after;
      }
    }
  }

  template <bool kKeeps>
  void go_down(int y) {
    const D d;
    const auto small = bytes::Set(d, task_.penalties.small);
    const std::uint8_t* const large = task_.penalties.large.data();
    const int lanes = g_.lanes;
    const int count = last_ - first_;
    const Gray* const smooth = task_.smooth.row(y) + first_;
    const Gray* const smooth_above = task_.smooth.row(std::max(0, y - 1)) + first_;
    const std::uint8_t* const above = sums(y - 1);
    const std::uint8_t* const here = sums(y);
    const std::uint8_t* const below = sums(y + 1);
    const std::uint8_t* const beyond = beyond_.data();
    std::uint8_t* const costs = kKeeps ? task_.costs_of(y) + first_ * lanes : cost_.data();
    std::uint8_t* const steps = kKeeps ? task_.steps_of(y) + first_ * lanes : nullptr;
    std::uint8_t* const along = along_.data();
    std::uint8_t* const least = least_.data();
    for (int x = 0; x < count; ++x) {
      const int at = x * lanes;
      std::uint8_t* const cost = costs + (kKeeps ? at : 0);
      average(above + at, here + at, below + at, beyond, lanes, cost);
      const auto penalty = bytes::Set(d, large_penalty(large, smooth[x], smooth_above[x]));
      const Transition<D> by{bytes::Set(d, least[x]), small, penalty};
      const MemoryPath<D> path{d, along + at};
      if constexpr (kKeeps) {
        least[x] = bytes::GetLane(go_on(d, cost, path, by, lanes, Keep<D>{d, steps + at}));
      } else {
        least[x] = bytes::GetLane(go_on(d, cost, path, by, lanes, Forget()));
      }
    }
  }

  static CAIRN_LANES_INLINE void average(const std::uint8_t* above, const std::uint8_t* here,
                                         const std::uint8_t* below, const std::uint8_t* beyond, int lanes,
                                         std::uint8_t* costs) {
    const D d;
    for (int i = 0; i < lanes; i += lane_count(d)) {
      const auto sum = bytes::Add(bytes::Add(bytes::Load(d, above + i), bytes::Load(d, here + i)),
                                  bytes::Add(bytes::Load(d, below + i), bytes::Set(d, std::uint8_t{2})));
      bytes::Store(bytes::Or(bytes::ShiftRight<2>(sum), bytes::Load(d, beyond + i)), d, costs + i);
    }
  }

  const SemiGlobalTask& task_;
  const SearchLayout& g_;
  int first_;
  int last_;
  Scratch<std::uint8_t> sums_;  // of three rows
  Scratch<std::uint8_t> along_;
  Scratch<std::uint8_t> least_;
  Scratch<std::uint8_t> cost_;    // of one pixel
  Scratch<std::uint8_t> beyond_;  // 255 in lanes without candidate
};

// ---------------------------------------------------------------------------------------------------------------
// The path up

template <class D>
void go_up(const SemiGlobalTask& task, int first, int last, int top, int bottom) {
  const D d;
  const int lanes = task.layout.lanes;
  const auto small = bytes::Set(d, task.penalties.small);
  const std::uint8_t* const large = task.penalties.large.data();
  std::uint8_t* const along = task.along.row(0);
  std::uint8_t* const least = task.least.row(0);
  for (int y = bottom - 1; y >= top; --y) {
    const Gray* const smooth = task.smooth.row(y);
    const Gray* const smooth_below = task.smooth.row(std::min(y + 1, task.layout.height - 1));
    const std::uint8_t* const costs = task.costs_of(y);
    std::uint8_t* const steps = task.steps_of(y);
    const int next_y = std::max(y - 1, top);
    const std::uint8_t* const next_costs = task.costs_of(next_y);
    const std::uint8_t* const next_steps = task.steps_of(next_y);
    for (int x = first; x < last; ++x) {
      const int at = x * lanes;
      expect_reads(next_costs + at, lanes);
      expect_writes(next_steps + at, lanes);
      const auto penalty = bytes::Set(d, large_penalty(large, smooth[x], smooth_below[x]));
      const auto now = go_on(d, costs + at, MemoryPath<D>{d, along + at},
                             {bytes::Set(d, least[x]), small, penalty}, lanes, Accumulate<D>{d, steps + at});
      least[x] = bytes::GetLane(now);
    }
  }
}

// ---------------------------------------------------------------------------------------------------------------
// The paths to the left and to the right, and the winners

/// Rows first … last − 1. Each pixel of a path depends on the one before, which leaves a processor mostly
/// idle: so the paths of up to kRowsAbreast rows are computed concurrently.
template <class D, bool kOneVector>
class Crossing {
  using Sums = lanes::CappedTag<std::int16_t, 32>;
  static constexpr int kSums = static_cast<int>(lanes::MaxLanes(Sums()));
  static constexpr int kTileBits = 6;
  static constexpr int kTile = 1 << kTileBits;
  static constexpr std::int16_t kMaxSum = 1023;  // four times 54 + 127 are less

 public:
  explicit Crossing(const SemiGlobalTask& task)
      : task_(task),
        g_(task.layout),
        stride_(g_.lanes + kBlockMargin),
        back_(kRowsAbreast * g_.width * g_.lanes),
        along_(kRowsAbreast * g_.lanes),
        sums_(kRowsAbreast * kBlock * stride_ + kBlockMargin),
        candidates_(g_.width),
        right_length_(task.maps == MatchMaps::full ? g_.length() : 0),
        right_sum_(kRowsAbreast * right_length_),
        right_lane_(kRowsAbreast * right_length_) {
    std::fill_n(sums_.data(), sums_.size(), kNoSum);
    for (int x = 0; x < g_.width; ++x) candidates_[x] = g_.end(x) - g_.begin(x);
  }

  void run(int first, int last) {
    int y = first;
    for (; y + kRowsAbreast <= last; y += kRowsAbreast) cross<kRowsAbreast>(y);
    for (; y < last; ++y) cross<1>(y);
  }

 private:
  template <int kRows>
  void cross(int y) {
    go_left<kRows>(y);
    go_right<kRows>(y);
  }

  /// The paths of some rows in one direction.
  template <int kRows>
  struct Paths {
    const std::uint8_t* costs[kRows];
    const Gray* smooth[kRows];
    std::uint8_t* along;  // unless in a register
    const std::uint8_t* large;
    int lanes;
    bytes::Vec<D> small;
    bytes::Vec<D> held[kRows];
    bytes::Vec<D> least[kRows];

    /// Advances by pixel x in each row, coming from pixel `from`. use(row) returns the function called for
    /// each vector.
    template <class Use>
    CAIRN_LANES_INLINE void step(int x, int from, const Use& use) {
      const D d;
      CAIRN_UNROLL
      for (int row = 0; row < kRows; ++row) {
        const auto penalty = bytes::Set(d, large_penalty(large, smooth[row][x], smooth[row][from]));
        if constexpr (kOneVector) {
          least[row] = go_on(d, costs[row] + x * lanes, RegisterPath<D>{held[row]},
                             {least[row], small, penalty}, lane_count(d), use(row));
        } else {
          least[row] = go_on(d, costs[row] + x * lanes, MemoryPath<D>{d, along + row * lanes},
                             {least[row], small, penalty}, lanes, use(row));
        }
      }
    }
  };

  template <int kRows>
  CAIRN_LANES_INLINE Paths<kRows> paths_of(int y) {
    const D d;
    Paths<kRows> paths;
    std::fill_n(along_.data(), along_.size(), std::uint8_t{0});
    for (int row = 0; row < kRows; ++row) {
      paths.costs[row] = task_.costs_of(y + row);
      paths.smooth[row] = task_.smooth.row(y + row);
      paths.held[row] = bytes::Zero(d);
      paths.least[row] = bytes::Zero(d);
    }
    paths.along = along_.data();
    paths.large = task_.penalties.large.data();
    paths.lanes = g_.lanes;
    paths.small = bytes::Set(d, task_.penalties.small);
    return paths;
  }

  template <int kRows>
  void go_left(int y) {
    const D d;
    const int width = g_.width;
    const int lanes = g_.lanes;
    std::uint8_t* const back = back_.data();
    auto paths = paths_of<kRows>(y);
    for (int x = width - 1; x >= 0; --x) {
      paths.step(x, std::min(x + 1, width - 1), [=](int row) CAIRN_LANES_ATTR {
        return Keep<D>{d, back + (row * width + x) * lanes};
      });
    }
  }

  template <int kRows>
  void go_right(int y) {
    const int width = g_.width;
    std::fill_n(right_sum_.data(), right_sum_.size(), kNoSum);
    auto paths = paths_of<kRows>(y);
    for (int x_first = 0; x_first < width; x_first += kBlock) {
      const int pixels = std::min(kBlock, width - x_first);
      for (int row = 0; row < kRows; ++row) expect_maps(x_first, y + row);
      sum_up<kRows>(paths, y, x_first, pixels);
      for (int row = 0; row < kRows; ++row) settle(row, x_first, pixels, y + row);
    }
    for (int row = 0; row < kRows && task_.maps == MatchMaps::full; ++row) settle_right(y, row);
  }

  template <int kRows>
  CAIRN_LANES_INLINE void sum_up(Paths<kRows>& known, int y, int x_first, int pixels) const {
    const D d;
    const int lanes = g_.lanes;
    const std::uint8_t* vertical[kRows];
    const std::uint8_t* back[kRows];
    std::int16_t* sums[kRows];
    for (int row = 0; row < kRows; ++row) {
      vertical[row] = task_.steps_of(y + row);
      back[row] = back_of(row);
      sums[row] = sums_of(row, 0);
    }
    const int stride = stride_;
    Paths<kRows> paths = known;
    for (int x = x_first; x < x_first + pixels; ++x) {
      const int at = x * lanes;
      paths.step(x, std::max(x - 1, 0), [&](int row) CAIRN_LANES_ATTR {
        return SumUp<D>{d, vertical[row] + at, back[row] + at, sums[row] + (x - x_first) * stride};
      });
    }
    for (int row = 0; row < kRows; ++row) {
      known.held[row] = paths.held[row];
      known.least[row] = paths.least[row];
    }
  }

  /// Prefetches the memory of the maps of a block.
  CAIRN_LANES_INLINE void expect_maps(int x_first, int y) const {
    const Matches& out = task_.out;
    expect_writes(out.best.row(y) + x_first, kBlock);
    expect_writes(out.cost.row(y) + x_first, kBlock);
    if (task_.maps == MatchMaps::winner) return;
    for (const Image<float>* map : {&out.cost_before, &out.cost_after, &out.runner_up})
      expect_writes(map->row(y) + x_first, kBlock);
    if (task_.maps == MatchMaps::full) expect_writes(out.mean_cost.row(y) + x_first, kBlock);
  }

  [[nodiscard]] std::uint8_t* back_of(int row) const { return back_.data() + row * g_.width * g_.lanes; }
  [[nodiscard]] std::int16_t* sums_of(int row, int pixel) const {
    return sums_.data() + (row * kBlock + pixel) * stride_ + kBlockMargin;
  }

  /// One number per pixel of a block.
  template <class T>
  using OfBlock = std::array<T, kBlock>;

  /// Writes the maps of a block, one property after the other for all its pixels, so that pixels do not wait
  /// for each other. Computes whole blocks, also at the end of a row. `row`: index among the concurrent rows.
  void settle(int row, int x_first, int pixels, int y) {
    const std::int32_t* const candidates = candidates_.data() + x_first;
    if (std::min(candidates[0], candidates[pixels - 1]) < g_.lanes) hide_missing(row, x_first, pixels);
    alignas(64) OfBlock<std::int16_t> least;
    alignas(64) OfBlock<std::int16_t> lane;
    find_winners(row, least, lane);
    std::int16_t* const best = task_.out.best.row(y) + x_first;
    for (int i = 0; i < pixels; ++i) {
      const auto index = static_cast<std::size_t>(i);
      best[i] = least[index] < kNoSum ? static_cast<std::int16_t>(g_.first_d + lane[index]) : kNoMatch;
    }
    write_costs(least, pixels, task_.out.cost.row(y) + x_first);
    if (task_.maps == MatchMaps::winner) return;
    if (task_.maps == MatchMaps::full) {
      write_means(row, x_first, pixels, task_.out.mean_cost.row(y) + x_first);
      update_right(row, x_first, pixels);
    }
    OfBlock<std::int16_t> before;
    OfBlock<std::int16_t> after;
    for (std::size_t i = 0; i < kBlock; ++i) {
      std::int16_t* const sums = sums_of(row, static_cast<int>(i)) + lane[i];
      before[i] = sums[-1];
      after[i] = sums[1];
      sums[-1] = sums[0] = sums[1] = kNoSum;  // so that the runner-up is the minimum of the rest
    }
    alignas(64) OfBlock<std::int16_t> runner_up;
    fold<Sums, lanes::Lesser>(
        [&](int pixel) CAIRN_LANES_ATTR {
          const std::int16_t* const sums = sums_of(row, pixel);
          auto least_other = lanes::Load(Sums(), sums);
          for (int i = kSums; i < g_.lanes; i += kSums)
            least_other = lanes::Min(least_other, lanes::Load(Sums(), sums + i));
          return least_other;
        },
        runner_up.data());
    write_costs(before, pixels, task_.out.cost_before.row(y) + x_first);
    write_costs(after, pixels, task_.out.cost_after.row(y) + x_first);
    write_costs(runner_up, pixels, task_.out.runner_up.row(y) + x_first);
  }

  static void write_costs(const OfBlock<std::int16_t>& sums, int pixels, float* CAIRN_RESTRICT out) {
    for (int i = 0; i < pixels; ++i) {
      const std::int16_t sum = sums[static_cast<std::size_t>(i)];
      out[i] = sum < kNoSum ? static_cast<float>(sum) : kNoCost;
    }
  }

  /// Masks the lanes without candidate.
  void hide_missing(int row, int x_first, int pixels) const {
    const Sums d;
    const auto none = lanes::Set(d, kNoSum);
    for (int pixel = 0; pixel < pixels; ++pixel) {
      std::int16_t* const sums = sums_of(row, pixel);
      const auto first = lanes::Set(d, static_cast<std::int16_t>(g_.begin(x_first + pixel)));
      const auto last = lanes::Set(d, static_cast<std::int16_t>(g_.end(x_first + pixel) - 1));
      for (int i = 0; i < g_.lanes; i += kSums) {
        const auto lane = lanes::CountFrom(d, static_cast<std::int16_t>(i));
        const auto outside = lanes::Or(lanes::Lt(lane, first), lanes::Gt(lane, last));
        lanes::Store(lanes::IfThenElse(outside, none, lanes::Load(d, sums + i)), d, sums + i);
      }
    }
  }

  /// out[pixel] = the reduction of of(pixel).
  template <class Tag, class Op, class Of, class T>
  static CAIRN_LANES_INLINE void fold(const Of& of, T* out) {
    constexpr int kPixels = lanes::kFolded<Tag>;
    for (int pixel = 0; pixel < kBlock; pixel += kPixels) {
      lanes::Vec<Tag> of_pixel[kPixels];
      CAIRN_UNROLL
      for (int i = 0; i < kPixels; ++i) of_pixel[i] = of(pixel + i);
      lanes::Store(lanes::FoldEach<Op>(Tag(), of_pixel), lanes::Folded<Tag>(), out + pixel);
    }
  }

  /// The minimum sum of each pixel, and the first lane with it. Sums take ten bits, and the index of one of
  /// 64 lanes the six bits below: the minimum of these numbers gives both.
  void find_winners(int row, OfBlock<std::int16_t>& least, OfBlock<std::int16_t>& lane) const {
    least.fill(kNoSum);
    lane.fill(0);
    for (int first = 0; first < g_.lanes; first += kTile) {
      alignas(64) OfBlock<std::int16_t> tagged;
      fold<Sums, lanes::Lesser>(
          [&](int pixel) CAIRN_LANES_ATTR { return least_of_tile(sums_of(row, pixel) + first, first); },
          tagged.data());
      for (std::size_t i = 0; i < kBlock; ++i) {
        const int number = tagged[i] + 32768;
        const bool less = number >> kTileBits < std::min<int>(least[i], kMaxSum);
        least[i] = less ? static_cast<std::int16_t>(number >> kTileBits) : least[i];
        lane[i] = less ? static_cast<std::int16_t>(first + number % kTile) : lane[i];
      }
    }
  }

  [[nodiscard]] CAIRN_LANES_INLINE lanes::Vec<Sums> least_of_tile(const std::int16_t* sums, int first) const {
    const Sums d;
    auto least = lanes::Set(d, std::int16_t{32767});
    for (int i = 0; i < std::min(kTile, g_.lanes - first); i += kSums) {
      const auto capped = lanes::Min(lanes::Load(d, sums + i), lanes::Set(d, kMaxSum));
      const auto number = lanes::CountFrom(d, static_cast<std::int16_t>(i - 32768));
      least = lanes::Min(least, lanes::Add(lanes::ShiftLeft<kTileBits>(capped), number));
    }
    return least;
  }

  /// The mean over all candidates.
  void write_means(int row, int x_first, int pixels, float* CAIRN_RESTRICT out) const {
    alignas(64) OfBlock<std::int32_t> totals;
    fold<lanes::SumTag<Sums>, lanes::Sum>(
        [&](int pixel) CAIRN_LANES_ATTR {
          const std::int16_t* const sums = sums_of(row, pixel);
          auto total = lanes::ZeroSum(Sums());
          for (int i = 0; i < g_.lanes; i += kSums)
            total = lanes::AddPairs(Sums(), total, lanes::Load(Sums(), sums + i));
          return total;
        },
        totals.data());
    const std::int32_t* const candidates = candidates_.data() + x_first;
    for (int i = 0; i < pixels; ++i) {
      const int total = totals[static_cast<std::size_t>(i)] - (g_.lanes - candidates[i]) * kNoSum;
      const float mean = static_cast<float>(total) / static_cast<float>(std::max(1, candidates[i]));
      out[i] = candidates[i] > 0 ? mean : kNoCost;
    }
  }

  /// Passes the sums of a block to the matching right pixels. A right pixel meets its left pixels from left
  /// to right, hence its candidates in ascending order: strict comparison keeps the smallest disparity.
  void update_right(int row, int x_first, int pixels) {
    const Sums d;
    const auto one = lanes::Set(d, std::int16_t{1});
    const int first = row * right_length_ + g_.first_lane(x_first + pixels - 1);
    std::int16_t* const right_sum = right_sum_.data() + first;
    std::int16_t* const right_lane = right_lane_.data() + first;
    for (int j = 0; j < g_.count + pixels - 1; j += kSums) {
      auto least = lanes::LoadU(d, right_sum + j);
      auto where = lanes::LoadU(d, right_lane + j);
      auto lane = lanes::CountFrom(d, static_cast<std::int16_t>(j - pixels + 1));
      const std::int16_t* sums = sums_of(row, 0) + j - pixels + 1;
      for (int pixel = 0; pixel < pixels; ++pixel) {
        const auto sum = lanes::LoadU(d, sums);
        where = lanes::IfThenElse(lanes::Lt(sum, least), lane, where);
        least = lanes::Min(sum, least);
        lane = lanes::Add(lane, one);
        sums += stride_ + 1;
      }
      lanes::StoreU(least, d, right_sum + j);
      lanes::StoreU(where, d, right_lane + j);
    }
  }

  void settle_right(int first_row, int row) {
    for (int x = 0; x < g_.width; ++x) {
      const int j = row * right_length_ + g_.reversed(x);
      task_.out.best_right(x, first_row + row) =
          right_sum_[j] < kNoSum ? static_cast<std::int16_t>(g_.first_d + right_lane_[j]) : kNoMatch;
    }
  }

  const SemiGlobalTask& task_;
  const SearchLayout& g_;
  int stride_;
  Scratch<std::uint8_t> back_;  // for each concurrent row: L − C of the leftward path
  Scratch<std::uint8_t> along_;
  Scratch<std::int16_t> sums_;        // S of a block of pixels
  Scratch<std::int32_t> candidates_;  // [x]: number of candidates
  int right_length_;
  Scratch<std::int16_t> right_sum_;   // minimum S of the right pixels, reversed
  Scratch<std::int16_t> right_lane_;  // and its lane
};

// ---------------------------------------------------------------------------------------------------------------

using Narrow = bytes::CappedTag<std::uint8_t, 32>;  // avoids half-empty vectors for 32 candidates
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
void match_band(const SemiGlobalTask& task, int first, int last, int band) {
  narrow(task) ? Descent<Narrow>(task, first, last).run(band) : Descent<Full>(task, first, last).run(band);
}
void match_up(const SemiGlobalTask& task, int first, int last, int top, int bottom) {
  narrow(task) ? go_up<Narrow>(task, first, last, top, bottom) : go_up<Full>(task, first, last, top, bottom);
}
template <class D>
void go_across(const SemiGlobalTask& task, int first, int last) {
  if (task.layout.lanes == lane_count(D())) {
    Crossing<D, true>(task).run(first, last);
  } else {
    Crossing<D, false>(task).run(first, last);
  }
}
void match_across(const SemiGlobalTask& task, int first, int last) {
  narrow(task) ? go_across<Narrow>(task, first, last) : go_across<Full>(task, first, last);
}

}  // namespace

extern const SemiGlobalKernels kSemiGlobalKernels;
const SemiGlobalKernels kSemiGlobalKernels{lanes_of,   describe_rows, match_down,
                                           match_band, match_up,      match_across};

}  // namespace cairn::kernels::CAIRN_KERNEL_TARGET
