// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/image.hpp>

namespace cairn {

/// How many pixels an edge takes from dark to bright.
struct Sharpness {
  static constexpr int kLeastEdges = 50;  // fewer leave edge_px 0
  int edges = 0;                          // that were measured
  float edge_px = 0;                      // a quarter of them are narrower
};

/// Along the rows, every monotonic run of pixels that gains or loses a quarter of the image's contrast, and
/// at least 12 grey levels, is an edge; its width is the whole step over the steepest one between neighbours:
/// 1 for a step, 2.5 times the deviation of a Gaussian blur. Sharp pictures have soft shadows as well, so the
/// sharpest quarter counts. 0 where there are fewer than 50 edges.
Sharpness measure_sharpness(View<const Gray> image, float contrast);

}  // namespace cairn
