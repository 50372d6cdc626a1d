// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/image.hpp>
#include <cairn/core/stereo_pair.hpp>
#include <memory>
#include <span>
#include <string_view>
#include <utility>

/// OpenCV's matchers, for comparison in the same run. A build without them has opencv_matchers_none.cpp
/// instead: no matcher, no version.
namespace cairn::timing {

/// A matcher for the frames of one camera: keeps its buffers between frames, like Segmenter.
class ReadyMatcher {
 public:
  struct State;
  explicit ReadyMatcher(std::shared_ptr<State> state) : state_(std::move(state)) {}
  /// OpenCV's own call only, for timing. Throws Error if OpenCV refuses the pair.
  void compute(const StereoPair& pair) const;
  /// The result of the last compute(); px, NaN = hole.
  [[nodiscard]] Image<float> disparity_px() const;

 private:
  std::shared_ptr<State> state_;
};

struct SearchRange {
  int min_disparity = 0;
  int num_disparities = 64;
};

/// The number of disparities that OpenCV searches: a multiple of 16.
constexpr int searched_by_opencv(int num_disparities) {
  constexpr int kStep = 16;
  return (num_disparities + kStep - 1) / kStep * kStep;
}

struct OpenCvMatcher {
  std::string_view name;
  std::string_view settings;
  ReadyMatcher (*prepare)(const SearchRange& range);
};

/// Fast enough to run on every frame: StereoBM, StereoSGBM 3-way, StereoSGBM.
std::span<const OpenCvMatcher> quick_opencv_matchers();

/// Empty in a build without OpenCV's matchers.
std::string_view opencv_version();
/// Sets the global number of OpenCV threads: call once, before timing.
void set_opencv_threads(int threads);

}  // namespace cairn::timing
