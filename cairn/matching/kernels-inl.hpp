// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// No include guard: compiled once for each target, over the vocabulary `lanes` of that target.
//
// The walk over a band of rows: geometry-inl.hpp says how a row is matched.

namespace cairn::kernels::CAIRN_KERNEL_TARGET {
namespace {

template <Cost kCost, class Width, bool kDouble>
class Band {
  using Lane = typename Width::Cost;
  using Strip = kernels::CAIRN_KERNEL_TARGET::Strip<Width>;
  using CostBlock = kernels::CAIRN_KERNEL_TARGET::CostBlock<Lane>;
  using RightRow = kernels::CAIRN_KERNEL_TARGET::RightRow<Lane>;

 public:
  Band(const MatchTask& task, int first, int last)
      : task_(task),
        g_(task, Width::kGroup),
        full_(task.config.evidence == Evidence::full),
        radius_(task.config.row_band),
        first_(first),
        last_(last),
        // The right rows at the band's ends are also matched by left rows beyond them.
        first_matched_(full_ ? std::max(0, first - radius_) : first),
        last_matched_(full_ ? std::min(g_.height, last + radius_) : last),
        zeros_(std::max(g_.length, g_.width)),
        block_(g_.lanes),
        least_(radius_ > 0 ? g_.lanes : 0),
        row_of_(radius_ > 0 ? g_.lanes : 0) {
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

  // -- rows -----------------------------------------------------------------------------------------------

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
        std::int32_t& pair = strip.left_pairs[g_.pad + x];
        pair = Wide::pair_of(pair & 0xFFFF, -(pair >> 16));
      }
    }
  }

  /// A row of −1 does not exist; it is all zeros in both images.
  template <class Pixel>
  void load_pairs(Strip& strip, View<const Pixel> left, View<const Pixel> right, int incoming, int outgoing) {
    const auto* zeros = reinterpret_cast<const Pixel*>(zeros_.data());
    const Pixel* in = incoming >= 0 ? left.row(incoming) : zeros;
    const Pixel* out = outgoing >= 0 ? left.row(outgoing) : zeros;
    typename Width::Sum* pairs = strip.left_pairs.data() + g_.pad;
    for (int x = 0; x < g_.width; ++x) pairs[x] = Width::pair_of(in[x], out[x]);

    in = incoming >= 0 ? right.row(incoming + strip.row) : zeros;
    out = outgoing >= 0 ? right.row(outgoing + strip.row) : zeros;
    pairs = strip.right_pairs.data() + g_.reversed(g_.width - 1);
    for (int i = 0, x = g_.width - 1; i < g_.width; ++i, --x) pairs[i] = Width::pair_of(in[x], out[x]);
  }

  void update_all_columns(Strip& strip) { begin_box<kCost, Width>(strip, g_, g_.width); }

  // -- one row's costs ------------------------------------------------------------------------------------

  void match_row(int y) {
    for (Strip& strip : strips_) {
      load_rows(strip, y + g_.half, y - g_.half - 1);
      if (!wanted(strip, y)) {
        update_all_columns(strip);
        continue;
      }
      if constexpr (correlates(kCost)) {
        sum_windows<kCost, kDouble>(strip.left, strip.rows);
        sum_windows<kCost, kDouble>(strip.right, strip.rows);
      }
      begin_box<kCost, Width>(strip, g_, std::min(g_.half, g_.width));
    }
    for (int x = 0; x < g_.width; x += kBlock) match_block(x, std::min(kBlock, g_.width - x), y);
  }

  /// The strip's costs for left row y go into a map of this band.
  [[nodiscard]] bool wanted(const Strip& strip, int y) const {
    return inside(strip, y) && (mine(y) || (full_ && mine(y + strip.row)));
  }

  void match_block(int x_first, int pixels, int y) {
    if (radius_ > 0) least_.clear();
    for (Strip& strip : strips_) {
      if (!wanted(strip, y)) continue;
      fill_costs(strip, x_first, pixels);
      if (full_ && mine(y + strip.row)) {
        RightRow& right = right_row(y + strip.row);
        radius_ > 0 ? update_right<Width, true>(block_, g_, x_first, pixels, right)
                    : update_right<Width, false>(block_, g_, x_first, pixels, right);
      }
      if (radius_ > 0) keep_lesser<Width>(block_, strip.row, pixels, g_.lanes, least_, row_of_);
    }
    if (mine(y)) settle(radius_ > 0 ? least_ : block_, x_first, y);
  }

  void fill_costs(Strip& strip, int x_first, int pixels) {
    const int x_last = x_first + pixels;
    for (int i = 0; i < g_.lanes; i += lane_count<Width>()) {
      const int least_d = g_.first_d + i;
      const int most_d = least_d + lane_count<Width>() - 1;
      // Left of x_begin no lane's window has a column yet. From x_inside to x_border − 1 nothing is clipped.
      const int x_begin = std::clamp(least_d - g_.half, x_first, x_last);
      const int x_inside = std::clamp(g_.half + std::max(0, most_d), x_begin, x_last);
      const int x_border = std::clamp(g_.width - g_.half + std::min(0, least_d), x_inside, x_last);
      const auto slide_over = [&]<bool kBorder>(int begin, int end) {
        slide<kCost, Width, kDouble, kBorder>(strip, g_, begin, end, i, block_.of(begin - x_first) + i,
                                              block_.stride);
      };
      slide_over.template operator()<true>(x_begin, x_inside);
      slide_over.template operator()<false>(x_inside, x_border);
      slide_over.template operator()<true>(x_border, x_last);
    }
    const bool all_inside = g_.begin(x_last - 1) == 0 && g_.end(x_first) == g_.count && g_.count == g_.lanes;
    for (int i = 0; !all_inside && i < pixels; ++i) {
      Lane* const costs = block_.of(i);
      std::fill(costs, costs + g_.begin(x_first + i), kNone<Lane>);
      std::fill(costs + g_.end(x_first + i), costs + g_.lanes, kNone<Lane>);
    }
  }

