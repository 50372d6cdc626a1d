// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/stereo/islands.hpp>
#include <cairn/stereo/speckle.hpp>
#include <cmath>
#include <limits>

namespace cairn {
namespace {

/// Connects valid disparities that differ by at most `range`. NaN is within no range.
struct DisparityRow {
  const float* d;
  float range;
  [[nodiscard]] bool is_pixel(int x) const { return d[x] == d[x]; }
  [[nodiscard]] bool follows(int x) const { return std::abs(d[x] - d[x - 1]) <= range; }
  [[nodiscard]] bool joins(const DisparityRow& above, int x) const {
    return std::abs(d[x] - above.d[x]) <= range;
  }
};

}  // namespace

DisparityMap reject_speckles(DisparityMap disparity, const SpeckleConfig& config, const Exec& exec) {
  if (config.size <= 0 || disparity.disparity_px.empty()) return disparity;
  const View<const float> disparity_px = disparity.disparity_px;
  const auto rows = [&](int y) { return DisparityRow{disparity_px.row(y), config.range}; };
  const Islands islands(disparity_px.size(), rows, exec);
  parallel_for(exec, disparity.disparity_px.height(), 64, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      islands.for_each_run(y, [&](std::int32_t island, int begin, int end) {
        if (islands.pixels(island) > config.size) return;
        for (int x = begin; x < end; ++x) {
          disparity.disparity_px(x, y) = std::numeric_limits<float>::quiet_NaN();
          disparity.reject(x, y) |= Reject::speckle;
        }
      });
    }
  });
  return disparity;
}

}  // namespace cairn
