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

/// What a configuration loses on one frame, as a sum over `weight` things: of all frames together, the mean
/// is Σ sum / Σ weight.
struct Loss {
  double sum = 0;
  double weight = 0;
  int faults = 0;  // what must not become more in exchange, all frames together
};
/// Infinite where no frame has a weight.
double mean_loss(const std::vector<Loss>& frames);

/// What a gain must exceed to count for more than chance.
struct Margin {
  double least_share = 0.002;  // of the loss before
  double standard_errors = 1;  // of the mean gain of a frame; of one frame there is none
};
/// Whether `after` is better than `before` (the same frames, in order) by this margin: the mean is lower, and
/// the frames agree on it. The gain of one frame alone is just one standard error.
bool clearly_better(const std::vector<Loss>& before, const std::vector<Loss>& after, const Margin& margin);

/// Of all frames together.
int faults(const std::vector<Loss>& frames);

/// What a change gains of the mean loss, with its 95 % interval by Student's t over the frames: what other
/// frames of this kind may gain. Of one frame there is no interval: low and high are NaN.
struct Gain {
  double mean = 0;
  double low = 0;
  double high = 0;
};
/// The same frames, in order. NaN where nothing was scored.
Gain gain_of(const std::vector<Loss>& before, const std::vector<Loss>& after);

struct Setting {
  std::string option;
  std::string value;  // as set() reads it
  friend bool operator==(const Setting&, const Setting&) = default;
};

/// The values that `config` gives to these options.
std::vector<Setting> settings_of(const Config& config, const std::vector<Tunable>& tunables);
/// `config` with these settings. Throws Error as set() does.
Config with_settings(Config config, const std::vector<Setting>& settings);

/// The loss of each frame with these settings; nullopt where it was told to stop meanwhile. Settings that
/// contradict each other lose infinitely.
using Measure = std::function<std::optional<std::vector<Loss>>(const std::vector<Setting>&)>;

struct SearchConfig {
  int evaluations = 1 << 30;  // at most; the start is the first
  double first_step = 1.6;    // factor on numbers
  double last_step = 1.1;
  Margin margin{};         // a gain below is none
  std::uint32_t seed = 1;  // decides in which order options are tried
  /// Whether an option, by its index, is read with these settings; empty: all are. What is not is not tried.
  std::function<bool(const std::vector<Setting>&, std::size_t)> is_read{};
};

enum class SearchEnd : std::uint8_t {
  converged,    // nothing near the best is better
  evaluations,  // their number is used up
  stopped       // the measure was told to stop
};

struct SearchResult {
  std::vector<Setting> start;
  std::vector<Setting> best;       // `start` where nothing was better
  std::vector<Loss> start_losses;  // empty where the search was stopped before they were known
  std::vector<Loss> best_losses;
  int evaluations = 0;
  SearchEnd end = SearchEnd::converged;
};

/// Searches from `start` (one setting for each tunable, in order) for settings of less loss. One option after
/// the other, in an order drawn anew for each sweep, its neighbours() are measured; what is clearly_better()
/// is kept at once, unless it has more faults than the start, and a number goes on the way that helped. A
/// sweep without gain takes the root of the step; the search ends below the last step. An option that changes
/// no frame's loss is left out from then on. `improved` (may be empty) is called for the start and for each
/// new best, directly after its measurement. The same input gives the same result, whatever the time.
/// (docs/decisions/tuning.md)
SearchResult search(const std::vector<Tunable>& tunables, const std::vector<Setting>& start,
                    const Measure& measure, const SearchConfig& config,
                    const std::function<void(const std::vector<Setting>&)>& improved = {});

}  // namespace cairn