  // -- results --------------------------------------------------------------------------------------------

  RightRow& right_row(int y) { return right_rows_[static_cast<std::size_t>(y % (2 * radius_ + 1))]; }

  /// Writes a block's evidence. One question after the other for all its pixels, so that no pixel waits for
  /// its own answer. All sixteen are asked, also where the row ends before: rows of images are padded to more
  /// than that.
  void settle(const CostBlock& block, int x_first, int y) {
    std::array<Lane, kBlock> least;
    std::array<int, kBlock> best{};
    for (std::size_t i = 0; i < kBlock; ++i) least[i] = least_cost<Width>(block.of(i), g_.lanes);
    for (std::size_t i = 0; i < kBlock; ++i) best[i] = first_lane_of<Width>(block.of(i), g_.lanes, least[i]);
    float* const cost = task_.out.cost.row(y) + x_first;
    std::int16_t* const disparity = task_.out.best.row(y) + x_first;
    for (std::size_t i = 0; i < kBlock; ++i) {
      cost[i] = as_cost(least[i]);
      disparity[i] = least[i] < kNone<Lane> ? static_cast<std::int16_t>(g_.first_d + best[i]) : kNoMatch;
    }
    if (radius_ > 0) {
      std::int8_t* const row = task_.out.row_offset.row(y) + x_first;
      for (std::size_t i = 0; i < kBlock; ++i) {
        row[i] = least[i] < kNone<Lane> ? static_cast<std::int8_t>(row_of_.of(i)[best[i]]) : std::int8_t{0};
      }
    }
    if (full_) settle_evidence(block, best, x_first, y);
  }

  void settle_evidence(const CostBlock& block, const std::array<int, kBlock>& best, int x_first, int y) {
    std::array<float, kBlock> sums;
    for (std::size_t i = 0; i < kBlock; ++i) sums[i] = sum_of_costs(block.of(i), g_.lanes);
    float* const mean = task_.out.mean_cost.row(y) + x_first;
    const Geometry g = g_;
    for (int i = 0; i < kBlock; ++i) {
      const int candidates = g.end(x_first + i) - g.begin(x_first + i);
      const float quotient = sums[static_cast<std::size_t>(i)] / static_cast<float>(std::max(candidates, 1));
      mean[i] = candidates > 0 ? quotient : kNoCost;
    }
    float* const before = task_.out.cost_before.row(y) + x_first;
    float* const after = task_.out.cost_after.row(y) + x_first;
    for (std::size_t i = 0; i < kBlock; ++i) {
      Lane* const costs = block.of(i) + best[i];
      before[i] = as_cost(costs[-1]);
      after[i] = as_cost(costs[1]);
      costs[-1] = costs[0] = costs[1] = kNone<Lane>;  // so that the runner-up is the least of what is left
    }
    float* const runner_up = task_.out.runner_up.row(y) + x_first;
    for (std::size_t i = 0; i < kBlock; ++i) runner_up[i] = as_cost(least_cost<Width>(block.of(i), g_.lanes));
  }

  void finish_right(int y) {
    RightRow& right = right_row(y);
    std::int16_t* const out = task_.out.best_right.row(y);
    const Lane* const cost = right.cost.data();
    const Lane* const lane = right.lane.data();
    for (int x = 0, j = g_.reversed(0); x < g_.width; ++x, --j) {
      out[x] = cost[j] < kNone<Lane> ? static_cast<std::int16_t>(g_.first_d + static_cast<int>(lane[j]))
                                     : kNoMatch;
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
  CostBlock block_;
  CostBlock least_;   // over the rows of the band
  CostBlock row_of_;  // these
  std::vector<Strip> strips_;
  std::vector<RightRow> right_rows_;
};

template <Cost kCost, class Width = Wide, bool kDouble = false>
void run_band(const MatchTask& task, int first, int last) {
  Band<kCost, Width, kDouble>(task, first, last).run();
}

}  // namespace

void match_rows(const MatchTask& task, int first, int last) {
  const MatchConfig& config = task.config;
  const int n = config.window_size * config.window_size;
  const int levels = config.prefilter == Prefilter::xsobel ? 2 * config.prefilter_cap : 255;
  // The largest n for which n²·255² (zssd), n²·127.5² (zncc) are below 2^31.
  constexpr int kSingleZssd = 181;
  constexpr int kSingleZncc = 363;
  switch (config.cost) {
    case Cost::sad:
      return n * levels <= Narrow::kLargestSum ? run_band<Cost::sad, Narrow>(task, first, last)
                                               : run_band<Cost::sad>(task, first, last);
    case Cost::ssd:
      return run_band<Cost::ssd>(task, first, last);
    case Cost::zsad:
      return run_band<Cost::zsad>(task, first, last);
    case Cost::zssd:
      return n <= kSingleZssd ? run_band<Cost::zssd>(task, first, last)
                              : run_band<Cost::zssd, Wide, true>(task, first, last);
    case Cost::nssd:
      return run_band<Cost::nssd>(task, first, last);
    case Cost::zncc:
      return n <= kSingleZncc ? run_band<Cost::zncc>(task, first, last)
                              : run_band<Cost::zncc, Wide, true>(task, first, last);
  }
}

}  // namespace cairn::kernels::CAIRN_KERNEL_TARGET
