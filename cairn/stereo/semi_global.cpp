// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/core/parallel.hpp>
#include <cairn/stereo/semi_global.hpp>
#include <cairn/stereo/semi_global_kernels.hpp>
#include <cmath>

namespace cairn {
namespace {

using kernels::SearchLayout;
using kernels::SemiGlobalKernels;
using kernels::SemiGlobalPenalties;
using kernels::SemiGlobalTask;

constexpr int kMinColumns = 16;  // least number per thread

std::uint8_t in_cost_units(float penalty) {
  const auto steps = std::lround(penalty * static_cast<float>(kernels::kMaxCost));
  return static_cast<std::uint8_t>(std::clamp<long>(steps, 0, kernels::kMaxPenalty));
}

SemiGlobalPenalties table_of(const SemiGlobalConfig& config) {
  SemiGlobalPenalties penalties;
  penalties.small = in_cost_units(config.penalty_small);
  float step = 0;
  for (std::uint8_t& large : penalties.large) {
    const float falling = config.penalty_large / (1.0F + config.penalty_edge * step);
    large = std::max(in_cost_units(std::max(0.5F, falling)), penalties.small);
    step += 1.0F;
  }
  return penalties;
}

Matches make_matches(Size size, MatchMaps maps, const Pool& pool) {
  const Size minimum = maps != MatchMaps::winner ? size : Size{};
  const Size full = maps == MatchMaps::full ? size : Size{};
  return {Image<std::int16_t>(size, pool), Image<std::int16_t>(full, pool), Image<std::int8_t>(),
          Image<float>(size, pool),        Image<float>(minimum, pool),     Image<float>(full, pool),
          Image<float>(minimum, pool),     Image<float>(minimum, pool)};
}

/// One reversed row of the right image: 255 for its pixels, 0 for the margins.
Image<std::uint8_t> inside_row(const SearchLayout& layout, const Pool& pool) {
  Image<std::uint8_t> row({layout.length(), 1}, 0, pool);
  std::fill_n(row.row(0) + layout.pad(), layout.width, std::uint8_t{255});
  return row;
}

/// Rows per block; keeps the upward pass in cache for the horizontal ones.
int rows_at_a_time(const SearchLayout& layout, const Exec& exec) {
  constexpr int kCandidates = 1 << 17;  // two bytes each
  const int rows =
      std::max({1, kCandidates / (layout.width * layout.lanes), exec.threads() > 1 ? 4 * exec.threads() : 1});
  return kernels::round_up(rows, kernels::kRowsAbreast);
}

void follow_paths(const SemiGlobalTask& task, const SemiGlobalKernels& run, const Exec& exec) {
  const auto [width, height] = task.left.size();
  parallel_for(exec, height, 16, [&](int first, int last) { run.describe_rows(task, first, last); });
  parallel_for(exec, width, kMinColumns, [&](int first, int last) { run.match_down(task, first, last); });
  const int rows = rows_at_a_time(task.layout, exec);
  for (int bottom = height; bottom > 0; bottom -= rows) {
    const int top = std::max(0, bottom - rows);
    parallel_for(exec, width, kMinColumns,
                 [&](int first, int last) { run.match_up(task, first, last, top, bottom); });
    parallel_for(exec, bottom - top, 1,
                 [&](int first, int last) { run.match_across(task, top + first, top + last); });
  }
}

}  // namespace

Matches match_semi_global(const StereoPair& pair, const MatchConfig& config,
                          const SemiGlobalConfig& penalties, const Exec& exec) {
  const SemiGlobalKernels& run = kernels::semi_global_kernels(exec);
  const Size size = pair.size();
  const SearchLayout layout{size.width, size.height, config.min_disparity, config.num_disparities,
                            run.lanes(config.num_disparities)};
  Matches matches = make_matches(size, config.maps, exec.pool);
  const Size volume{size.width * layout.lanes, size.height};
  Image<Gray> smooth(size, exec.pool);
  Image<std::uint8_t> left_bits({3 * kernels::round_up(size.width, 64), size.height}, exec.pool);
  Image<std::uint8_t> right_bits({3 * layout.length(), size.height}, exec.pool);
  const Image<std::uint8_t> inside = inside_row(layout, exec.pool);
  Image<std::uint8_t> costs(volume, exec.pool);
  Image<std::uint8_t> steps(volume, exec.pool);
  Image<std::uint8_t> along({volume.width, 1}, 0, exec.pool);
  Image<std::uint8_t> least({size.width, 1}, 0, exec.pool);
  const SemiGlobalTask task{layout,       table_of(penalties),
                            config.maps,  pair.left(),
                            pair.right(), smooth,
                            left_bits,    right_bits,
                            inside,       costs,
                            steps,        along,
                            least,        matches};
  follow_paths(task, run, exec);
  return matches;
}

Matches match(const StereoPair& pair, const MatchConfig& config, const SemiGlobalConfig& penalties,
              const Exec& exec) {
  return config.method == MatchMethod::semi_global ? match_semi_global(pair, config, penalties, exec)
                                                   : match_windows(pair, config, exec);
}

}  // namespace cairn
