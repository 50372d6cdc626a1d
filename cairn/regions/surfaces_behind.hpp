// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cairn/regions/cue_kernels.hpp>
#include <cairn/regions/region_cues.hpp>
#include <vector>

namespace cairn {

/// The disparities of ground and background in one row, in px, limited to 0 … kMaxDisparity; 0 without one.
/// Private to the library.
class SurfacesBehind {
 public:
  SurfacesBehind(const Cues& cues, int width, const Exec& exec);
  void note(int y);  // the row whose disparities follow
  std::vector<float> ground, background;

 private:
  const Cues& cues_;
  const kernels::CueKernels& run_;
};

}  // namespace cairn
