// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// No include guard: compiled once for each target.
namespace cairn::kernels::CAIRN_KERNEL_TARGET {
namespace {

inline void mark_holes(const float* disparity_px, int width, Reject* CAIRN_RESTRICT reject) {
  for (int x = 0; x < width; ++x)
    reject[x] = disparity_px[x] == disparity_px[x] ? Reject::none : Reject::border;  // a hole is NaN
}

inline void add_reasons(const Reject* more, int width, Reject* CAIRN_RESTRICT reject) {
  for (int x = 0; x < width; ++x) reject[x] |= more[x];
}

inline void punch_holes(const Reject* reject, int width, float* CAIRN_RESTRICT disparity_px) {
  constexpr float kHole = std::numeric_limits<float>::quiet_NaN();
  for (int x = 0; x < width; ++x) disparity_px[x] = reject[x] == Reject::none ? disparity_px[x] : kHole;
}

inline void reject_where(const std::uint8_t* mask, int width, Reject why, Reject* CAIRN_RESTRICT verdict) {
  for (int x = 0; x < width; ++x) verdict[x] = mask[x] != 0 ? why : Reject::none;
}

inline constexpr DisparityMapKernels kDisparityMapKernels{mark_holes, add_reasons, punch_holes, reject_where};

}  // namespace
}  // namespace cairn::kernels::CAIRN_KERNEL_TARGET
