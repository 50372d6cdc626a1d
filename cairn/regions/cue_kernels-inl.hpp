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

inline constexpr CueKernels kCueKernels{nearest_plane, in_steps, add_steps, halve, sum_trees};

}  // namespace
}  // namespace cairn::kernels::CAIRN_KERNEL_TARGET
