// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cairn/core/stereo_pair.hpp>
#include <cairn/tuning/frame_loss.hpp>
#include <cairn/tuning/search.hpp>
#include <functional>
#include <optional>
#include <string>
#include <vector>

/// Frames in memory, and the loss of settings on them.
namespace cairn {

/// The quantity to minimise: the paper's E, bad disparities, or, without truth, self-inconsistency.
enum class TuningGoal : std::uint8_t { objects, disparities, consistency };

/// A frame to tune on, with its ground truth. Borrows its images, all of one size.
struct TuningFrame {
  std::string name;  // frames with the same name show the same scene
  StereoPair pair;
  std::optional<StereoRig> rig;
  Config config;                      // including the calibration of the frame
  bool follows = false;               // nearly equal to the frame before: shows_the_same()
  View<const TruthId> objects{};      // empty if unknown, or unwanted
  bool partial = false;               // not every object is labelled
  View<const float> truth_px{};       // NaN = unknown
  View<const std::uint8_t> hidden{};  // non-zero = not seen by the right camera
};

/// Whether most of the left image is unchanged since the frame before.
bool shows_the_same(View<const Gray> before, View<const Gray> now);

/// E if any frame has true objects, else disparities if any frame has true ones, else consistency.
TuningGoal goal_of(const std::vector<TuningFrame>& frames);

/// The last matching result of a frame: most options only affect later stages.
struct MatchResult {
  std::string settings;  // the settings that it depends on; empty: not matched yet
  DisparityMap disparity{};
};

/// The result of settings on one frame.
struct FrameMeasure {
  Loss loss;
  std::optional<FrameObjects> objects{};
  std::optional<DisparityErrors> disparity{};
  std::optional<Consistency> consistency{};
  std::optional<Steadiness> since_last{};  // if the frame before is measured too
};

struct MeasureOptions {
  TuningGoal goal = TuningGoal::objects;
  int threads = 1;
  Target target = Target::best;
  std::function<bool()> stop;  // called between frames, on any thread
};

/// Measures the frames marked in `chosen`, in order; nullopt if stop() returned true before the last.
/// Contradictory settings have infinite loss. `matched` has an entry per frame; it only saves time.
std::optional<std::vector<FrameMeasure>> measure_frames(const std::vector<TuningFrame>& frames,
                                                        const std::vector<bool>& chosen,
                                                        const std::vector<Setting>& settings,
                                                        const MeasureOptions& options,
                                                        std::vector<MatchResult>& matched);
std::vector<Loss> losses_of(const std::vector<FrameMeasure>& measures);

}  // namespace cairn
