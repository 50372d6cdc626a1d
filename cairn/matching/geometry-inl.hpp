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

constexpr int kMargin = 64;  // lanes without candidate before and after a pixel's

/// How wide sums and costs are. Every operator fits these.
struct Wide {
  using SumTag = lanes::CappedTag<std::int32_t, 16>;
  using CostTag = lanes::Rebind<float, SumTag>;
  using Sum = std::int32_t;
  using Cost = float;
  static constexpr int kGroup = 16;    // lanes that lie together in memory: a whole number of vectors
  static constexpr Sum kEmptyBox = 0;  // the sum over no pixels
  /// The row that comes in and the one that goes out.
  static constexpr Sum pair_of(int incoming, int outgoing) {
    return static_cast<Sum>(static_cast<std::uint32_t>(outgoing) << 16 |
                            (static_cast<std::uint32_t>(incoming) & 0xFFFFU));
  }
};

/// Half as wide, for sad where no window's sum can reach 65535. Sums and costs are kept less 32768, as signed
/// numbers: those are what every target compares.
struct Narrow {
  using SumTag = lanes::CappedTag<std::int16_t, 32>;
  using CostTag = SumTag;
  using Sum = std::int16_t;
  using Cost = std::int16_t;
  static constexpr int kGroup = 32;
  static constexpr Sum kEmptyBox = std::numeric_limits<Sum>::min();
  static constexpr int kLargestSum = 65534;
  static constexpr Sum pair_of(int incoming, int outgoing) {
    return static_cast<Sum>(outgoing << 8 | incoming);
  }
};

template <class Width>
CAIRN_LANES_INLINE int lane_count() {
  return static_cast<int>(lanes::Lanes(typename Width::SumTag()));
}

using F = Wide::CostTag;
using I = Wide::SumTag;
using VF = lanes::Vec<F>;
using VI = lanes::Vec<I>;

/// The search, and where the partners of a left pixel stand in the reversed right row.
struct Geometry {
  int width;
  int height;
  int half;     // of the window, rounded down
  int first_d;  // px
  int count;    // candidates
  int group;    // lanes that lie together in memory
  int lanes;    // as many as candidates, rounded up to whole groups
  int pad;      // entries before the reversed row
  int length;   // of a reversed row with all its margins

  Geometry(const MatchTask& task, int lanes_in_group)
      : width(task.out.best.width()),
        height(task.out.best.height()),
        half(task.config.window_size / 2),
        first_d(task.config.min_disparity),
        count(task.config.num_disparities),
        group(lanes_in_group),
        lanes(round_up(count, group)),
        pad(std::max(0, -first_d)),
        length(round_up(pad + width + std::max(0, first_d) + lanes + kMargin, 16)) {}

  [[nodiscard]] int reversed(int x_right) const { return pad + width - 1 - x_right; }
  [[nodiscard]] int first_lane(int x) const { return reversed(x - first_d); }
  /// Where a left pixel's column stands, its lanes i and on; x = −1: the one that stays 0. A group's lanes of
  /// all columns lie together, so that a walk along the row reads memory in its order.
  [[nodiscard]] std::ptrdiff_t column(int x, int i) const {
    return static_cast<std::ptrdiff_t>(i & -group) * (width + 1) + (x + 1) * group + (i & (group - 1));
  }
  /// The candidates of x that lie inside the right image: lanes begin … end − 1.
  [[nodiscard]] int begin(int x) const { return std::clamp(x - width + 1 - first_d, 0, count); }
  [[nodiscard]] int end(int x) const { return std::clamp(x - first_d + 1, begin(x), count); }
};

}  // namespace
}  // namespace cairn::kernels::CAIRN_KERNEL_TARGET
