// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/core/error.hpp>
#include <cairn/core/parallel.hpp>
#include <cairn/stereo/disparity_map.hpp>
#include <cairn/stereo/disparity_map_kernels.hpp>
#include <cassert>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

namespace cairn {
namespace {

constexpr float kHole = std::numeric_limits<float>::quiet_NaN();

/// Whether there is a finite value. Throws if one is out of bounds.
bool has_values(View<const float> disparity_px) {
  bool any = false;
  for (int y = 0; y < disparity_px.height(); ++y) {
    for (int x = 0; x < disparity_px.width(); ++x) {
      const float d = disparity_px(x, y);
      if (!std::isfinite(d)) continue;
      any = true;
      if (std::abs(d) > kMaxDisparity) {
        throw Error("external disparity: " + std::to_string(d) + " px at (" + std::to_string(x) + ", " +
                    std::to_string(y) + "), expected at most ±" +
                    std::to_string(static_cast<int>(kMaxDisparity)) +
                    " px; is it a depth map, or in 1/16 or 1/256 px?");
      }
    }
  }
  return any;
}

DisparityMap marked(View<const float> disparity_px, const Exec& exec) {
  const Size size = disparity_px.size();
  DisparityMap map{Image<float>(size, exec.pool), Image<Reject>(size, exec.pool)};
  parallel_for(exec, size.height, 64, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      const float* const in = disparity_px.row(y);
      for (int x = 0; x < size.width; ++x) {
        const bool known = std::isfinite(in[x]);
        map.disparity_px(x, y) = known ? in[x] : kHole;
        map.reject(x, y) = known ? Reject::none : Reject::no_data;
      }
    }
  });
  return map;
}

}  // namespace

DisparityMap combine(Image<float> refined_px, const std::vector<View<const Reject>>& verdicts,
                     const Exec& exec) {
  DisparityMap map{std::move(refined_px), {}};
  const Size size = map.disparity_px.size();
  map.reject = Image<Reject>(size, exec.pool);
  const kernels::DisparityMapKernels& run = kernels::disparity_map_kernels(exec);
  parallel_for(exec, size.height, 64, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      float* const d = map.disparity_px.row(y);
      Reject* const reject = map.reject.row(y);
      run.mark_holes(d, size.width, reject);
      for (const auto& verdict : verdicts) {
        assert(verdict.size() == size);
        run.add_reasons(verdict.row(y), size.width, reject);
      }
      run.punch_holes(reject, size.width, d);
    }
  });
  return map;
}

DisparityMap external_disparity(View<const float> disparity_px, const Exec& exec) {
  if (disparity_px.empty())
    throw Error("external disparity: found an empty map, expected at least 1x1 pixels");
  if (!has_values(disparity_px))
    throw Error("external disparity: found no value in " + text(disparity_px.size()) + " pixels");
  return marked(disparity_px, exec);
}

DisparityMap with_holes_marked(View<const float> disparity_px, const Exec& exec) {
  (void)has_values(disparity_px);
  return marked(disparity_px, exec);
}

Image<float> disparity_of_depth(View<const float> depth_m, const StereoRig& rig, const Pool& pool) {
  Image<float> disparity_px(depth_m.size(), pool);
  const float focal_baseline = rig.focal_px * rig.baseline_m;
  for (int y = 0; y < depth_m.height(); ++y) {
    std::transform(depth_m.row(y), depth_m.row(y) + depth_m.width(), disparity_px.row(y), [&](float z) {
      const float d = focal_baseline / z - rig.doffs_px;
      return z > 0 && std::isfinite(z) && std::abs(d) <= kMaxDisparity ? d : kHole;
    });
  }
  return disparity_px;
}

}  // namespace cairn
