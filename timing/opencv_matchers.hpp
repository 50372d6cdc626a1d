// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/image.hpp>
#include <cairn/core/stereo_pair.hpp>
#include <memory>
#include <span>
#include <string_view>
#include <utility>

/// OpenCV's matchers, to stand beside ours in the same run. A build without them has opencv_matchers_none.cpp
/// instead: no matcher, no version.
namespace cairn::report {

/// A matcher for the frames of one camera: it keeps its buffers from frame to frame, as ours does.
class ReadyMatcher {
 public:
  struct State;
  explicit ReadyMatcher(std::shared_ptr<State> state) : state_(std::move(state)) {}
  /// OpenCV's own call and nothing else, to be timed. Throws Error where OpenCV refuses the pair.
  void compute(const StereoPair& pair) const;
  /// What the last compute() found; px, NaN = hole.
  [[nodiscard]] Image<float> disparity_px() const;

 private:
  std::shared_ptr<State> state_;
};

struct SearchRange {
  int min_disparity = 0;
  int num_disparities = 64;  // OpenCV wants multiples of 16: rounded up
};

struct OpenCvMatcher {
  std::string_view name;
  std::string_view settings;
  ReadyMatcher (*prepare)(const SearchRange& range);
};

/// Those that are quick enough to run beside ours on every frame: StereoBM, StereoSGBM 3-way, StereoSGBM.
std::span<const OpenCvMatcher> quick_opencv_matchers();
/// Those whose accuracy is worth a row: StereoBM, StereoSGBM, StereoSGBM with 8 paths.
std::span<const OpenCvMatcher> accurate_opencv_matchers();

/// Empty where OpenCV's matchers are not built in.
std::string_view opencv_version();
/// OpenCV keeps its threads in a global: set once, before anything is timed.
void set_opencv_threads(int threads);

}  // namespace cairn::report
