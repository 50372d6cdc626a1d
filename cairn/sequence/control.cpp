// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/sequence/control.hpp>

#include <algorithm>
#include <cairn/core/error.hpp>
#include <cairn/pipeline/option_walk.hpp>
#include <cmath>

namespace cairn {

namespace {

/// Whether `config` with another value of one option is valid.
bool is_valid(Config config, const std::string& option, const std::string& value, Size image) {
  try {
    set(config, option, value);
    validate(config, image, true);
    return true;
  } catch (const Error&) {
    return false;
  }
}

/// Gains, relative to the mean of the setting in force, that let a candidate stay in the search and win it.
double min_gain(const OptionCandidate& candidate, double min_gain_percent) {
  return candidate.restores ? 0 : min_gain_percent / 100;
}

}  // namespace

std::string value_of(const Config& config, const std::string& option) {
  const std::vector<OptionInfo> all = options(config);
  return std::ranges::find(all, option, &OptionInfo::name)->value;
}

std::vector<OptionCandidate> differences(const Config& config, const Config& known) {
  const std::vector<OptionInfo> there = active_options(known);
  std::vector<OptionCandidate> differ;
  for (const OptionInfo& here : active_options(config)) {
    const auto other = std::ranges::find(there, here.name, &OptionInfo::name);
    if (other != there.end() && other->value != here.value) differ.push_back({here.name, other->value});
  }
  return differ;
}

std::vector<OptionCandidate> restoring_candidates(const Config& config, const Config& known, Size image) {
  std::vector<OptionCandidate> candidates = differences(config, known);
  std::erase_if(candidates, [&](const OptionCandidate& candidate) {
    return candidate.option == "match.min_disparity" || candidate.option.starts_with("obstacles.") ||
           (candidate.option == "match.num_disparities" &&
            known.match.num_disparities < config.match.num_disparities) ||
           (candidate.option == "ground.source" && config.ground.source != GroundSource::off) ||
           !is_valid(config, candidate.option, candidate.value, image);
  });
  for (OptionCandidate& candidate : candidates)
    candidate.restores = candidate.option != "match.num_disparities";
  return candidates;
}

Config nearest_preset(const Config& config) {
  std::vector<Config> presets;
  for (const std::string& name : preset_names()) presets.push_back(Config::preset(name));
  return *std::ranges::min_element(presets, {},
                                   [&](const Config& preset) { return differences(config, preset).size(); });
}

std::vector<OptionCandidate> option_candidates(const Config& config, Size image, float step) {
  const std::vector<OptionInfo> known = active_options(config);
  std::vector<OptionCandidate> candidates;
  const auto add = [&](const std::string& option, const std::string& value) {
    const auto now = std::ranges::find(known, option, &OptionInfo::name);
    if (now == known.end() || now->value == value) return;
    if (is_valid(config, option, value, image)) candidates.push_back({option, value});
  };
  const auto scale = [&](const std::string& option, float value, float by) {
    if (value > 0) add(option, option_walk::write(value * by));
  };
  const auto scale_whole = [&](const std::string& option, int value, float by) {
    if (value > 0)
      add(option, option_walk::write(static_cast<int>(std::lround(static_cast<float>(value) * by))));
  };
  if (2 * config.match.num_disparities <= image.width / 2)
    scale_whole("match.num_disparities", config.match.num_disparities, 2);
  if (config.ground.source == GroundSource::off) add("ground.source", "automatic");
  for (const float by : {step, 1 / step}) {
    scale_whole("superpixels.count", config.superpixels.count, by);
    scale("objects.min_area", config.objects.min_area, 1 / by);
    scale("ground.margin", config.ground.margin, 1 / by);
    scale_whole("speckle.size", config.speckle.size, 1 / by);
    scale("left_right.max_diff", config.left_right.max_diff, by);
    scale("semi_global.penalty_large", config.semi_global.penalty_large, by);
  }
  add("background.max_walls", config.background.max_walls > 0 ? "0" : "3");
  add("match.method", config.match.method == MatchMethod::window ? "semi_global" : "window");
  return candidates;
}

CandidateGain gain_of(const CandidateScore& score) {
  constexpr double kOneSided95 = 1.645;
  constexpr double kMin = 1e-3;  // bounds the divisor for a configuration that finds nothing
  const std::size_t count = std::min(score.of_candidate.size(), score.of_present.size());
  if (count < 2) return {};
  const auto n = static_cast<double>(count);
  double sum = 0;
  double squares = 0;
  double present = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double more = double{score.of_candidate[i]} - double{score.of_present[i]};
    sum += more;
    squares += more * more;
    present += double{score.of_present[i]};
  }
  const double mean = sum / n;
  const double variance = std::max(0.0, squares / n - mean * mean) / (n - 1);
  const double base = std::max(kMin, present / n);
  return {mean / base, (mean - kOneSided95 * std::sqrt(variance)) / base};
}

std::vector<CandidateScore> halved(std::vector<CandidateScore> round, float min_gain_percent) {
  const std::size_t most = (round.size() + 1) / 2;
  std::ranges::stable_sort(round, std::ranges::greater{},
                           [](const CandidateScore& s) { return gain_of(s).mean; });
  if (round.size() > 1) round.resize(most);
  std::erase_if(round, [&](const CandidateScore& s) {
    const double gain = gain_of(s).mean;
    return gain <= 0 || gain < min_gain(s.candidate, min_gain_percent) / 2;
  });
  return round;
}

bool is_better(const CandidateScore& score, const ControlConfig& config) {
  const CandidateGain gain = gain_of(score);
  return static_cast<int>(score.of_candidate.size()) >= config.window &&
         gain.mean >= min_gain(score.candidate, config.min_gain) && gain.low > 0;
}

}  // namespace cairn
