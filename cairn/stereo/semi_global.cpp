// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/core/parallel.hpp>
#include <cairn/stereo/match_device.hpp>
#include <cairn/stereo/semi_global.hpp>
#include <cairn/stereo/semi_global_kernels.hpp>
#include <cmath>
#include <utility>

namespace cairn {
namespace {

using kernels::SearchLayout;
using kernels::SemiGlobalKernels;
using kernels::SemiGlobalTask;

constexpr int kMinColumns = 16;  // least number per thread

std::uint8_t in_cost_units(float penalty) {
  const auto steps = std::lround(penalty * static_cast<float>(kernels::kMaxCost));
  return static_cast<std::uint8_t>(std::clamp<long>(steps, 0, kernels::kMaxPenalty));
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

/// Rows of which costs and steps are kept: all of a small image. Of a large one, as many as a second-level cache holds:
/// computing them again costs less time than writing them to memory and reading them back. At least √height, for which
/// bands and their starts together are smallest.
int rows_of_band(const SearchLayout& layout) {
  constexpr int kSmall = 5 << 20, kCandidates = 1 << 20;  // two bytes each
  const int of_row = layout.width * layout.lanes;
  if (layout.height <= kSmall / of_row) return layout.height;
  const int least = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(layout.height))));
  const int rows = std::max(kCandidates / of_row, least);
  return std::min(layout.height, kernels::round_up(rows, kernels::kRowsAbreast));
}

void follow_paths(const SemiGlobalTask& task, const SemiGlobalKernels& run, const Exec& exec) {
  const int width = task.layout.width;
  const int height = task.layout.height;
  const auto columns = [&](const auto& work) { parallel_for(exec, width, kMinColumns, work); };
  parallel_for(exec, height, 16, [&](int first, int last) { run.describe_rows(task, first, last); });
  columns([&](int first, int last) { run.match_down(task, first, last); });
  const int rows = rows_at_a_time(task.layout, exec);
  for (int band = task.bands() - 1; band >= 0; --band) {
    if (band + 1 < task.bands())
      columns([&](int first, int last) { run.match_band(task, first, last, band); });
    const int band_top = band * task.band_rows;
    for (int bottom = std::min(height, band_top + task.band_rows); bottom > band_top; bottom -= rows) {
      const int top = std::max(band_top, bottom - rows);
      columns([&](int first, int last) { run.match_up(task, first, last, top, bottom); });
      parallel_for(exec, bottom - top, 1,
                   [&](int first, int last) { run.match_across(task, top + first, top + last); });
    }
  }
}

SearchLayout layout_of(Size size, const MatchConfig& config, const SemiGlobalKernels& run) {
  return {size.width, size.height, config.min_disparity, config.num_disparities,
          run.lanes(config.num_disparities)};
}

}  // namespace

Matches match_semi_global(const StereoPair& pair, const MatchConfig& config,
                          const SemiGlobalConfig& penalties, const Exec& exec) {
  const SearchLayout layout = layout_of(pair.size(), config, kernels::semi_global_kernels(exec));
  return kernels::match_in_bands(pair, config, penalties, rows_of_band(layout), exec);
}

Matches kernels::make_matches(Size size, MatchMaps maps, const Pool& pool) {
  const Size minimum = maps != MatchMaps::winner ? size : Size{};
  const Size full = maps == MatchMaps::full ? size : Size{};
  return {Image<std::int16_t>(size, pool), Image<std::int16_t>(full, pool), Image<std::int8_t>(),
          Image<float>(size, pool),        Image<float>(minimum, pool),     Image<float>(full, pool),
          Image<float>(minimum, pool),     Image<float>(minimum, pool)};
}

kernels::SemiGlobalPenalties kernels::penalty_table(const SemiGlobalConfig& config) {
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

Matches kernels::match_in_bands(const StereoPair& pair, const MatchConfig& config,
                                const SemiGlobalConfig& penalties, int band_rows, const Exec& exec) {
  const SemiGlobalKernels& run = semi_global_kernels(exec);
  const Size size = pair.size();
  const SearchLayout layout = layout_of(size, config, run);
  Matches matches = make_matches(size, config.maps, exec.pool);
  const Size volume{size.width * layout.lanes, band_rows};
  const int bands = (size.height + band_rows - 1) / band_rows;
  Image<Gray> smooth(size, exec.pool);
  Image<std::uint8_t> left_bits({3 * kernels::round_up(size.width, 64), size.height}, exec.pool);
  Image<std::uint8_t> right_bits({3 * layout.length(), size.height}, exec.pool);
  const Image<std::uint8_t> inside = inside_row(layout, exec.pool);
  Image<std::uint8_t> band_along({volume.width, bands}, exec.pool);
  Image<std::uint8_t> band_least({size.width, bands}, exec.pool);
  Image<std::uint8_t> costs(volume, exec.pool);
  Image<std::uint8_t> steps(volume, exec.pool);
  Image<std::uint8_t> along({volume.width, 1}, 0, exec.pool);
  Image<std::uint8_t> least({size.width, 1}, 0, exec.pool);
  const SemiGlobalTask task{.layout = layout,
                            .penalties = penalty_table(penalties),
                            .maps = config.maps,
                            .left = pair.left(),
                            .right = pair.right(),
                            .smooth = smooth,
                            .left_bits = left_bits,
                            .right_bits = right_bits,
                            .inside = inside,
                            .band_rows = band_rows,
                            .band_along = band_along,
                            .band_least = band_least,
                            .costs = costs,
                            .steps = steps,
                            .along = along,
                            .least = least,
                            .out = matches};
  follow_paths(task, run, exec);
  return matches;
}

Matches match(const StereoPair& pair, const MatchConfig& config, const SemiGlobalConfig& penalties,
              const Exec& exec) {
  if (exec.device) {
    if (auto found = exec.device->match(pair, config, penalties, exec)) return std::move(*found);
  }
  return config.method == MatchMethod::semi_global ? match_semi_global(pair, config, penalties, exec)
                                                   : match_windows(pair, config, exec);
}

}  // namespace cairn
