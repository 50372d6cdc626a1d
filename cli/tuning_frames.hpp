// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/tuning/frame_loss.hpp>
#include <cairn/tuning/search.hpp>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common.hpp"

/// Frames in memory, and what settings do on them.
namespace cairn::cli {

/// What is made as small as can be: the paper's E, bad disparities, or contradictions where nothing is known.
enum class TuningGoal : std::uint8_t { objects, disparities, consistency };

/// What a frame's pair came to when it was last matched: most options change only what comes after.
struct MatchedOnce {
  std::string settings;  // all that it depends on; empty: not matched yet
  DisparityMap disparity{};
};

struct TuningFrame {
  std::string name;
  LoadedFrame loaded;
  bool follows = false;      // the frame before it in the folder shows nearly the same
  Image<TruthId> objects{};  // empty where not known, or not asked for
  bool partial = false;      // not every object is labelled
  Image<float> truth_px{};
  Image<std::uint8_t> hidden{};  // 1 = not seen by the right camera
};

/// Every frame of the folders, with its truth where `with_truth`. Throws Error for a bad frame, one without
/// truth where that is asked for, and for a configuration that does not fit a frame.
std::vector<TuningFrame> load_tuning_frames(const std::vector<std::string>& folders, InputOptions input,
                                            bool with_truth);
/// E where an object is known anywhere, else disparities where those are, else consistency.
TuningGoal goal_of(const std::vector<TuningFrame>& frames);

/// What settings do on one frame.
struct FrameMeasure {
  Loss loss;
  std::optional<FrameObjects> objects{};
  std::optional<DisparityErrors> disparity{};
  std::optional<Consistency> consistency{};
  std::optional<Steadiness> since_last{};  // where the frame before it is among those measured
};

struct MeasureOptions {
  TuningGoal goal = TuningGoal::objects;
  int threads = 1;
  Target target = Target::best;
  std::function<bool()> stop;  // asked between frames
};

/// The frames that `chosen` marks, in order; nullopt where stop() said so before all were done. Settings that
/// contradict each other lose infinitely. `matched` has an entry for each frame, and saves time only.
std::optional<std::vector<FrameMeasure>> measure_frames(const std::vector<TuningFrame>& frames,
                                                        const std::vector<bool>& chosen,
                                                        const std::vector<Setting>& settings,
                                                        const MeasureOptions& options,
                                                        std::vector<MatchedOnce>& matched);
std::vector<Loss> losses_of(const std::vector<FrameMeasure>& measures);

}  // namespace cairn::cli
