// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "bench_budget.hpp"

#include <algorithm>
#include <array>
#include <cairn/core/statistics.hpp>
#include <cairn/timing/drawn_pair.hpp>
#include <cmath>
#include <optional>
#include <vector>

#include "terminal.hpp"

namespace cairn::cli {
namespace {

using output::Json;

constexpr std::array kShares{1.0, 0.75, 0.5, 0.375, 0.25};  // of width and height
constexpr int kMinSide = 32;                                // px

struct Trial {
  std::string preset;
  Size size;
  int num_disparities = 0;
  double median_ms = 0;
  double p99_ms = 0;
  int frames = 0;
};

Trial timed(ResolvedConfig resolved, const Budget& budget, double share, const Exec& exec) {
  const auto part = [share](int whole) { return static_cast<int>(std::ceil(share * whole)); };
  resolved.config.match.num_disparities = part(resolved.config.match.num_disparities);
  Trial trial{resolved.preset,
              {part(budget.size.width), part(budget.size.height)},
              resolved.config.match.num_disparities};
  const timing::DrawnPair drawn = timing::draw_pair(trial.size, resolved.config.match);
  const timing::FrameTimes times =
      timing::time_frames(drawn.pair(), drawn.rig, resolved.config, exec, budget.limits);
  trial.median_ms = percentile(times.frame.wall_ms, 0.5);
  trial.p99_ms = percentile(times.frame.wall_ms, 0.99);
  trial.frames = times.frames();
  return trial;
}

std::string rate(double milliseconds) {
  return text_of("%.1f Hz", 1000 / milliseconds);
}

}  // namespace

BudgetReport sizes_within_budget(const Budget& budget, const ConfigOptions& options, const Exec& exec) {
  const auto& [rate_hz, size, presets, limits] = budget;
  Table table({"preset", "size", "disparities", "median ms", "p99 ms", "rate", "frames"});
  BudgetReport report{{}, {{"rate_hz", rate_hz}, {"trials", Json::array()}}};
  std::string results;
  for (const std::string& preset : presets) {
    ConfigOptions with_preset = options;
    with_preset.preset = preset;
    const ResolvedConfig resolved = resolve(with_preset);
    std::optional<Trial> last;
    bool is_within = false;
    for (const double share : kShares) {
      if (is_within || std::min(size.width, size.height) * share < kMinSide) break;
      last = timed(resolved, budget, share, exec);
      is_within = last->p99_ms * rate_hz <= 1000;
      table.add({last->preset, text(last->size), std::to_string(last->num_disparities),
                 text_of("%.1f", last->median_ms), text_of("%.1f", last->p99_ms), rate(last->median_ms),
                 std::to_string(last->frames)});
      report.json["trials"].push_back({{"preset", last->preset},
                                       {"width", last->size.width},
                                       {"height", last->size.height},
                                       {"num_disparities", last->num_disparities},
                                       {"median_ms", output::rounded(last->median_ms)},
                                       {"p99_ms", output::rounded(last->p99_ms)},
                                       {"frames", last->frames},
                                       {"is_within", is_within}});
    }
    results += resolved.preset + ": ";
    results += is_within ? text(last->size) + " with " + std::to_string(last->num_disparities) +
                               " disparities (match.num_disparities)\n"
                         : "none of these sizes\n";
  }
  report.text = table.text() + "\nWithin " + text_of("%.1f ms", 1000 / rate_hz) +
                " a frame, 99 % of them, for " + text_of("%g Hz", rate_hz) + ":\n" + results +
                "Sizes are shares of " + text(size) +
                " (--size), with as large shares of the disparities, so that the nearest distance stays.\n";
  return report;
}

}  // namespace cairn::cli
