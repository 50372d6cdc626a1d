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

/// Frames in memory, and what settings do on them.
namespace cairn {

/// What is made as small as can be: the paper's E, bad disparities, or contradictions where nothing is known.
enum class TuningGoal : std::uint8_t { objects, disparities, consistency };

/// A frame to tune on, with what is known of it. Borrows its images, all of one size.
struct TuningFrame {
  std::string name;  // frames of one name show the same scene
  StereoPair pair;
  std::optional<StereoRig> rig;
  Config config;                      // with what the frame's calibration says
  bool follows = false;               // the frame before it shows nearly the same: shows_the_same()
  View<const TruthId> objects{};      // empty where not known, or not asked for
  bool partial = false;               // not every object is labelled
  View<const float> truth_px{};       // NaN = not known
  View<const std::uint8_t> hidden{};  // not 0 = not seen by the right camera
};

/// Whether most of the left picture is as it was in the frame before.
bool shows_the_same(View<const Gray> before, View<const Gray> now);

/// E where an object is known anywhere, else disparities where those are, else consistency.
TuningGoal goal_of(const std::vector<TuningFrame>& frames);

/// What a frame's pair came to when it was last matched: most options change only what comes after.
struct MatchedOnce {
  std::string settings;  // all that it depends on; empty: not matched yet
  DisparityMap disparity{};
};

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
  std::function<bool()> stop;  // asked between frames, on any thread
};

/// The frames that `chosen` marks, in order; nullopt where stop() said so before all were done. Settings that
/// contradict each other lose infinitely. `matched` has an entry for each frame, and saves time only.
std::optional<std::vector<FrameMeasure>> measure_frames(const std::vector<TuningFrame>& frames,
                                                        const std::vector<bool>& chosen,
                                                        const std::vector<Setting>& settings,
                                                        const MeasureOptions& options,
                                                        std::vector<MatchedOnce>& matched);
std::vector<Loss> losses_of(const std::vector<FrameMeasure>& measures);

}  // namespace cairn
