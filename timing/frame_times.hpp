// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/pipeline/segment.hpp>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "opencv_matchers.hpp"

/// How long the method takes, stage by stage and frame by frame, and what stands beside it.
namespace cairn::report {

/// Milliseconds of one thing, one value for each frame.
struct Samples {
  std::vector<double> wall_ms;
  std::vector<double> cpu_ms;  // of the whole process, all its threads
};

struct StageTimes {
  std::string name;            // as the observer names it
  bool for_disparity = false;  // estimate_disparity() has this stage, too: all that a matcher does
  Samples times;
};

struct PeerTimes {
  const OpenCvMatcher* matcher = nullptr;
  Samples times;
  std::string refusal;        // why OpenCV does not take this pair; no times then
  Image<float> disparity_px;  // NaN = hole
};

struct FrameTimes {
  double first_frame_ms = 0;       // wall: fills the pool and the caches
  std::vector<StageTimes> stages;  // in the order of the first frame
  Samples disparity;               // the sum of its stages
  Samples frame;
  std::int64_t pool_bytes = 0;         // what the pool held at its peak
  std::int64_t resident_bytes = 0;     // the most that the process had held after the first frame
  std::int64_t first_allocations = 0;  // image buffers from the heap, in the first frame …
  std::int64_t later_allocations = 0;  // … and in all later ones
  int objects = 0;
  Image<float> disparity_px;  // NaN = hole
  std::vector<PeerTimes> peers;

  [[nodiscard]] int frames() const { return static_cast<int>(frame.wall_ms.size()); }
};

/// When to stop: after so many frames or so much time; time does not stop it before the third frame.
struct Limits {
  int frames = std::numeric_limits<int>::max();
  double seconds = std::numeric_limits<double>::infinity();
};

/// Runs the method on one pair over and over, and each of the matchers once after each frame, so that
/// whatever else the machine does hits all alike. The images come from a pool that the frames share, whatever
/// exec.pool is; exec.observe is not called. Throws Error where segment() does.
FrameTimes time_frames(const StereoPair& pair, const std::optional<StereoRig>& rig, const Config& config,
                       const Exec& exec, const Limits& limits, std::span<const OpenCvMatcher> matchers = {});

}  // namespace cairn::report
