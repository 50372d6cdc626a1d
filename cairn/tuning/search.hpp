// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/tuning/tunable.hpp>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace cairn {

/// The loss of a configuration on one frame, as a sum over `weight` items: the mean over all frames is Σ sum
/// / Σ weight.
struct Loss {
  double sum = 0;
  double weight = 0;
  int faults = 0;  // must not increase in exchange, in total
};
/// Infinite if no frame has a weight.
double mean_loss(const std::vector<Loss>& frames);

/// The significance threshold of a gain.
struct Margin {
  double least_share = 0.002;  // as a share of the loss before
  double standard_errors = 1;  // of the mean gain per frame; undefined for one frame
};
/// Whether `after` is better than `before` (the same frames, in order) by this margin: lower mean, consistent
/// over the frames. The gain of a single frame equals one standard error.
bool clearly_better(const std::vector<Loss>& before, const std::vector<Loss>& after, const Margin& margin);

/// Total over all frames.
int faults(const std::vector<Loss>& frames);

/// The reduction of the mean loss, with its 95 % interval by Student's t over the frames: what other frames
/// of this kind may gain. For one frame there is no interval: low and high are NaN.
struct Gain {
  double mean = 0;
  double low = 0;
  double high = 0;
};
/// The same frames, in order. NaN if nothing was scored.
Gain gain_of(const std::vector<Loss>& before, const std::vector<Loss>& after);

struct Setting {
  std::string option;
  std::string value;  // as accepted by set()
  friend bool operator==(const Setting&, const Setting&) = default;
};

/// The values of these options in `config`.
std::vector<Setting> settings_of(const Config& config, const std::vector<Tunable>& tunables);
/// `config` with these settings. Throws Error like set().
Config with_settings(Config config, const std::vector<Setting>& settings);

/// The loss of each frame with these settings; nullopt if stopped. Contradictory settings have infinite loss.
using Measure = std::function<std::optional<std::vector<Loss>>(const std::vector<Setting>&)>;

struct SearchConfig {
  int evaluations = 1 << 30;  // at most; includes the start
  double first_step = 1.6;    // factor for numbers
  double last_step = 1.1;
  Margin margin{};         // smaller gains do not count
  std::uint32_t seed = 1;  // determines the order of the options
  /// Whether an option, by its index, is read with these settings; empty: all are. Options that are not read
  /// are skipped.
  std::function<bool(const std::vector<Setting>&, std::size_t)> is_read{};
};

enum class SearchEnd : std::uint8_t {
  converged,    // no neighbour of the best is better
  evaluations,  // their number is exhausted
  stopped       // the measure was stopped
};

struct SearchResult {
  std::vector<Setting> start;
  std::vector<Setting> best;       // `start` if nothing was better
  std::vector<Loss> start_losses;  // empty if stopped before the first evaluation ended
  std::vector<Loss> best_losses;
  int evaluations = 0;
  SearchEnd end = SearchEnd::converged;
};

/// Coordinate search from `start` (one setting per tunable, in order) for settings of lower loss. Each sweep
/// draws a new order of the options and measures the neighbours() of each; a value that is clearly_better()
/// is kept at once, unless it has more faults than the start, and a number continues in the direction that
/// helped. A sweep without gain replaces the step by its root; the search ends below the last step. Options
/// that change no frame's loss are skipped from then on. `improved` (may be empty) is called for the start
/// and for each new best, right after its measurement. The same input gives the same result, whatever the
/// timing. (docs/decisions/tuning.md)
SearchResult search(const std::vector<Tunable>& tunables, const std::vector<Setting>& start,
                    const Measure& measure, const SearchConfig& config,
                    const std::function<void(const std::vector<Setting>&)>& improved = {});

}  // namespace cairn
