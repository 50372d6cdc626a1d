// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// No include guard: compiled once for each target.
namespace cairn::kernels::CAIRN_KERNEL_TARGET {
namespace {

inline int points_in_camera(const StereoRig& given, Point first, int count, const float* disparity_px,
                            float farthest_m, const PointLists& out) {
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  constexpr float kMaxDistance = std::numeric_limits<float>::max();
  const StereoRig rig = given;
  float* CAIRN_RESTRICT const x_m = out.x;
  float* CAIRN_RESTRICT const y_m = out.y;
  float* CAIRN_RESTRICT const z_m = out.z;
  const float row = static_cast<float>(first.y) - rig.cy_px;
  int near = 0;
  for (int i = 0; i < count; ++i) {
    const float before_infinity = disparity_px[i] + rig.doffs_px;
    const float z = rig.focal_px * rig.baseline_m / before_infinity;
    const bool seen = (before_infinity > 0) & (z <= kMaxDistance);
    const float x = (static_cast<float>(first.x + i) - rig.cx_px) * z / rig.focal_px;
    const float y = row * z / rig.focal_px;
    x_m[i] = seen ? x : kNone;
    y_m[i] = seen ? y : kNone;
    z_m[i] = seen ? z : kNone;
    near += seen & (std::abs(x) <= farthest_m) & (std::abs(y) <= farthest_m) & (std::abs(z) <= farthest_m)
                ? 1
                : 0;
  }
  return near;
}

inline void points_in_floor(const FloorFrame& floor, const PointLists& in_camera, int count,
                            const PointLists& out) {
  const auto project = [&](Vec3 axis, double from, float* CAIRN_RESTRICT to) {
    for (int i = 0; i < count; ++i) {
      const double along =
          double{axis.x} * in_camera.x[i] + double{axis.y} * in_camera.y[i] + double{axis.z} * in_camera.z[i];
      to[i] = static_cast<float>(along + from);
    }
  };
  constexpr double kNothing = -0.0;  // 0.0 would change −0.0
  project(floor.forward, kNothing, out.x);
  project(floor.left, kNothing, out.y);
  project(floor.up, double{floor.camera_height_m}, out.z);
}

inline void turn(const float* xs, const float* ys, int count, float cosine, float sine,
                 float* CAIRN_RESTRICT turned_xs, float* CAIRN_RESTRICT turned_ys) {
  for (int i = 0; i < count; ++i) {
    turned_xs[i] = cosine * xs[i] + sine * ys[i];
    turned_ys[i] = cosine * ys[i] - sine * xs[i];
  }
}

inline void find_sides(const float* xs, const float* ys, int count, std::size_t low_tail,
                       std::size_t high_tail, TurnedRectangles& rectangles) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  using Values = TurnedRectangles::Each<float>;
  const Values cosine = rectangles.cosine;
  const Values sine = rectangles.sine;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    std::array<Values, TurnedRectangles::kMaxTail> lowest;  // in order
    std::array<Values, TurnedRectangles::kMaxTail> highest;
    for (Values& values : lowest) values.fill(kInfinity);
    for (Values& values : highest) values.fill(-kInfinity);
    for (int i = 0; i < count; ++i) {
      const float along = axis == 0 ? xs[i] : ys[i];
      const float across = axis == 0 ? ys[i] : -xs[i];
      for (std::size_t k = 0; k < TurnedRectangles::kCount; ++k) {
        // A value beyond the current one replaces it and moves it on: branch-free, so vectors process all
        // yaws.
        const float turned = cosine[k] * along + sine[k] * across;
        float low = turned;
        float high = turned;
        for (std::size_t j = 0; j < TurnedRectangles::kMaxTail; ++j) {
          const float lower = lowest[j][k];
          lowest[j][k] = low < lower ? low : lower;
          low = low > lower ? low : lower;
          const float higher = highest[j][k];
          highest[j][k] = high > higher ? high : higher;
          high = high < higher ? high : higher;
        }
      }
    }
    rectangles.low[axis] = lowest[low_tail];
    rectangles.high[axis] = highest[high_tail];
  }
}

inline void sum_distances(const float* xs, const float* ys, int count, const TurnedRectangles& rectangles,
                          TurnedRectangles::Each<double>& sums) {
  const TurnedRectangles r = rectangles;
  TurnedRectangles::Each<double> all{};
  for (int i = 0; i < count; ++i) {
    const float x = xs[i];
    const float y = ys[i];
    for (std::size_t k = 0; k < TurnedRectangles::kCount; ++k) {
      const float u = r.cosine[k] * x + r.sine[k] * y;
      const float v = r.cosine[k] * y - r.sine[k] * x;
      const float left = std::abs(u - r.low[0][k]);
      const float right = std::abs(r.high[0][k] - u);
      const float below = std::abs(v - r.low[1][k]);
      const float above = std::abs(r.high[1][k] - v);
      const float along_x = right < left ? right : left;
      const float along_y = above < below ? above : below;
      all[k] += double{along_y < along_x ? along_y : along_x};
    }
  }
  sums = all;
}

inline constexpr PointKernels kPointKernels{points_in_camera, points_in_floor, turn, find_sides,
                                            sum_distances};

}  // namespace
}  // namespace cairn::kernels::CAIRN_KERNEL_TARGET
