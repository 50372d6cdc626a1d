// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// No include guard: compiled once for each target.
namespace cairn::kernels::CAIRN_KERNEL_TARGET {
namespace {

/// The number of points for which judge(points, i, the plane's disparity there) holds.
template <class Judge>
inline int count_where(const PointArrays& points, const GroundPlane& plane, Judge judge) {
  const GroundPlane p = plane;
  const PointArrays at = points;
  int count = 0;
  for (int i = 0; i < at.count; ++i) count += judge(at, i, p.a * at.x[i] + p.b * at.y[i] + p.c) ? 1 : 0;
  return count;
}

inline int count_on(const PointArrays& points, const GroundPlane& plane, float tolerance) {
  return count_where(points, plane, [tolerance](const PointArrays& at, int i, float d) {
    return std::abs(at.d[i] - d) < tolerance;
  });
}

inline int count_beyond(const PointArrays& points, const GroundPlane& plane, float tolerance) {
  return count_where(points, plane, [tolerance](const PointArrays& at, int i, float d) {
    const float back = at.behind[i] < d ? d : at.behind[i];
    return at.d[i] - back < -tolerance;
  });
}

inline int count_on_before(const PointArrays& points, const GroundPlane& plane, float tolerance) {
  return count_where(points, plane, [tolerance](const PointArrays& at, int i, float d) {
    return (d > at.behind[i]) & (std::abs(at.d[i] - d) < tolerance);
  });
}

inline PlaneSums sum_on(const PointArrays& points, const GroundPlane& plane, float tolerance,
                        float* CAIRN_RESTRICT d_on) {
  const GroundPlane p = plane;
  const PointArrays at = points;
  PlaneSums sums;
  for (int i = 0; i < at.count; ++i) {
    const bool on = std::abs(at.d[i] - (p.a * at.x[i] + p.b * at.y[i] + p.c)) < tolerance;
    const auto x = static_cast<std::uint32_t>(on ? static_cast<std::int32_t>(at.x[i]) : 0);
    const auto y = static_cast<std::uint32_t>(on ? static_cast<std::int32_t>(at.y[i]) : 0);
    d_on[i] = on ? at.d[i] : 0.0F;
    sums.count += on ? 1 : 0;
    sums.x += x;
    sums.y += y;
    sums.xx += std::uint64_t{x} * x;
    sums.xy += std::uint64_t{x} * y;
    sums.yy += std::uint64_t{y} * y;
  }
  return sums;
}

inline void put_behind(const PointArrays& points, const GroundPlane& plane, float* CAIRN_RESTRICT behind) {
  const GroundPlane p = plane;
  const PointArrays at = points;
  for (int i = 0; i < at.count; ++i) {
    const float d = p.a * at.x[i] + p.b * at.y[i] + p.c;
    behind[i] = behind[i] < d ? d : behind[i];
  }
}

inline void mark_between(const PointArrays& points, const GroundPlane& plane, float least, float most,
                         std::uint8_t* CAIRN_RESTRICT marks) {
  const GroundPlane p = plane;
  const PointArrays at = points;
  for (int i = 0; i < at.count; ++i) {
    const float above = at.d[i] - (p.a * at.x[i] + p.b * at.y[i] + p.c);
    marks[i] = static_cast<std::uint8_t>((above >= least) & (above <= most));
  }
}

inline PlaneCounts count_about(const PointArrays& points, const GroundPlane& plane, float infinity,
                               float tolerance) {
  const GroundPlane p = plane;
  const PointArrays at = points;
  PlaneCounts counts;
  for (int i = 0; i < at.count; ++i) {
    const float floor = p.a * at.x[i] + p.b * at.y[i] + p.c;
    const float above = at.d[i] - floor;
    const float distance = std::abs(above);
    const int visible = floor + infinity > 0 ? 1 : 0;
    counts.all += visible;
    counts.on += distance <= tolerance ? visible : 0;
    counts.near += distance <= 2 * tolerance ? visible : 0;
    counts.below += above < -2 * tolerance ? visible : 0;
  }
  return counts;
}

inline PlaneCounts count_support(const float* disparity_px, int y, int width, const GroundPlane& plane,
                                 float infinity, float tolerance) {
  const GroundPlane p = plane;
  PlaneCounts counts;
  for (int x = 0; x < width; ++x) {
    const float floor = p.a * static_cast<float>(x) + p.b * static_cast<float>(y) + p.c;
    const float distance = std::abs(disparity_px[x] - floor);  // NaN for a hole, which fails every comparison
    const int visible = floor + infinity > 0 ? 1 : 0;
    counts.all += distance >= 0 ? visible : 0;
    counts.on += distance <= tolerance ? visible : 0;
  }
  return counts;
}

inline constexpr PlaneKernels kPlaneKernels{count_on,   count_beyond, count_on_before, sum_on,
                                            put_behind, mark_between, count_about,     count_support};

}  // namespace
}  // namespace cairn::kernels::CAIRN_KERNEL_TARGET
