// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "tuning_frames.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <benchmarks/each_index.hpp>
#include <cairn/core/error.hpp>
#include <cairn/pipeline/segment.hpp>
#include <io/disparity_files.hpp>
#include <limits>

namespace cairn::cli {
namespace {

namespace fs = std::filesystem;

template <class T>
void require_size(const Image<T>& truth, const fs::path& file, const LoadedFrame& frame) {
  if (truth.size() != frame.left.gray.size()) {
    throw Error(file.string() + ": the truth is " + text(truth.size()) + ", the pictures are " +
                text(frame.left.gray.size()));
  }
}

void load_truth(const io::TruthFiles& files, TuningFrame& frame) {
  frame.partial = files.partial;
  if (files.objects) {
    frame.objects = io::truth_ids(io::load_labels(*files.objects));
    require_size(frame.objects, *files.objects, frame.loaded);
  }
  if (files.disparity) {
    frame.truth_px = io::load_disparity(*files.disparity);
    require_size(frame.truth_px, *files.disparity, frame.loaded);
  }
  if (files.occlusion) {
    frame.hidden = io::hidden_pixels(io::load_labels(*files.occlusion));
    require_size(frame.hidden, *files.occlusion, frame.loaded);
  }
}

bool shows_the_same(View<const Gray> before, View<const Gray> now) {
  if (before.size() != now.size()) return false;
  const Image<float> nothing(now.size(), std::numeric_limits<float>::quiet_NaN(), {});
  return steadiness(before, now, nothing, nothing).follows();
}

TuningFrame load_one(const io::FrameFiles& files, const InputOptions& input, bool with_truth) {
  try {
    TuningFrame frame{files.name, load_frame(files, input, {})};
    validate(frame.loaded.config, frame.loaded.left.gray.size(), frame.loaded.rig.has_value());
    if (with_truth) load_truth(io::find_truth(files.folder), frame);
    return frame;
  } catch (const Error& error) {
    throw Error("frame " + files.name + ": " + error.what());
  }
}

/// A frame's measure, and what the next frame is compared with.
struct Outcome {
  FrameMeasure measure;
  Image<float> disparity_px{};
};

/// The options that a pair's disparities depend on before there is a ground.
std::string matching_settings(const Config& config) {
  constexpr std::array<std::string_view, 8> kStages{
      "epipolar_correction.", "match.",      "semi_global.", "subpixel.",
      "left_right.",          "uniqueness.", "flatness.",    "texture."};
  std::string all;
  for (const OptionInfo& option : options(config)) {
    const bool matters = std::any_of(kStages.begin(), kStages.end(),
                                     [&](std::string_view stage) { return option.name.starts_with(stage); });
    if (matters) all += option.value + '\n';
  }
  return all;
}

DisparityMap copy_of(const DisparityMap& map, const Exec& exec) {
  return {map.disparity_px.clone(exec.pool), map.reject.clone(exec.pool)};
}

/// The whole method; what is matched already is not matched again.
Frame segment_again(const TuningFrame& frame, const StereoPair& pair, const Config& config,
                    MatchedOnce& matched, const Exec& exec) {
  validate(config, pair.size(), frame.loaded.rig.has_value());
  std::string settings = matching_settings(config);
  if (matched.settings == settings) {
    return segment(pair.left(), pair.left_rgb(), copy_of(matched.disparity, exec), frame.loaded.rig, config,
                   exec);
  }
  Exec watched = exec;
  watched.observe = [&](std::string_view stage, const Artifact& artifact, double) {
    // Not from the pool, which goes with its thread.
    if (stage == "combine") matched.disparity = copy_of(*std::get<const DisparityMap*>(artifact), {});
  };
  Frame found = segment(pair, frame.loaded.rig, config, watched);
  matched.settings = std::move(settings);
  return found;
}

Outcome judge_objects(const TuningFrame& frame, const StereoPair& pair, const Config& config,
                      MatchedOnce& matched, const Exec& exec) {
  const Frame found = segment_again(frame, pair, config, matched, exec);
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

Outcome judge_disparities(const TuningFrame& frame, const StereoPair& pair, const Config& config,
                          const Exec& exec) {
  const SceneDisparity found = estimate_disparity(pair, frame.loaded.rig, config, exec);
  Outcome outcome;
  if (frame.truth_px.empty()) return outcome;
  outcome.measure.disparity = disparity_errors(found.disparity.disparity_px, frame.truth_px, frame.hidden, 0);
  outcome.measure.loss = loss_of(*outcome.measure.disparity);
  return outcome;
}

Outcome judge_consistency(const TuningFrame& frame, const StereoPair& pair, const Config& config,
                          const Exec& exec) {
  Image<std::int16_t> best_right;
  Image<Gray> aligned_right;
  Exec watched = exec;
  watched.observe = [&](std::string_view stage, const Artifact& artifact, double) {
    if (stage == "match") best_right = std::get<const Matches*>(artifact)->best_right.clone(exec.pool);
    if (stage == "correct_epipolar")
      aligned_right = std::get<const Image<std::uint8_t>*>(artifact)->clone(exec.pool);
  };
  SceneDisparity found = estimate_disparity(pair, frame.loaded.rig, config, watched);
  Outcome outcome;
  outcome.measure.consistency =
      consistency(pair.left(), aligned_right.empty() ? pair.right() : aligned_right.view(),
                  found.disparity.disparity_px, best_right);
  outcome.disparity_px = std::move(found.disparity.disparity_px);
  return outcome;
}

Outcome judge(const TuningFrame& frame, const std::vector<Setting>& settings, TuningGoal goal,
              MatchedOnce& matched, const Exec& exec) {
  Config config = with_settings(frame.loaded.config, settings);
  config.confidence.enabled = false;  // changes nothing else
  const LoadedFrame& loaded = frame.loaded;
  const auto pair = StereoPair::from(loaded.left.gray, loaded.right, loaded.left.rgb);
  switch (goal) {
    case TuningGoal::objects:
      return judge_objects(frame, pair, config, matched, exec);
    case TuningGoal::disparities:
      return judge_disparities(frame, pair, config, exec);
    case TuningGoal::consistency:
      return judge_consistency(frame, pair, config, exec);
  }
  return {};
}

/// The losses of the frames among themselves: steadiness needs two.
void compare_neighbours(const std::vector<TuningFrame>& frames, const std::vector<std::size_t>& indices,
                        std::vector<Outcome>& outcomes) {
  for (std::size_t k = 0; k < indices.size(); ++k) {
    FrameMeasure& measure = outcomes[k].measure;
    const bool has_neighbour = k > 0 && indices[k] == indices[k - 1] + 1 && frames[indices[k]].follows;
    if (has_neighbour) {
      measure.since_last =
          steadiness(frames[indices[k - 1]].loaded.left.gray, frames[indices[k]].loaded.left.gray,
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

std::vector<TuningFrame> load_tuning_frames(const std::vector<std::string>& folders, InputOptions input,
                                            bool with_truth) {
  std::vector<TuningFrame> frames;
  for (const std::string& folder : folders) {
    std::error_code ignored;
    if (!fs::is_directory(folder, ignored)) {
      throw Error(folder +
                  ": no such folder, expected one with left.png and right.png, or a folder of such folders");
    }
    input.left = folder;
    bool first = true;
    for (const io::FrameFiles& files : frames_of(input)) {
      frames.push_back(load_one(files, input, with_truth));
      TuningFrame& last = frames.back();
      last.follows =
          !first && shows_the_same(frames[frames.size() - 2].loaded.left.gray, last.loaded.left.gray);
      first = false;
    }
  }
  return frames;
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
                                                        std::vector<MatchedOnce>& matched) {
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (chosen[i]) indices.push_back(i);
  }
  std::vector<Outcome> outcomes(indices.size());
  std::atomic<bool> stopped = false;
  try {
    report::for_each_index(
        indices.size(), options.threads,
        [&](std::size_t k, const Exec& exec) {
          if (options.stop && options.stop()) stopped = true;
          if (stopped) return;
          const std::size_t i = indices[k];
          outcomes[k] = judge(frames[i], settings, options.goal, matched[i], exec);
        },
        options.target);
  } catch (const Error&) {  // by validate(): the frames fitted the configuration that the search started from
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

}  // namespace cairn::cli
