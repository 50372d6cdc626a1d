// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/tuning/search.hpp>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <set>

namespace cairn {
namespace {

bool same_losses(const std::vector<Loss>& a, const std::vector<Loss>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const Loss& x, const Loss& y) { return x.sum == y.sum && x.weight == y.weight; });
}

std::string key_of(const std::vector<Setting>& settings) {
  std::string key;
  for (const Setting& setting : settings) key += setting.value + '\n';
  return key;
}

/// The state of one search.
class Searcher {
 public:
  Searcher(const std::vector<Tunable>& tunables, const std::vector<Setting>& start, const Measure& measure,
           const SearchConfig& config, const std::function<void(const std::vector<Setting>&)>& improved)
      : tunables_(tunables), measure_(measure), config_(config), improved_(improved), random_(config.seed) {
    assert(tunables.size() == start.size());
    result_.start = start;
    result_.best = start;
    matters_.assign(tunables.size(), true);
  }

  SearchResult run() {
    if (!measure_start()) return result_;
    double step = config_.first_step;
    while (step >= config_.last_step && !over_) {
      if (!sweep(step)) step = std::sqrt(step);
    }
    return result_;
  }

 private:
  bool measure_start() {
    auto losses = measured(result_.start);
    if (!losses) return false;
    result_.start_losses = *losses;
    result_.best_losses = std::move(*losses);
    if (improved_) improved_(result_.best);
    return true;
  }

  /// nullopt if these settings were measured before, or the search is over.
  std::optional<std::vector<Loss>> measured(const std::vector<Setting>& settings) {
    if (over_ || seen_.contains(key_of(settings))) return std::nullopt;
    if (result_.evaluations >= config_.evaluations) {
      finish(SearchEnd::evaluations);
      return std::nullopt;
    }
    auto losses = measure_(settings);
    if (!losses) {
      finish(SearchEnd::stopped);
      return std::nullopt;
    }
    seen_.insert(key_of(settings));
    ++result_.evaluations;
    return losses;
  }

  void finish(SearchEnd end) {
    over_ = true;
    result_.end = end;
  }

  /// Returns whether any setting improved the loss.
  bool sweep(double step) {
    bool better = false;
    for (const std::size_t i : order()) {
      if (over_) break;
      if (matters_[i] && try_option(i, step)) better = true;
    }
    return better;
  }

  /// std::shuffle's result differs between standard libraries.
  std::vector<std::size_t> order() {
    std::vector<std::size_t> all(tunables_.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    for (std::size_t i = all.size(); i > 1; --i) std::swap(all[i - 1], all[random_() % i]);
    return all;
  }

  bool try_option(std::size_t i, double step) {
    if (config_.is_read && !config_.is_read(result_.best, i)) return false;
    tried_ = 0;
    changed_ = 0;
    bool better = false;
    for (std::size_t way = 0; !better; ++way) {
      const auto around = neighbours(tunables_[i], result_.best[i].value, step);
      if (way >= around.size()) break;
      if (!try_value(i, around[way])) continue;
      better = true;
      go_on(i, way, step);
    }
    if (tried_ > 0 && changed_ == 0) matters_[i] = false;
    return better;
  }

  /// Repeats a successful step for as long as it improves the loss.
  void go_on(std::size_t i, std::size_t way, double step) {
    for (;;) {
      const auto around = neighbours(tunables_[i], result_.best[i].value, step);
      if (way >= around.size() || !try_value(i, around[way])) return;
    }
  }

  bool try_value(std::size_t i, const std::string& value) {
    std::vector<Setting> candidate = result_.best;
    candidate[i].value = value;
    auto losses = measured(candidate);
    if (!losses) return false;
    ++tried_;
    if (!same_losses(*losses, result_.best_losses)) ++changed_;
    if (faults(*losses) > faults(result_.start_losses)) return false;
    if (!clearly_better(result_.best_losses, *losses, config_.margin)) return false;
    result_.best = std::move(candidate);
    result_.best_losses = std::move(*losses);
    if (improved_) improved_(result_.best);
    return true;
  }

  const std::vector<Tunable>& tunables_;
  const Measure& measure_;
  const SearchConfig& config_;
  const std::function<void(const std::vector<Setting>&)>& improved_;
  std::mt19937 random_;
  std::set<std::string> seen_;
  std::vector<bool> matters_;
  bool over_ = false;
  int tried_ = 0;
  int changed_ = 0;
  SearchResult result_;
};

}  // namespace

