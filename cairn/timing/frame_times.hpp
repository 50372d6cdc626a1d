// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/pipeline/segment.hpp>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <cairn/timing/opencv_matchers.hpp>

/// The time of the method, per stage and frame, next to that of other matchers.
namespace cairn::timing {

/// Milliseconds, one value per frame.
struct Samples {
  std::vector<double> wall_ms;
  std::vector<double> cpu_ms;  // of the whole process, all its threads
};

struct StageTimes {
  std::string name;            // as passed to the observer
  bool for_disparity = false;  // also a stage of estimate_disparity(): the work of a matcher
  Samples times;
};

struct PeerTimes {
  const OpenCvMatcher* matcher = nullptr;
  Samples times;
  std::string refusal;        // why OpenCV refuses this pair; no times then
  Image<float> disparity_px;  // NaN = hole
};

struct FrameTimes {
  double first_frame_ms = 0;       // wall: fills the pool and the caches
  std::vector<StageTimes> stages;  // in the order of the first frame
  Samples disparity;               // the sum of its stages
  Samples frame;
  std::int64_t pool_bytes = 0;         // peak size of the pool
  std::int64_t resident_bytes = 0;     // peak resident size after the first frame
  std::int64_t first_allocations = 0;  // image buffers from the heap, in the first frame …
  std::int64_t later_allocations = 0;  // … and in all later ones
  // With Segmenter::prefetch(): wall time of a frame in the mean of as many frames, and peak size of the pool; 0 with
  // one thread and no device, or for a single frame.
  double overlapping_ms = 0;
  std::int64_t overlapping_pool_bytes = 0;
  int objects = 0;
  Image<float> disparity_px;  // NaN = hole
  std::vector<PeerTimes> peers;

  [[nodiscard]] int frames() const { return static_cast<int>(frame.wall_ms.size()); }
};

/// The limits of the measurement: number of frames, and time, which applies from the third frame on.
struct Limits {
  int frames = std::numeric_limits<int>::max();
  double seconds = std::numeric_limits<double>::infinity();
};

/// Times the method on one pair repeatedly, and each matcher once after each frame, so that other load on the
/// machine affects all alike. The frames share a pool, whatever exec.pool is; exec.observe is not called.
/// Throws Error like segment().
FrameTimes time_frames(const StereoPair& pair, const std::optional<StereoRig>& rig, const Config& config,
                       const Exec& exec, const Limits& limits, std::span<const OpenCvMatcher> matchers = {});

}  // namespace cairn::timing
