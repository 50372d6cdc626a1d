// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/core/robust_fit.hpp>
#include <cairn/diagnosis/sharpness.hpp>
#include <cstdlib>
#include <vector>

namespace cairn {
namespace {

constexpr int kMinStep = 12;
constexpr float kMinShare = 0.25F;  // of the image's contrast

/// Adds the widths of a row's edges.
void measure_row(const Gray* row, int width, int least, std::vector<double>& widths) {
  int x = 0;
  while (x + 1 < width) {
    const int sign = row[x + 1] > row[x] ? 1 : -1;
    int steepest = 0;
    const int first = x;
    while (x + 1 < width && sign * (row[x + 1] - row[x]) > 0) {
      steepest = std::max(steepest, std::abs(row[x + 1] - row[x]));
      ++x;
    }
    const int step = std::abs(row[x] - row[first]);
    if (steepest > 0 && step >= least) widths.push_back(static_cast<double>(step) / steepest);
    if (x == first) ++x;
  }
}

}  // namespace

Sharpness measure_sharpness(View<const Gray> image, float contrast) {
  const int least = std::max(kMinStep, static_cast<int>(kMinShare * contrast));
  std::vector<double> widths;
  for (int y = 0; y < image.height(); ++y) measure_row(image.row(y), image.width(), least, widths);
  Sharpness result;
  result.edges = static_cast<int>(widths.size());
  if (widths.size() >= Sharpness::kMinEdges) result.edge_px = static_cast<float>(quantile(widths, 0.25));
  return result;
}

}  // namespace cairn