double mean_loss(const std::vector<Loss>& frames) {
  Loss all;
  for (const Loss& frame : frames) {
    all.sum += frame.sum;
    all.weight += frame.weight;
  }
  return all.weight > 0 ? all.sum / all.weight : std::numeric_limits<double>::infinity();
}

namespace {

/// Frames without weight, where nothing is scored, are no samples.
std::size_t scored(const std::vector<Loss>& frames) {
  return static_cast<std::size_t>(
      std::count_if(frames.begin(), frames.end(), [](const Loss& frame) { return frame.weight > 0; }));
}

}  // namespace

bool clearly_better(const std::vector<Loss>& before, const std::vector<Loss>& after, const Margin& margin) {
  assert(before.size() == after.size());
  const double lost_before = mean_loss(before);
  const double lost_after = mean_loss(after);
  if (!std::isfinite(lost_after)) return false;
  if (!std::isfinite(lost_before)) return true;
  if (lost_before - lost_after < margin.least_share * lost_before || lost_after >= lost_before) return false;
  const auto count = static_cast<double>(scored(before));
  if (count < 2) return true;
  double sum = 0;
  double squares = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const double gain = before[i].sum - after[i].sum;
    sum += gain;
    squares += gain * gain;
  }
  // mean > k standard errors, squared and without division; gains of a single frame only are equal, not
  // greater.
  const double mean_square = sum * sum / count;
  constexpr double kRounding = 1e-9;
  const double k2 = margin.standard_errors * margin.standard_errors;
  return mean_square * (count - 1) > k2 * (squares - mean_square) * (1 + kRounding);
}

namespace {

/// Two-sided 95 % quantile of Student's t distribution.
double t_quantile(std::size_t degrees) {
  constexpr std::array kTable{12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228};
  if (degrees <= kTable.size()) return kTable[degrees - 1];
  const auto n = static_cast<double>(degrees);
  return 1.960 + 2.372 / n + 3.0 / (n * n);  // first terms of its series in 1/n; accurate to 0.001 here
}

}  // namespace

Gain gain_of(const std::vector<Loss>& before, const std::vector<Loss>& after) {
  assert(before.size() == after.size());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double mean = mean_loss(before) - mean_loss(after);
  if (!std::isfinite(mean)) return {nan, nan, nan};
  const std::size_t samples = scored(before);
  if (samples < 2) return {mean, nan, nan};
  double squares = 0;
  double weight = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const double rest = before[i].sum - after[i].sum - mean * before[i].weight;
    squares += rest * rest;
    weight += before[i].weight;
  }
  const auto count = static_cast<double>(samples);
  const double reach = t_quantile(samples - 1) * std::sqrt(squares * count / (count - 1)) / weight;
  return {mean, mean - reach, mean + reach};
}

int faults(const std::vector<Loss>& frames) {
  return std::accumulate(frames.begin(), frames.end(), 0,
                         [](int sum, const Loss& frame) { return sum + frame.faults; });
}

std::vector<Setting> settings_of(const Config& config, const std::vector<Tunable>& tunables) {
  std::vector<Setting> settings;
  const std::vector<OptionInfo> all = options(config);
  for (const Tunable& tunable : tunables) {
    const auto found = std::find_if(all.begin(), all.end(),
                                    [&](const OptionInfo& option) { return option.name == tunable.name; });
    assert(found != all.end());
    settings.push_back({tunable.name, found->value});
  }
  return settings;
}

Config with_settings(Config config, const std::vector<Setting>& settings) {
  for (const Setting& setting : settings) set(config, setting.option, setting.value);
  return config;
}

SearchResult search(const std::vector<Tunable>& tunables, const std::vector<Setting>& start,
                    const Measure& measure, const SearchConfig& config,
                    const std::function<void(const std::vector<Setting>&)>& improved) {
  return Searcher(tunables, start, measure, config, improved).run();
}

}  // namespace cairn
