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
// that goes out. Both stand side by side in one number, a pair, so that one load fetches them and one
// multiply-add of pairs gives the change. One pixel further right, the box sum gains a column and loses one.
// So a candidate's price does not depend on the window, and what is kept is one row of columns, never a
// volume of costs.
//
// A column without partner inside the right image sums up to 0 and thus leaves the window: that is the
// clipping.

namespace cairn::kernels::CAIRN_KERNEL_TARGET {
namespace {

constexpr bool correlates(Cost cost) {
  return cost != Cost::sad && cost != Cost::zsad;
}

constexpr int kMargin = 32;  // lanes without candidate before and after a pixel's
constexpr int kBefore = 16;  // of them before the first: no neighbour of lane 0 is across a cache line
constexpr int kTile = 64;    // lanes whose box sums are held in registers at a time

/// How wide sums and costs are. Every operator fits these.
struct Wide {
  using SumTag = lanes::CappedTag<std::int32_t, 16>;
  using CostTag = lanes::Rebind<float, SumTag>;
  using Sum = std::int32_t;
  using Cost = float;
  static constexpr int kShift = 0;                   // costs are kept times 2^kShift
  static constexpr Sum empty_box(int) { return 0; }  // the sum over no pixels
  /// The row that comes in and the one that goes out.
  static constexpr Sum pair_of(int incoming, int outgoing) {
    return static_cast<Sum>(static_cast<std::uint32_t>(outgoing) << 16 |
                            (static_cast<std::uint32_t>(incoming) & 0xFFFFU));
  }
};

/// Half as wide, for sad where no window's sum can reach 65535. Sums and costs are kept less 32768, as signed
/// numbers: those are what every target compares.
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

/// As Narrow, where no window's sum can reach 8191 and no difference 128: above three bits that say which
/// eight of a tile's lanes a sum belongs to. Whatever is added to a sum is a multiple of eight and leaves
/// them alone. So the least of these numbers, and which of eight lanes it stands in, is the winner, and no
/// index has to be carried along.
struct Tagged : Narrow {
  static constexpr int kShift = 3;
  static constexpr int kLargestSum = 8190;
  static constexpr int kLargestDifference = 127;
  static constexpr Sum empty_box(int lane) { return static_cast<Sum>(Narrow::empty_box(0) + lane / 8); }
};

/// What stands for the cost where there is no candidate: more than any cost.
template <class Lane>
constexpr Lane kNone = std::numeric_limits<Lane>::max();
template <>
constexpr float kNone<float> = kNoCost;

/// Where a left pixel stands: where nothing is clipped and nothing missing; near the border; so near to the
/// right one that no column joins its window any more.
enum class Place : std::uint8_t { inside, border, right_end };

template <class Width>
CAIRN_LANES_INLINE int lane_count() {
  return static_cast<int>(lanes::Lanes(typename Width::SumTag()));
}

/// How many vectors a tile of so many lanes takes.
template <class Width, int kLanes>
constexpr int kVectors = kLanes / static_cast<int>(lanes::MaxLanes(typename Width::SumTag()));

using F = Wide::CostTag;
using I = Wide::SumTag;
using VF = lanes::Vec<F>;
using VI = lanes::Vec<I>;

/// Where N·ΣLR − ΣL·ΣR is asked for, left pixels are taken times the N of whole windows, as far as 16 bits
/// hold that: no box sum has to be multiplied with it then.
constexpr bool takes_covariance(Cost cost) {
  return cost == Cost::zncc || cost == Cost::zssd;
}
constexpr int left_scale(const MatchConfig& config) {
  const int n = config.window_size * config.window_size;
  return takes_covariance(config.cost) && n * 255 <= std::numeric_limits<std::int16_t>::max() ? n : 1;
}
/// 1/odd in integers of 32 bits, where what overflows wraps around. Each step doubles the bits that are
/// right.
constexpr std::int32_t inverse_of_odd(int odd) {
  const auto number = static_cast<std::uint32_t>(odd);
  std::uint32_t inverse = number;
  for (int i = 0; i < 4; ++i) inverse *= 2 - number * inverse;
  return static_cast<std::int32_t>(inverse);
}
static_assert(static_cast<std::uint32_t>(inverse_of_odd(81)) * 81U == 1);

/// The search, and where the partners of a left pixel stand in the reversed right row.
struct Geometry {
  int width;
  int height;
  int half;              // of the window, rounded down
  int first_d;           // px
  int count;             // candidates
  int lanes;             // as many as candidates, rounded up to halves of tiles
  int pad;               // entries before the reversed row
  int length;            // of a reversed row with all its margins
  int scale;             // of left pixels in pairs, and so of sums of products
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
  /// A tile's columns lie together, so that a walk along the row reads memory in its order. `first`: the
  /// tile's first lane; the last tile may be half a one. The columns before x = 0 stay 0.
  [[nodiscard]] int tile_lanes(int first) const { return std::min(kTile, lanes - first); }
  [[nodiscard]] int columns() const { return half + 1 + width; }
  [[nodiscard]] std::ptrdiff_t column(int x, int first) const {
    return static_cast<std::ptrdiff_t>(first) * columns() + (half + 1 + x) * tile_lanes(first);
  }
  /// The candidates of x that lie inside the right image: lanes begin … end − 1.
  [[nodiscard]] int begin(int x) const { return std::clamp(x - width + 1 - first_d, 0, count); }
  [[nodiscard]] int end(int x) const { return std::clamp(x - first_d + 1, begin(x), count); }
};

}  // namespace
}  // namespace cairn::kernels::CAIRN_KERNEL_TARGET
