// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// No include guard: compiled once for each target, over the vocabulary `lanes` of that target.
//
// Matching of a row. Vectors run along the disparity: lane i of left pixel x is d = first_d + i. The right
// row is stored reversed, so that the candidates x − d of a left pixel are contiguous in memory:
//
//   reversed index j = pad + width − 1 − x_right         candidate of lane i:  j = first_lane(x) + i
//
// column_sums[x][i] is the sum over the rows of the window of the term of pixel x and its candidate i (a
// product, or an absolute difference). One row further down, it changes by the incoming and the outgoing row.
// Both are stored in one number, a pair, so that one load fetches them and one multiply-add of pairs gives
// the change. One pixel further right, the box sum gains a column and loses one. So the cost of a candidate
// does not depend on the window size, and one row of columns is kept instead of a cost volume.
//
// A column without candidate inside the right image has the sum 0 and does not contribute: this implements
// the clipping.

namespace cairn::kernels::CAIRN_KERNEL_TARGET {
namespace {

constexpr bool correlates(Cost cost) {
  return cost != Cost::sad && cost != Cost::zsad;
}

constexpr int kMargin = 32;  // lanes without candidate before and after those of a pixel
constexpr int kBefore = 16;  // of them before the first: keeps the neighbour of lane 0 within its cache line
constexpr int kTile = 64;    // lanes whose box sums are in registers at a time

/// The type of sums and costs that fits every operator.
struct Wide {
  using SumTag = lanes::CappedTag<std::int32_t, 16>;
  using CostTag = lanes::Rebind<float, SumTag>;
  using Sum = std::int32_t;
  using Cost = float;
  static constexpr int kShift = 0;                   // costs are scaled by 2^kShift
  static constexpr Sum empty_box(int) { return 0; }  // the sum over no pixels
  /// The incoming and the outgoing row.
  static constexpr Sum pair_of(int incoming, int outgoing) {
    return static_cast<Sum>(static_cast<std::uint32_t>(outgoing) << 16 |
                            (static_cast<std::uint32_t>(incoming) & 0xFFFFU));
  }
};

/// Half as wide, for sad with window sums below 65536. Sums and costs are stored minus 32768, as signed
/// numbers, which every target can compare.
struct Narrow {
  using SumTag = lanes::CappedTag<std::int16_t, 16>;  // twice as wide vectors took a fifth longer on Zen 4
  using CostTag = SumTag;
  using Sum = std::int16_t;
  using Cost = std::int16_t;
  static constexpr int kShift = 0;
  static constexpr int kLargestSum = 65534;
  static constexpr Sum empty_box(int) { return std::numeric_limits<Sum>::min(); }
  static constexpr Sum pair_of(int incoming, int outgoing) {
    return static_cast<Sum>(outgoing << 8 | incoming);
  }
};

/// Like Narrow, for window sums below 8192 and differences below 128: three bits below the sum tell which
/// eight lanes of a tile it belongs to. All terms added to a sum are multiples of eight and leave these bits
/// unchanged. So the minimum, together with its position among eight lanes, identifies the winner without a
/// separate index.
struct TaggedCost : Narrow {
  static constexpr int kShift = 3;
  static constexpr int kLargestSum = 8190;
  static constexpr int kLargestDifference = 127;
  static constexpr Sum empty_box(int lane) { return static_cast<Sum>(Narrow::empty_box(0) + lane / 8); }
};

/// The cost of a missing candidate: above any cost.
template <class Lane>
constexpr Lane kNone = std::numeric_limits<Lane>::max();
template <>
constexpr float kNone<float> = kNoCost;

/// The position of a left pixel: nothing clipped or missing; near a border; so near to the right border that
/// no column joins its window any more.
enum class Place : std::uint8_t { inside, border, right_end };

template <class Width>
CAIRN_LANES_INLINE int lane_count() {
  return static_cast<int>(lanes::Lanes(typename Width::SumTag()));
}

/// The number of vectors for the lanes of a tile.
template <class Width, int kLanes>
constexpr int kVectors = kLanes / static_cast<int>(lanes::MaxLanes(typename Width::SumTag()));

using F = Wide::CostTag;
using I = Wide::SumTag;
using VF = lanes::Vec<F>;
using VI = lanes::Vec<I>;

/// For operators with N·ΣLR − ΣL·ΣR, left pixels are pre-multiplied by the N of whole windows if 16 bits
/// suffice: box sums then need no multiplication.
constexpr bool takes_covariance(Cost cost) {
  return cost == Cost::zncc || cost == Cost::zssd;
}
constexpr int left_scale(const MatchConfig& config) {
  const int n = config.window_size * config.window_size;
  return takes_covariance(config.cost) && n * 255 <= std::numeric_limits<std::int16_t>::max() ? n : 1;
}
/// 1/odd modulo 2^32. Each step doubles the number of correct bits.
constexpr std::int32_t inverse_of_odd(int odd) {
  const auto number = static_cast<std::uint32_t>(odd);
  std::uint32_t inverse = number;
  for (int i = 0; i < 4; ++i) inverse *= 2 - number * inverse;
  return static_cast<std::int32_t>(inverse);
}
static_assert(static_cast<std::uint32_t>(inverse_of_odd(81)) * 81U == 1);

/// The search range, and the position of the candidates of a left pixel in the reversed right row.
struct Geometry {
  int width;
  int height;
  int half;              // of the window, rounded down
  int first_d;           // px
  int count;             // candidates
  int lanes;             // number of candidates, rounded up to half tiles
  int pad;               // entries before the reversed row
  int length;            // of a reversed row with all its margins
  int scale;             // factor of left pixels in pairs, hence of sums of products
  std::int32_t unscale;  // 1/scale

  explicit Geometry(const MatchTask& task)
      : width(task.out.best.width()),
        height(task.out.best.height()),
        half(task.config.window_size / 2),
        first_d(task.config.min_disparity),
        count(task.config.num_disparities),
        lanes(round_up(count, kTile / 2)),
        pad(std::max(0, -first_d)),
        length(round_up(pad + width + std::max(0, first_d) + lanes + 64, 16)),
        scale(left_scale(task.config)),
        unscale(inverse_of_odd(scale)) {}

  [[nodiscard]] int reversed(int x_right) const { return pad + width - 1 - x_right; }
  [[nodiscard]] int first_lane(int x) const { return reversed(x - first_d); }
  /// The columns of a tile are contiguous, so that a walk along the row reads memory in order. `first`: first
  /// lane of the tile; the last tile may be half. The columns before x = 0 stay 0.
  [[nodiscard]] int tile_lanes(int first) const { return std::min(kTile, lanes - first); }
  [[nodiscard]] int columns() const { return half + 1 + width; }
  [[nodiscard]] std::ptrdiff_t column(int x, int first) const {
    return static_cast<std::ptrdiff_t>(first) * columns() + (half + 1 + x) * tile_lanes(first);
  }
  /// The candidates of x inside the right image: lanes begin … end − 1.
  [[nodiscard]] int begin(int x) const { return std::clamp(x - width + 1 - first_d, 0, count); }
  [[nodiscard]] int end(int x) const { return std::clamp(x - first_d + 1, begin(x), count); }
};

}  // namespace
}  // namespace cairn::kernels::CAIRN_KERNEL_TARGET
