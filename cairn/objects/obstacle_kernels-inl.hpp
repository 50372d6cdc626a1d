// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// No include guard: compiled once for each target.
namespace cairn::kernels::CAIRN_KERNEL_TARGET {
namespace {

inline void look_behind(const Backdrop& backdrop, int y, int width, const BackdropRow& out) {
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  float* CAIRN_RESTRICT const free_floor = out.free_floor;
  float* CAIRN_RESTRICT const wall = out.wall;
  float* CAIRN_RESTRICT const barrier = out.barrier;
  const auto row = static_cast<float>(y);
  for (int x = 0; x < width; ++x) wall[x] = -std::numeric_limits<float>::infinity();
  for (const GroundPlane& plane : backdrop.walls) {
    const GroundPlane p = plane;
    for (int x = 0; x < width; ++x) {
      const float d = p.a * static_cast<float>(x) + p.b * row + p.c;
      wall[x] = wall[x] < d ? d : wall[x];
    }
  }
  const float farthest = -backdrop.infinity_px;
  if (backdrop.floor) {
    const GroundPlane p = *backdrop.floor;
    for (int x = 0; x < width; ++x) {
      const float d = p.a * static_cast<float>(x) + p.b * row + p.c;
      const bool below_horizon = d - farthest > 0;
      free_floor[x] = below_horizon & (d >= wall[x]) ? d : kNone;
      barrier[x] = below_horizon ? d : farthest;
    }
  } else {
    for (int x = 0; x < width; ++x) {
      free_floor[x] = kNone;
      barrier[x] = wall[x] > farthest ? wall[x] : farthest;
    }
  }
}

inline void sum_floor(const float* surface_disparity_px, const float* free_floor_px, float margin, int width,
                      std::uint64_t* CAIRN_RESTRICT up_to) {
  for (int x = 0; x < width; ++x) {
    const float seen = surface_disparity_px[x];
    const std::uint64_t known = seen == seen ? std::uint64_t{1} << 32U : 0;
    const std::uint64_t on_floor = std::abs(seen - free_floor_px[x]) <= margin ? 1 : 0;
    up_to[x + 1] = known + on_floor;
  }
  // A sum waits for each addition, so it is not vectorised.
  up_to[0] = 0;
  for (int x = 0; x < width; ++x) up_to[x + 1] += up_to[x];
}

inline void label(const SpaceRow& given, float margin, int width, ObstacleLabel* CAIRN_RESTRICT out) {
  constexpr float kRatherRight = 0.5F;
  const SpaceRow row = given;
  for (int x = 0; x < width; ++x) {
    const float floor = row.free_floor[x];
    // A hole in a superpixel of floor is floor; a pixel with a disparity off the floor is not.
    const float seen = row.seen[x] == row.seen[x] ? row.seen[x] : floor;
    const bool is_floor = (row.in_floor[x] != 0) & (std::abs(seen - floor) <= margin);
    const bool is_in_front =
        (row.disparity[x] - row.barrier[x] > margin) & (row.confidence[x] >= kRatherRight);
    const ObstacleLabel alone = is_floor      ? ObstacleLabel::floor
                                : is_in_front ? ObstacleLabel::obstacle
                                              : ObstacleLabel::unknown;
    out[x] = row.object[x] != ObjectId::none ? ObstacleLabel::obstacle : alone;
  }
}

inline constexpr ObstacleKernels kSpaceKernels{look_behind, sum_floor, label};

}  // namespace
}  // namespace cairn::kernels::CAIRN_KERNEL_TARGET
