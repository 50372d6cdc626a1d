// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/core/error.hpp>

#include <cairn/timing/opencv_matchers.hpp>

namespace cairn::timing {

// Never called, since there is no matcher.
void ReadyMatcher::compute(const StereoPair&) const {
  throw Error("OpenCV's matchers are not built in");
}
Image<float> ReadyMatcher::disparity_px() const {
  throw Error("OpenCV's matchers are not built in");
}

std::span<const OpenCvMatcher> quick_opencv_matchers() {
  return {};
}
std::string_view opencv_version() {
  return {};
}
void set_opencv_threads(int) {}

}  // namespace cairn::timing
