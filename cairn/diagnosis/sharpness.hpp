// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/image.hpp>

namespace cairn {

/// The width of edges from dark to bright, in pixels.
struct Sharpness {
  static constexpr int kMinEdges = 50;  // fewer leave edge_px 0
  int edges = 0;                        // edges measured
  float edge_px = 0;                    // lower quartile of their widths
};

/// An edge is a monotonic run of pixels along a row that spans a quarter of the image contrast and at least
/// 12 grey levels. Its width is the whole step divided by the steepest step between neighbours: 1 for a step,
/// 2.5 σ for a Gaussian blur of σ. Sharp images have soft shadows too, hence the lower quartile. 0 with fewer
/// than 50 edges.
Sharpness measure_sharpness(View<const Gray> image, float contrast);

}  // namespace cairn
