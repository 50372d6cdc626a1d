// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// No include guard: compiled once for each target, over the vocabulary `lanes` of that target.
//
// The walk over a band of rows; geometry-inl.hpp describes the matching of a row.

// clang-format off
#include <cairn/stereo/lanes-inl.hpp>
#include <cairn/stereo/geometry-inl.hpp>
#include <cairn/stereo/winners-inl.hpp>
#include <cairn/stereo/window_sums-inl.hpp>
// clang-format on

namespace cairn::kernels::CAIRN_KERNEL_TARGET {
namespace {

template <Cost kCost, class Width, bool kDouble>
class Band {
  using Lane = typename Width::Cost;
  using KeptTag = std::conditional_t<std::is_same_v<Width, Wide>, F, I>;  // of costs converted for Matches
  using Strip = kernels::CAIRN_KERNEL_TARGET::Strip<Width>;
  using CostBlock = kernels::CAIRN_KERNEL_TARGET::CostBlock<Lane>;
  using RightRow = kernels::CAIRN_KERNEL_TARGET::RightRow<Lane>;

 public:
  Band(const MatchTask& task, int first, int last)
      : task_(task),
        g_(task),
        full_(task.config.maps == MatchMaps::full),
        keeps_costs_(task.config.maps != MatchMaps::winner),
        radius_(task.config.row_band),
        first_(first),
        last_(last),
        // The right rows at the ends of the band are also matched by left rows beyond them.
        first_matched_(full_ ? std::max(0, first - radius_) : first),
        last_matched_(full_ ? std::min(g_.height, last + radius_) : last),
        exists_(g_),
        zeros_(std::max(g_.length, g_.width)),
        step_(keeps_costs_ ? kBlock : round_up(g_.width, kBlock)),
        block_(g_, step_, task.config.maps),
        least_(keeps_costs_ && radius_ > 0 ? g_.lanes : 0),
        candidates_(round_up(g_.width, kBlock)),
        winners_(round_up(g_.width, kBlock)) {
    for (int x = 0; x < g_.width; ++x) candidates_[x] = g_.end(x) - g_.begin(x);
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
        begin_row(strip, g_.width);
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
  /// Whether left row y and its partner in the strip both exist.
  [[nodiscard]] bool inside(const Strip& strip, int y) const {
    return y >= 0 && y < g_.height && y + strip.row >= 0 && y + strip.row < g_.height;
  }

  // -- rows -----------------------------------------------------------------------------------------------

  /// Interleaves the incoming and the outgoing row, and moves the moments down.
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
      move_down<-1>(strip.left, strip.left_pairs.data());
      move_down<1>(strip.right, strip.right_pairs.data());
      // The moments are those of the unscaled pixels.
      if (g_.scale > 1) scale_pairs(strip.left_pairs.data() + g_.pad, g_.width, g_.scale);
    }
  }

  /// Row −1 does not exist; it is all zeros in both images.
  template <class Pixel>
  void load_pairs(Strip& strip, View<const Pixel> left, View<const Pixel> right, int incoming, int outgoing) {
    const auto* zeros = reinterpret_cast<const Pixel*>(zeros_.data());
    const Pixel* in = incoming >= 0 ? left.row(incoming) : zeros;
    const Pixel* out = outgoing >= 0 ? left.row(outgoing) : zeros;
    // For a correlation, the outgoing product is subtracted.
    constexpr int kSign = correlates(kCost) ? -1 : 1;
    pair_up<Width, kSign>(in, out, g_.width, strip.left_pairs.data() + g_.pad);

    in = incoming >= 0 ? right.row(incoming + strip.row) : zeros;
    out = outgoing >= 0 ? right.row(outgoing + strip.row) : zeros;
    pair_up_reversed<Width>(in, out, g_.width, strip.right_pairs.data() + g_.pad);
  }

  // -- one row's costs ------------------------------------------------------------------------------------

  /// Calls body.operator()<kLanes>(first lane) for each tile.
  template <class Body>
  void for_each_tile(const Body& body) const {
    for (int first = 0; first < g_.lanes; first += kTile) {
      g_.tile_lanes(first) == kTile ? body.template operator()<kTile>(first)
                                    : body.template operator()<kTile / 2>(first);
    }
  }

  /// The columns x < end of the strip, moved down by the row loaded last.
  void begin_row(const Strip& strip, int end) {
    const Rows<Width> rows(strip, g_, exists_);
    for_each_tile([&]<int kLanes>(int first) { begin_box<kCost, Width, kLanes>(rows, first, end); });
  }

