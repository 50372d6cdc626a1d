// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cairn/core/image.hpp>
#include <cairn/core/stereo_pair.hpp>
#include <string_view>

/// OpenCV's matchers, to stand beside ours in the same run.
namespace cairn::report {

struct OpenCvMatcher {
  std::string_view name;
  std::string_view settings;
  Image<float> (*match)(const StereoPair& pair, int num_disparities);  // px; NaN = hole
};

extern const std::array<OpenCvMatcher, 3> kOpenCvMatchers;

std::string_view opencv_version();
/// OpenCV keeps its threads in a global: set once, before anything is timed.
void use_one_opencv_thread();

}  // namespace cairn::report
