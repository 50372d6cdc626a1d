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

inline void in_steps_from_floor(const float* disparity_px, const float* confidence, int y,
                                const GroundPlane& floor, float margin, int width, const HeightsOut& out) {
  using Out = HeightsOut;
  const GroundPlane plane = floor;
  std::int32_t* CAIRN_RESTRICT const heights = out.height;
  std::int32_t* CAIRN_RESTRICT const marks = out.marks;
  for (int x = 0; x < width; ++x) {
    const float d = disparity_px[x];
    const float height = d - plane.disparity_px(static_cast<float>(x), static_cast<float>(y));
    const float least = height > Out::kLowest ? height : Out::kLowest;  // of NaN, too
    const float limited = least < Out::kHighest ? least : Out::kHighest;
    const float likely = confidence[x] > 0 ? confidence[x] : 0;
    const float share = likely < 1 ? likely : 1;
    const std::int32_t known = -static_cast<std::int32_t>(d == d);
    const std::int32_t on = std::abs(height) <= margin ? Out::kOn : 0;
    const std::int32_t front = height > margin ? Out::kFront : 0;
    heights[x] = static_cast<std::int32_t>((limited - Out::kLowest) * Out::kSteps + 0.5F) & known;
    marks[x] = (static_cast<std::int32_t>(share * Out::kSureSteps + 0.5F) | on | front | Out::kKnown) & known;
  }
}

inline void prefer_refined(const SeenPixels& matched, const float* refined, const float* refined_confidence,
                           float least, int width, const SeenPixelsOut& out) {
  const SeenPixels from = matched;
  const auto take = [=](const float* better, const float* other, float* CAIRN_RESTRICT to) {
    for (int x = 0; x < width; ++x) to[x] = refined_confidence[x] >= least ? better[x] : other[x];
  };
  take(refined, from.disparity, out.disparity);
  take(refined, from.surface, out.surface);
  take(refined_confidence, from.confidence, out.confidence);
}

inline void label(const SpaceRow& given, float margin, int width, ObstacleLabel* CAIRN_RESTRICT out) {
  constexpr float kRatherRight = 0.5F;
  const SpaceRow row = given;
  for (int x = 0; x < width; ++x) {
    const float likely = row.floor_probability[x];
    const bool is_judged = likely == likely;
    const bool is_on_floor = std::abs(row.surface[x] - row.free_floor[x]) <= margin;
    const bool is_in_front =
        (row.disparity[x] - row.barrier[x] > margin) & (row.confidence[x] >= kRatherRight);
    const bool is_floor = (likely >= kLikelyFloor) | (!is_judged & is_on_floor);
    const bool is_obstacle = (likely < kUnlikelyFloor) | (!is_judged & is_in_front);
    const ObstacleLabel alone = is_floor      ? ObstacleLabel::floor
                                : is_obstacle ? ObstacleLabel::obstacle
                                              : ObstacleLabel::unknown;
    out[x] = row.object[x] != ObjectId::none ? ObstacleLabel::obstacle : alone;
  }
}

inline void place(const PlacedRow& given, const GroundPlane& plane, int y, int width,
                  float* CAIRN_RESTRICT out) {
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  constexpr float kOff = 1;  // px
  const PlacedRow row = given;
  const GroundPlane floor = plane;
  const auto height_of_row = static_cast<float>(y);
  for (int x = 0; x < width; ++x) {
    const bool is_obstacle = row.label[x] == ObstacleLabel::obstacle;
    const bool is_floor = row.label[x] == ObstacleLabel::floor;
    const bool is_corrected = is_obstacle & (row.refined_confidence[x] >= kLikelyRefined);
    const float d = is_corrected ? row.refined[x] : row.matched[x];
    const float off = d - (floor.a * static_cast<float>(x) + floor.b * height_of_row + floor.c);
    const bool contradicts = (is_floor & (std::abs(off) > kOff)) |
                             (is_obstacle & (row.object[x] == ObjectId::none) & (off <= kOff));
    out[x] = contradicts ? kNone : d;
  }
}

inline void mark_kinds(const KindRow& given, float margin, int width, FloorKind* CAIRN_RESTRICT out) {
  const KindRow row = given;
  for (int x = 0; x < width; ++x) {
    const float seen = row.seen[x];
    const float floor = row.free_floor[x];
    const float off = seen - floor;
    const bool is_judged = (floor == floor) & (row.object[x] == ObjectId::none) &
                           ((row.reject[x] & Reject::sky) == Reject::none);
    const FloorKind beyond = off > 0 ? FloorKind::in_front : FloorKind::behind;
    const FloorKind known = std::abs(off) <= margin ? FloorKind::on_floor : beyond;
    const FloorKind kind = seen == seen ? known : FloorKind::hole;
    out[x] = is_judged ? kind : FloorKind::not_judged;
  }
}

inline constexpr ObstacleKernels kSpaceKernels{in_steps_from_floor, prefer_refined, look_behind, label, place,
                                               mark_kinds};

}  // namespace
}  // namespace cairn::kernels::CAIRN_KERNEL_TARGET