  void match_row(int y) {
    for (Strip& strip : strips_) {
      load_rows(strip, y + g_.half, y - g_.half - 1);
      if (!wanted(strip, y)) {
        begin_row(strip, g_.width);
        continue;
      }
      if constexpr (correlates(kCost)) {
        sum_windows<kCost, kDouble>(strip.left, strip.rows);
        sum_windows<kCost, kDouble>(strip.right, strip.rows);
        sum_cut_windows<kCost, kDouble>(strip.left, strip.rows, strip.cut);
      }
      begin_row(strip, std::min(g_.half, g_.width));
    }
    match_blocks(y);
    if (mine(y)) settle_winners(y);
  }

  /// Whether the costs of the strip for left row y go into a map of this band.
  [[nodiscard]] bool wanted(const Strip& strip, int y) const {
    return inside(strip, y) && (mine(y) || (full_ && mine(y + strip.row)));
  }

  /// A number of left pixels and one row of the right image, processed before the block is evaluated.
  struct Work {
    const Strip* strip = nullptr;
    const Rows<Width>* rows = nullptr;
    int x_first = 0;
    int x_last = 0;
    bool begins = false;  // at the first strip
    bool ends = false;
  };

  void match_blocks(int y) {
    const auto unwanted = [&](const Strip& strip) { return !wanted(strip, y); };
    const auto first = std::find_if_not(strips_.begin(), strips_.end(), unwanted);
    const auto last = std::find_if_not(strips_.rbegin(), strips_.rend(), unwanted).base();
    // Once for all blocks: copying data right after writing it number by number would stall.
    rows_.clear();
    for (const Strip& strip : strips_) rows_.emplace_back(strip, g_, exists_);
    for (int x = 0; x < g_.width; x += step_) {
      for (auto strip = first; strip < last; ++strip) {
        if (unwanted(*strip)) continue;
        const auto* const rows = &rows_[static_cast<std::size_t>(strip - strips_.begin())];
        const Work work{&*strip, rows, x, std::min(x + step_, g_.width), strip == first, strip + 1 == last};
        fill(work);
        look_at(work, y);
      }
      if (keeps_costs_ && mine(y + 1)) expect_maps(x, y + 1);
    }
  }

  void fill(const Work& work) const {
    const auto [strip, rows, x_first, x_last, begins, ends] = work;
    for_each_tile([&, rows = rows, x_first = x_first, x_last = x_last]<int kLanes>(int first) {
      const int least_d = g_.first_d + first;
      const int most_d = least_d + kLanes - 1;
      // From x_inside to x_border − 1 nothing is clipped or missing.
      const bool ragged = first + kLanes > g_.count;
      const int x_end = std::clamp(g_.width - g_.half, x_first, x_last);
      const int x_inside = ragged ? x_end : std::clamp(g_.half + std::max(0, most_d), x_first, x_end);
      const int x_border = std::clamp(g_.width - g_.half + std::min(0, least_d), x_inside, x_end);
      const auto slide_over = [&]<Place kPlace>(int begin, int end) {
        if (begin < end) {
          slide_along<kCost, Width, kDouble, kLanes, kPlace>(*rows, first, begin, end, begin - x_first,
                                                             block_);
        }
      };
      int x_second_half = x_first;
      if constexpr (std::is_same_v<Width, Wide> && kLanes == kTile) {
        // Before that, the second half of the tile has no candidate in any column.
        constexpr int kHalf = kTile / 2;
        if (!keeps_costs_) x_second_half = std::clamp(least_d + kHalf - g_.half, x_first, x_inside);
        if (x_second_half > x_first)
          slide<kCost, Width, kDouble, kHalf, Place::border>(*rows, first, x_first, x_second_half, 0, block_);
      }
      slide_over.template operator()<Place::border>(x_second_half, x_inside);
      slide_over.template operator()<Place::inside>(x_inside, x_border);
      slide_over.template operator()<Place::border>(x_border, x_end);
      slide_over.template operator()<Place::right_end>(x_end, x_last);
    });
  }

  void look_at(const Work& work, int y) {
    const auto [strip, rows, x_first, x_last, begins, ends] = work;
    if (full_ && mine(y + strip->row)) {
      RightRow& right = right_row(y + strip->row);
      radius_ > 0 ? update_right<Width, true>(block_.costs, g_, x_first, x_last - x_first, right)
                  : update_right<Width, false>(block_.costs, g_, x_first, x_last - x_first, right);
    }
    if (!mine(y)) return;
    if (begins) winners_.start(block_.winners.front(), x_first, x_last);
    for (std::size_t tile = begins ? 1 : 0; tile < block_.winners.size(); ++tile) {
      winners_.keep(block_.winners[tile], static_cast<int>(tile) * kTile, strip->row, x_first, x_last);
    }
    if (!keeps_costs_) return;
    if (radius_ > 0) {
      if (begins) least_.clear();
      keep_lesser<Width>(block_.costs, x_last - x_first, g_.lanes, least_);
    }
    if (ends) settle_maps(radius_ > 0 ? least_ : block_.costs, x_first, x_last - x_first, y);
  }

