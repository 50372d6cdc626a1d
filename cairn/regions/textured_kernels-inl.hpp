// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// No include guard: compiled once for each target.
namespace cairn::kernels::CAIRN_KERNEL_TARGET {
namespace {

inline void smooth_lightly(const std::uint8_t* up, const std::uint8_t* here, const std::uint8_t* down,
                           int width, std::int16_t* CAIRN_RESTRICT column, std::int16_t* CAIRN_RESTRICT out) {
  for (int x = 0; x < width; ++x) column[x + 1] = static_cast<std::int16_t>(up[x] + 6 * here[x] + down[x]);
  column[0] = column[1];
  column[width + 1] = column[width];
  for (int x = 0; x < width; ++x)
    out[x] = static_cast<std::int16_t>(column[x] + 6 * column[x + 1] + column[x + 2]);
}

inline void textured(const SmoothRows& smooth, const Reject* reject, const float* disparity_px, int width,
                     int least, float* CAIRN_RESTRICT out) {
  const auto tested = [up = smooth.up, here = smooth.here, down = smooth.down, reject, disparity_px, least](
                          int x, int left, int right) {
    const int across = std::abs(here[right] - here[left]);
    const int along = std::abs(down[x] - up[x]);
    const bool passes = (reject[x] == Reject::none) & (across > least) & (2 * across > along);
    return passes ? disparity_px[x] : std::numeric_limits<float>::quiet_NaN();
  };
  const int end = width - 1;
  out[0] = tested(0, 0, std::min(1, end));
  for (int x = 1; x < end; ++x) out[x] = tested(x, x - 1, x + 1);
  out[end] = tested(end, std::max(end - 1, 0), end);
}

inline void agreed(const float* const* rows, int width, float agreement, float* CAIRN_RESTRICT out) {
  const float* const r0 = rows[0];
  const float* const r1 = rows[1];
  const float* const r2 = rows[2];
  const float* const r3 = rows[3];
  const float* const r4 = rows[4];
  for (int x = 0; x < width; ++x) {
    const float d = r2[x];
    const auto near = [d, agreement](float other) { return std::abs(other - d) <= agreement ? 1 : 0; };
    const auto near_in = [x, near](const float* row) {
      return near(row[x - 2]) + near(row[x - 1]) + near(row[x]) + near(row[x + 1]) + near(row[x + 2]);
    };
    const int count = near_in(r0) + near_in(r1) + near_in(r2) + near_in(r3) + near_in(r4);
    out[x] = count > 3 ? d : std::numeric_limits<float>::quiet_NaN();  // count includes the pixel itself
  }
}

inline constexpr TexturedKernels kEvidenceKernels{smooth_lightly, textured, agreed};

}  // namespace
}  // namespace cairn::kernels::CAIRN_KERNEL_TARGET
