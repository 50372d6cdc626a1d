// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// No include guard: compiled once for each target.
namespace cairn::kernels::CAIRN_KERNEL_TARGET {
namespace {

inline void find_below(const FloorRow& given, int y, int width, const float* disparity_px,
                       float* CAIRN_RESTRICT below_px, float* CAIRN_RESTRICT little_below_px) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const FloorRow row = given;
  const GroundPlane p = row.plane;
  for (int x = 0; x < width; ++x) {
    const float floor = p.a * static_cast<float>(x) + p.b * static_cast<float>(y) + p.c;
    const float d = disparity_px[x];
    const bool below = (floor + row.infinity > 0) & (d < floor - row.margin);
    const bool little = below & (2 * (d + row.infinity) > floor + row.infinity);
    below_px[x] = below ? d : kNan;
    little_below_px[x] = little ? d - floor : kNan;
  }
}

inline void reject_marked(const Reject* marks, const float* level_px, int width,
                          float* CAIRN_RESTRICT disparity_px, Reject* CAIRN_RESTRICT reject) {
  for (int x = 0; x < width; ++x) {
    const bool marked = (marks[x] != Reject::none) & std::isnan(level_px[x]);
    disparity_px[x] = marked ? std::numeric_limits<float>::quiet_NaN() : disparity_px[x];
    reject[x] |= marked ? Reject::below_ground : Reject::none;
  }
}

inline void label_floor(const FloorRow& given, int y, int width, const float* disparity_px,
                        std::uint8_t* CAIRN_RESTRICT label) {
  const FloorRow row = given;
  const GroundPlane p = row.plane;
  for (int x = 0; x < width; ++x) {
    const float floor = p.a * static_cast<float>(x) + p.b * static_cast<float>(y) + p.c;
    const bool on = (floor + row.infinity > 0) & (std::abs(disparity_px[x] - floor) <= row.margin);
    label[x] = on ? std::uint8_t{255} : std::uint8_t{0};
  }
}

inline constexpr FloorKernels kFloorKernels{find_below, reject_marked, label_floor};

}  // namespace
}  // namespace cairn::kernels::CAIRN_KERNEL_TARGET