  // -- results --------------------------------------------------------------------------------------------

  RightRow& right_row(int y) { return right_rows_[static_cast<std::size_t>(y % (2 * radius_ + 1))]; }

  /// Whole vectors: rows of images are padded to more than one.
  void settle_winners(int y) {
    const F f;
    const I i32;
    const float* const costs = winners_.cost.data();
    const std::int32_t* const lane = winners_.lane.data();
    float* const cost = task_.out.cost.row(y);
    std::int16_t* const best = task_.out.best.row(y);
    const VI first_d = lanes::Set(i32, g_.first_d);
    for (int x = 0, end = g_.width; x < end; x += lane_count<Wide>()) {
      const VF least = lanes::Load(f, costs + x);
      const auto none = lanes::RebindMask(i32, lanes::Eq(least, lanes::Set(f, kNoCost)));
      const VI d = lanes::Add(lanes::Load(i32, lane + x), first_d);
      lanes::Store(least, f, cost + x);
      lanes::StoreNarrowed(i32, lanes::IfThenElse(none, lanes::Set(i32, std::int32_t{kNoMatch}), d),
                           best + x);
    }
    if (radius_ == 0) return;
    std::copy_n(winners_.row.data(), g_.width, task_.out.row_offset.row(y));
  }

  /// Writes the properties of the costs of a block besides the winners, one after the other for all its
  /// pixels, so that pixels do not wait for each other. Computes whole blocks, also at the end of a row, and
  /// writes whole vectors, for which rows of images are padded.
  void settle_maps(const CostBlock& block, int x_first, int pixels, int y) {
    if (full_) settle_mean(block, x_first, pixels, y);
    const std::int32_t* const best = winners_.lane.data() + x_first;
    alignas(64) std::array<Lane, 4 * kBlock> around;
    Lane* costs = block.of(0) - 1;
    const std::ptrdiff_t stride = block.stride;
    for (std::ptrdiff_t i = 0; i < kBlock; ++i) {
      // So that the runner-up is the minimum of the rest.
      take_three<Width>(costs + best[i], around.data() + 4 * i);
      costs += stride;
    }
    alignas(64) std::array<Lane, kBlock> runner_up;
    runner_up.fill(kNone<Lane>);
    for_each_tile([&]<int kLanes>(int first) { keep_least<Width, kLanes>(block, first, runner_up); });
    // Only now, as vectors: right after writing number by number, loads would stall.
    store_neighbours(around, pixels, task_.out.cost_before.row(y) + x_first,
                     task_.out.cost_after.row(y) + x_first);
    store_costs(runner_up, pixels, task_.out.runner_up.row(y) + x_first);
  }

  static void store_neighbours(const std::array<Lane, 4 * kBlock>& around, int pixels, float* before,
                               float* after) {
    for (int i = 0; i < pixels; i += lane_count<Wide>()) {
      const auto [first, third] = lanes::LoadFirstAndThird(KeptTag(), around.data() + 4 * i);
      lanes::Store(as_costs(Width(), first), F(), before + i);
      lanes::Store(as_costs(Width(), third), F(), after + i);
    }
  }

  /// Prefetches the memory of the maps of a block, one row ahead: there are more streams than the hardware
  /// prefetcher follows.
  CAIRN_LANES_INLINE void expect_maps(int x_first, int y) const {
    const Matches& out = task_.out;
    expect_writes(out.cost.row(y) + x_first, kBlock);
    expect_writes(out.best.row(y) + x_first, kBlock);
    for (const Image<float>* map : {&out.cost_before, &out.cost_after, &out.runner_up})
      expect_writes(map->row(y) + x_first, kBlock);
    if (full_) expect_writes(out.mean_cost.row(y) + x_first, kBlock);
  }

  void store_costs(const std::array<Lane, kBlock>& kept, int pixels, float* to) const {
    for (int i = 0; i < pixels; i += lane_count<Wide>()) {
      lanes::Store(as_costs(Width(), kept.data() + i), F(), to + i);
    }
  }

  void settle_mean(const CostBlock& block, int x_first, int pixels, int y) const {
    const F f;
    alignas(64) std::array<float, kBlock> sums;
    sum_costs(block, candidates_.data() + x_first, sums);
    float* const mean = task_.out.mean_cost.row(y) + x_first;
    for (int i = 0; i < pixels; i += lane_count<Wide>()) {
      const VF count = lanes::ConvertTo(f, lanes::Load(I(), candidates_.data() + x_first + i));
      const VF quotient = lanes::Div(lanes::Load(f, sums.data() + i), count);
      const auto none = lanes::Eq(count, lanes::Zero(f));
      lanes::Store(lanes::IfThenElse(none, lanes::Set(f, kNoCost), quotient), f, mean + i);
    }
  }

