// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// No include guard: compiled once for each target.
namespace cairn::kernels::CAIRN_KERNEL_TARGET {
namespace {

inline void nearest_plane(std::span<const GroundPlane> planes, int y, int width, float* CAIRN_RESTRICT out) {
  std::fill_n(out, width, 0.0F);
  const auto fy = static_cast<float>(y);
  for (const GroundPlane& plane : planes) {
    const float a = plane.a;
    const float c = plane.c;
    const float by = plane.b * fy;
    for (int x = 0; x < width; ++x) {
      const float d = a * static_cast<float>(x) + by + c;
      out[x] = out[x] < d ? d : out[x];
    }
  }
  for (int x = 0; x < width; ++x) out[x] = kMaxDisparity < out[x] ? kMaxDisparity : out[x];
}

inline void in_steps(const float* disparity_px, float above, int width, std::int32_t* CAIRN_RESTRICT out) {
  // For positive numbers truncation is faster than floor(), and exact in doubles.
  constexpr int kPositive = 1 << 20;
  for (int x = 0; x < width; ++x) {
    const float d = disparity_px[x];
    const bool is_one = d > above;  // false for NaN
    const double steps = double{is_one ? d : 0.0F} * kDisparitySteps + (0.5 + kPositive);
    const std::int32_t rounded = static_cast<std::int32_t>(steps) - kPositive;
    out[x] = is_one ? rounded : kNoDisparity;
  }
}

/// −1 for a disparity, 0 for a hole. Without branches, because valid disparities are unpredictable.
inline std::int32_t mask_of(std::int32_t steps) {
  return -static_cast<std::int32_t>(steps != kNoDisparity);
}

inline void sum_moments(const std::int32_t* steps, int x, int count, RunMoments& sums) {
  std::int64_t n = 0, of_x = 0, xx = 0, d = 0, xd = 0, dd = 0;
  for (int i = 0; i < count; ++i) {
    const std::int32_t mask = mask_of(steps[i]);
    const std::int32_t at_x = (x + i) & mask;
    const std::int32_t at_d = steps[i] & mask;
    n -= mask;
    of_x += at_x;
    xx += std::int64_t{at_x} * at_x;
    d += at_d;
    xd += std::int64_t{at_x} * at_d;
    dd += std::int64_t{at_d} * at_d;
  }
  sums = {n, of_x, xx, d, xd, dd};
}

inline void sum_heights(const std::int32_t* steps, const std::int32_t* textured, const std::int32_t* behind,
                        int count, RunHeights& all, RunHeights& of_textured) {
  constexpr std::int32_t kLeast = clamped_height(kNoDisparity), kMost = clamped_height(-(kNoDisparity + 1));
  RunHeights sums;
  RunHeights textured_sums;
  for (int i = 0; i < count; ++i) {
    const std::int32_t known = mask_of(steps[i]) & mask_of(behind[i]);
    const std::int32_t height = std::min(std::max((steps[i] & known) - (behind[i] & known), kLeast), kMost);
    const std::int32_t square = height * height;
    const std::int32_t farther = -static_cast<std::int32_t>(height < -kDisparitySteps);
    const std::int32_t on = known & -static_cast<std::int32_t>(std::abs(height) <= kDisparitySteps);
    // The textured disparities are a subset of all disparities.
    const std::int32_t mask = mask_of(textured[i]);
    sums.n -= known;
    sums.sum += height;
    sums.squares += square;
    sums.behind -= farther;
    sums.on -= on;
    textured_sums.n -= known & mask;
    textured_sums.sum += height & mask;
    textured_sums.squares += square & mask;
    textured_sums.behind -= farther & mask;
    textured_sums.on -= on & mask;
  }
  all = sums;
  of_textured = textured_sums;
}

inline void take_planes(const float* disparity_px, int y, int first, int last, const SuperpixelPlanes& planes,
                        float least, float most, float* CAIRN_RESTRICT refined_px,
                        std::int32_t* CAIRN_RESTRICT group) {
  const GroundPlane main = planes.main, second = planes.second;
  const auto [of_main, of_second, of_nearer, of_farther, of_holes] = planes.chosen;
  const auto fy = static_cast<float>(y);
  const float* const matched = disparity_px + first;
  for (int i = 0; i < last - first; ++i) {
    const auto fx = static_cast<float>(first + i);
    const float d = matched[i];
    const float before = d - (main.a * fx + main.b * fy + main.c);
    const float before_second = d - (second.a * fx + second.b * fy + second.c);
    const bool is_farther = before < 0;
    const bool is_on_second = std::abs(before_second) <= kNearPlane;
    const bool is_on_main = std::abs(before) <= kNearPlane;
    const bool is_hole = d != d;
    const auto of_group = [&](auto at_main, auto at_second, auto near, auto far, auto hole) {
      auto value = is_farther ? far : near;
      value = is_on_second ? at_second : value;
      value = is_on_main ? at_main : value;
      return is_hole ? hole : value;
    };
    const float a = of_group(of_main.a, of_second.a, of_nearer.a, of_farther.a, of_holes.a);
    const float b = of_group(of_main.b, of_second.b, of_nearer.b, of_farther.b, of_holes.b);
    const float c = of_group(of_main.c, of_second.c, of_nearer.c, of_farther.c, of_holes.c);
    group[i] = of_group(std::int32_t{on_main}, std::int32_t{on_second}, std::int32_t{nearer},
                        std::int32_t{farther}, std::int32_t{holes});
    const float on = a * fx + b * fy + c;
    const float kept = std::abs(d - on) <= kOnPlane ? d : on;
    const float refined = on == on ? kept : d;
    const float limited = refined < least ? least : refined;
    refined_px[i] = limited > most ? most : limited;
  }
}

inline void add_steps(const std::uint16_t* edges, const StepRows& rows, int width, const StepSum& by,
                      std::uint16_t* CAIRN_RESTRICT out) {
  const auto [up, here, down] = rows;
  const auto [weight, largest, least] = by;
  const auto sum = [edges, up = up, here = here, down = down, weight = weight, largest = largest,
                    least = least](int x, int left, int right) {
    const float d = here[x];
    const auto larger = [d](float step, float other) {
      const float to = std::abs(other - d);
      return to > step ? to : step;  // false for NaN
    };
    float step = larger(larger(larger(larger(0.0F, here[left]), here[right]), up[x]), down[x]);
    step = largest < step ? largest : step;
    const int edge = edges[x] + static_cast<int>(step * weight + 0.5F);
    return static_cast<std::uint16_t>(edge < least ? 0 : edge);
  };
  const int end = width - 1;
  out[0] = sum(0, 0, std::min(1, end));
  for (int x = 1; x < end; ++x) out[x] = sum(x, x - 1, x + 1);
  out[end] = sum(end, std::max(end - 1, 0), end);
}

inline void halve(const std::uint16_t* upper, const std::uint16_t* lower, int width,
                  std::uint16_t* CAIRN_RESTRICT out) {
  for (int x = 0; x < width / 2; ++x) {
    const int sum = upper[2 * x] + upper[2 * x + 1] + lower[2 * x] + lower[2 * x + 1];
    out[x] = static_cast<std::uint16_t>((sum + 2) >> 2);
  }
  if (width % 2 != 0)
    out[width / 2] = static_cast<std::uint16_t>((upper[width - 1] + lower[width - 1] + 1) >> 1);
}

inline void sum_trees(const FittedTrees::Split* splits, const float* leaves, std::size_t depth,
                      std::size_t count, const float* features, float* CAIRN_RESTRICT sums) {
  using Lanes = float[kTreeLanes];
  const std::size_t size = std::size_t{1} << depth;
  // From the leaves up, each split takes the value of the branch that a sample follows: no sample waits for
  // the previous split, and all splits of a tree take less time than one path per sample.
  Lanes values[std::size_t{1} << kDeepestTree];
  for (std::size_t tree = 0; tree < count; ++tree, splits += size, leaves += size) {
    for (std::size_t place = size - 1; place >= size / 2; --place) {
      const float* const feature = features + slot(splits[place].feature) * kTreeLanes;
      const float value = splits[place].value;
      const float below = leaves[2 * place - size];
      const float above = leaves[2 * place + 1 - size];
      for (std::size_t i = 0; i < kTreeLanes; ++i) values[place][i] = feature[i] < value ? below : above;
    }
    for (std::size_t place = size / 2 - 1; place > 0; --place) {
      const float* const feature = features + slot(splits[place].feature) * kTreeLanes;
      const float value = splits[place].value;
      for (std::size_t i = 0; i < kTreeLanes; ++i) {
        const float below = values[2 * place][i];
        const float above = values[2 * place + 1][i];
        values[place][i] = feature[i] < value ? below : above;
      }
    }
    for (std::size_t i = 0; i < kTreeLanes; ++i) sums[i] += values[1][i];
  }
}

inline constexpr CueKernels kCueKernels{nearest_plane, in_steps,  sum_moments, sum_heights,
                                        take_planes,   add_steps, halve,       sum_trees};

}  // namespace
}  // namespace cairn::kernels::CAIRN_KERNEL_TARGET
