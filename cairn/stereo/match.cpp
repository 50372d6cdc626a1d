// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/core/parallel.hpp>
#include <cairn/image/prefilter.hpp>
#include <cairn/stereo/match.hpp>
#include <cairn/stereo/window_kernels.hpp>

namespace cairn {
namespace {

Matches make_matches(Size size, const MatchConfig& config, const Pool& pool) {
  const Size band = config.row_band > 0 ? size : Size{};
  const Size minimum = config.maps != MatchMaps::winner ? size : Size{};
  const Size full = config.maps == MatchMaps::full ? size : Size{};
  return {Image<std::int16_t>(size, pool), Image<std::int16_t>(full, pool), Image<std::int8_t>(band, pool),
          Image<float>(size, pool),        Image<float>(minimum, pool),     Image<float>(full, pool),
          Image<float>(minimum, pool),     Image<float>(minimum, pool)};
}

}  // namespace

Matches match_windows(const StereoPair& pair, const MatchConfig& config, const Exec& exec) {
  Matches matches = make_matches(pair.size(), config, exec.pool);
  kernels::MatchTask task{config, pair.left(), pair.right(), {}, {}, matches, exec.pool};

  Image<Gray> left_filtered;
  Image<Gray> right_filtered;
  if (config.prefilter == Prefilter::xsobel) {
    left_filtered = filter_xsobel(task.left, config.prefilter_cap, exec);
    right_filtered = filter_xsobel(task.right, config.prefilter_cap, exec);
    task.left = left_filtered;
    task.right = right_filtered;
  }
  Image<std::int16_t> left_flat;
  Image<std::int16_t> right_flat;
  if (config.cost == Cost::zsad) {
    left_flat = remove_mean(task.left, config.window_size, exec);
    right_flat = remove_mean(task.right, config.window_size, exec);
    task.left_flat = left_flat;
    task.right_flat = right_flat;
  }

  const auto rows = kernels::window_kernels(config.cost, exec).match_rows;
  // A band first sums the window rows above it, at about a third of the cost of a row. So the bands are
  // large; but two for each thread, to balance the load.
  const int bands = 2 * exec.threads();
  const int grain = std::max(2 * config.window_size, (pair.size().height + bands - 1) / bands);
  parallel_for(exec, pair.size().height, grain, [&](int first, int last) { rows(task, first, last); });
  return matches;
}

}  // namespace cairn