  void sum_costs(const CostBlock& block, [[maybe_unused]] const std::int32_t* candidates,
                 std::array<float, kBlock>& sums) const {
    if constexpr (std::is_base_of_v<Narrow, Width>) {
      if (g_.count * Width::kLargestSum < 1 << 24) {
        const I i32;
        alignas(64) std::array<std::int32_t, kBlock> kept;
        sums_of_kept<Width>(block, g_.lanes, kept);
        for (int i = 0; i < kBlock; i += lane_count<Wide>()) {
          const VI missing = lanes::Sub(lanes::Set(i32, g_.lanes), lanes::Load(i32, candidates + i));
          lanes::Store(sum_from_kept<Width>(kept.data() + i, g_.lanes, missing), F(), sums.data() + i);
        }
        return;
      }
    }
    for (int i = 0; i < kBlock; ++i) {
      sums[static_cast<std::size_t>(i)] = sum_by_parts<Width>(block.of(i), g_.lanes);
    }
  }

  void finish_right(int y) {
    RightRow& right = right_row(y);
    std::int16_t* const out = task_.out.best_right.row(y);
    const Lane* const cost = right.cost.data();
    const Lane* const lane = right.lane.data();
    int x = 0;
    for (; x + lane_count<Wide>() <= g_.width; x += lane_count<Wide>()) {
      const int j = g_.reversed(x + lane_count<Wide>() - 1);
      const VI d = lanes::Add(as_lanes(Width(), lane + j), lanes::Set(I(), g_.first_d));
      const auto none =
          lanes::RebindMask(I(), lanes::Eq(as_costs(Width(), cost + j), lanes::Set(F(), kNoCost)));
      const VI found = lanes::IfThenElse(none, lanes::Set(I(), std::int32_t{kNoMatch}), d);
      lanes::StoreNarrowed(I(), lanes::Reverse(I(), found), out + x);
    }
    for (int j = g_.reversed(x); x < g_.width; ++x, --j) {
      out[x] = cost[j] < kNone<Lane> ? static_cast<std::int16_t>(g_.first_d + static_cast<int>(lane[j]))
                                     : kNoMatch;
    }
    right.clear();
  }

  const MatchTask& task_;
  Geometry g_;
  bool full_;
  bool keeps_costs_;
  int radius_;  // of the band of right rows
  int first_;
  int last_;
  int first_matched_;
  int last_matched_;
  Existence<Width> exists_;
  Scratch<std::int32_t> zeros_;
  int step_;  // left pixels in a block
  Block<Width> block_;
  CostBlock least_;                   // over the rows of the band
  Scratch<std::int32_t> candidates_;  // [x]: number of candidates
  RowWinners winners_;
  std::vector<Strip> strips_;
  std::vector<Rows<Width>> rows_;  // of these
  std::vector<RightRow> right_rows_;
};

template <class Width = Wide, bool kDouble = false>
void run_band(const MatchTask& task, int first, int last) {
  Band<CAIRN_COST, Width, kDouble>(task, first, last).run();
}

[[maybe_unused]] int pixels_of_window(const MatchConfig& config) {
  return config.window_size * config.window_size;
}

void match_rows(const MatchTask& task, int first, int last) {
  const MatchConfig& config = task.config;
  // The largest n for which n²·255² (zssd), n²·127.5² (zncc) are below 2^31.
  constexpr int kSingleZssd = 181;
  constexpr int kSingleZncc = 363;
  if constexpr (CAIRN_COST == Cost::sad) {
    const int n = pixels_of_window(config);
    const int levels = config.prefilter == Prefilter::xsobel ? 2 * config.prefilter_cap : 255;
    if (levels <= TaggedCost::kLargestDifference && n * levels <= TaggedCost::kLargestSum)
      return run_band<TaggedCost>(task, first, last);
    return n * levels <= Narrow::kLargestSum ? run_band<Narrow>(task, first, last)
                                             : run_band<>(task, first, last);
  } else if constexpr (takes_covariance(CAIRN_COST)) {
    return pixels_of_window(config) <= (CAIRN_COST == Cost::zssd ? kSingleZssd : kSingleZncc)
               ? run_band<>(task, first, last)
               : run_band<Wide, true>(task, first, last);
  } else {
    run_band<>(task, first, last);
  }
}

inline constexpr WindowKernels kWindowKernels{match_rows};

}  // namespace
}  // namespace cairn::kernels::CAIRN_KERNEL_TARGET
