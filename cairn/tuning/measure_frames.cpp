// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <array>
#include <atomic>
#include <cairn/core/each_index.hpp>
#include <cairn/core/error.hpp>
#include <cairn/pipeline/segment.hpp>
#include <cairn/tuning/measure_frames.hpp>
#include <limits>

namespace cairn {
namespace {

/// A frame's measure, and the disparities to compare with the next frame.
struct Outcome {
  FrameMeasure measure;
  Image<float> disparity_px{};
};

/// The options that determine the disparities before the ground is fitted. Options are in data-flow order.
std::string matching_settings(const Config& config) {
  std::string all;
  for (const OptionInfo& option : options(config)) {
    if (option.name.starts_with("ground.")) break;
    all += option.value + '\n';
  }
  return all;
}

DisparityMap copy_of(const DisparityMap& map, const Exec& exec) {
  return {map.disparity_px.clone(exec.pool), map.reject.clone(exec.pool)};
}

/// Runs the whole method; reuses the disparities if the matching options are unchanged.
Frame segment_again(const TuningFrame& frame, const Config& config, MatchResult& matched, const Exec& exec) {
  validate(config, frame.pair.size(), frame.rig.has_value());
  std::string settings = matching_settings(config);
  if (matched.settings == settings) {
    return segment({{frame.pair.left(), frame.pair.left_rgb()}, {}, copy_of(matched.disparity, exec)},
                   {frame.rig, config, exec});
  }
  Exec watched = exec;
  watched.observe = [&](std::string_view stage, const StageResult& result, double) {
    // Not from the pool, which is destroyed with its thread.
    if (stage == "combine") matched.disparity = copy_of(*result.as<DisparityMap>(), {});
  };
  Frame found = segment(frame.pair, frame.rig, config, watched);
  matched.settings = std::move(settings);
  return found;
}

Outcome judge_objects(const TuningFrame& frame, const Config& config, MatchResult& matched,
                      const Exec& exec) {
  const Frame found = segment_again(frame, config, matched, exec);
  Outcome outcome;
  if (!frame.objects.empty()) {
    outcome.measure.objects =
        FrameObjects{object_errors(found.objects.labels, frame.objects, {}), frame.partial};
    outcome.measure.loss = loss_of(*outcome.measure.objects);
  }
  if (!frame.truth_px.empty()) {
    outcome.measure.disparity =
        disparity_errors(found.disparity.disparity_px, frame.truth_px, frame.hidden, 0);
  }
  return outcome;
}

Outcome judge_disparities(const TuningFrame& frame, const Config& config, const Exec& exec) {
  const StereoResult found = estimate_disparity(frame.pair, frame.rig, config, exec);
  Outcome outcome;
  if (frame.truth_px.empty()) return outcome;
  outcome.measure.disparity = disparity_errors(found.disparity.disparity_px, frame.truth_px, frame.hidden, 0);
  outcome.measure.loss = loss_of(*outcome.measure.disparity);
  return outcome;
}

Outcome judge_consistency(const TuningFrame& frame, const Config& config, const Exec& exec) {
  Image<std::int16_t> best_right;
  Image<Gray> aligned_right;
  Exec watched = exec;
  watched.observe = [&](std::string_view stage, const StageResult& result, double) {
    if (stage == "match") best_right = result.as<Matches>()->best_right.clone(exec.pool);
    if (stage == "correct_epipolar") aligned_right = result.as<Image<std::uint8_t>>()->clone(exec.pool);
  };
  StereoResult found = estimate_disparity(frame.pair, frame.rig, config, watched);
  Outcome outcome;
  outcome.measure.consistency =
      consistency(frame.pair.left(), aligned_right.empty() ? frame.pair.right() : aligned_right.view(),
                  found.disparity.disparity_px, best_right);
  outcome.disparity_px = std::move(found.disparity.disparity_px);
  return outcome;
}

Outcome judge(const TuningFrame& frame, const std::vector<Setting>& settings, TuningGoal goal,
              MatchResult& matched, const Exec& exec) {
  const Config config = with_settings(frame.config, settings);
  switch (goal) {
    case TuningGoal::objects:
      return judge_objects(frame, config, matched, exec);
    case TuningGoal::disparities:
      return judge_disparities(frame, config, exec);
    case TuningGoal::consistency:
      return judge_consistency(frame, config, exec);
  }
  return {};
}

/// The losses between consecutive frames: steadiness needs two.
void compare_neighbours(const std::vector<TuningFrame>& frames, const std::vector<std::size_t>& indices,
                        std::vector<Outcome>& outcomes) {
  for (std::size_t k = 0; k < indices.size(); ++k) {
    FrameMeasure& measure = outcomes[k].measure;
    const bool has_neighbour = k > 0 && indices[k] == indices[k - 1] + 1 && frames[indices[k]].follows;
    if (has_neighbour) {
      measure.since_last = steadiness(frames[indices[k - 1]].pair.left(), frames[indices[k]].pair.left(),
                                      outcomes[k - 1].disparity_px, outcomes[k].disparity_px);
    }
    measure.loss = loss_of(*measure.consistency, measure.since_last);
  }
}

std::vector<FrameMeasure> contradiction(std::size_t count) {
  FrameMeasure measure;
  measure.loss = {std::numeric_limits<double>::infinity(), 1};
  std::vector<FrameMeasure> all;
  for (std::size_t i = 0; i < count; ++i) all.push_back(measure);
  return all;
}

}  // namespace

bool shows_the_same(View<const Gray> before, View<const Gray> now) {
  if (before.size() != now.size()) return false;
  const Image<float> nothing(now.size(), std::numeric_limits<float>::quiet_NaN(), {});
  return steadiness(before, now, nothing, nothing).follows();
}

TuningGoal goal_of(const std::vector<TuningFrame>& frames) {
  const auto any = [&](const auto& known) { return std::any_of(frames.begin(), frames.end(), known); };
  if (any([](const TuningFrame& frame) { return !frame.objects.empty(); })) return TuningGoal::objects;
  if (any([](const TuningFrame& frame) { return !frame.truth_px.empty(); })) return TuningGoal::disparities;
  return TuningGoal::consistency;
}

std::optional<std::vector<FrameMeasure>> measure_frames(const std::vector<TuningFrame>& frames,
                                                        const std::vector<bool>& chosen,
                                                        const std::vector<Setting>& settings,
                                                        const MeasureOptions& options,
                                                        std::vector<MatchResult>& matched) {
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (chosen[i]) indices.push_back(i);
  }
  std::vector<Outcome> outcomes(indices.size());
  std::atomic<bool> stopped = false;
  try {
    for_each_index(
        indices.size(), options.threads,
        [&](std::size_t k, const Exec& exec) {
          if (options.stop && options.stop()) stopped = true;
          if (stopped) return;
          const std::size_t i = indices[k];
          outcomes[k] = judge(frames[i], settings, options.goal, matched[i], exec);
        },
        options.target);
  } catch (const Error&) {  // by validate(): the settings do not suit the frames, as the first ones did
    return contradiction(indices.size());
  }
  if (stopped) return std::nullopt;
  if (options.goal == TuningGoal::consistency) compare_neighbours(frames, indices, outcomes);
  std::vector<FrameMeasure> measures;
  measures.reserve(outcomes.size());
  for (Outcome& outcome : outcomes) measures.push_back(std::move(outcome.measure));
  return measures;
}

std::vector<Loss> losses_of(const std::vector<FrameMeasure>& measures) {
  std::vector<Loss> losses;
  losses.reserve(measures.size());
  for (const FrameMeasure& measure : measures) losses.push_back(measure.loss);
  return losses;
}

}  // namespace cairn
