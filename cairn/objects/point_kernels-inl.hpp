// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// No include guard: compiled once for each target.
namespace cairn::kernels::CAIRN_KERNEL_TARGET {
namespace {

inline void points_in_camera(const StereoRig& given, int y, int first, int last, const float* disparity_px,
                             float* CAIRN_RESTRICT x_m, float* CAIRN_RESTRICT y_m,
                             float* CAIRN_RESTRICT z_m) {
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  constexpr float kFarthest = std::numeric_limits<float>::max();
  const StereoRig rig = given;
  const float row = static_cast<float>(y) - rig.cy_px;
  for (int x = first; x < last; ++x) {
    const float before_infinity = disparity_px[x] + rig.doffs_px;
    const float z = rig.focal_px * rig.baseline_m / before_infinity;
    const bool seen = (before_infinity > 0) & (z <= kFarthest);
    x_m[x] = seen ? (static_cast<float>(x) - rig.cx_px) * z / rig.focal_px : kNone;
    y_m[x] = seen ? row * z / rig.focal_px : kNone;
    z_m[x] = seen ? z : kNone;
  }
}

inline constexpr PointKernels kPointKernels{points_in_camera};

}  // namespace
}  // namespace cairn::kernels::CAIRN_KERNEL_TARGET
