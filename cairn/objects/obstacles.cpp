// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/core/parallel.hpp>
#include <cairn/objects/obstacle_kernels.hpp>
#include <cairn/objects/obstacle_rows.hpp>
#include <cairn/objects/obstacles.hpp>
#include <cairn/stereo/islands.hpp>
#include <cmath>
#include <limits>
#include <numbers>

namespace cairn {
namespace {

constexpr int kGrain = 64;  // rows
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// An obstacle pixel in the floor frame.
struct FloorPoint {
  Vec3 in_floor_m;
  [[nodiscard]] float distance_m() const { return std::hypot(in_floor_m.x, in_floor_m.y); }
};

/// Calls visit(point) for every obstacle pixel within height and range.
template <class Visit>
void for_each_obstacle_point(View<const ObstacleLabel> space, View<const float> disparity_px,
                             const FloorFrame& floor, const StereoRig& rig, const ObstaclesConfig& config,
                             Visit visit) {
  for (int y = 0; y < space.height(); ++y) {
    for (int x = 0; x < space.width(); ++x) {
      if (space(x, y) != ObstacleLabel::obstacle || std::isnan(disparity_px(x, y))) continue;
      const auto point =
          rig.point_in_camera_m(static_cast<float>(x), static_cast<float>(y), disparity_px(x, y));
      if (!point) continue;
      const FloorPoint place{floor.to_floor(*point)};
      if (place.in_floor_m.z <= config.max_height && place.distance_m() <= config.range) visit(place);
    }
  }
}

/// Obstacles that are not objects: connected pixels of one surface.
struct RestRow {
  const ObstacleLabel* space;
  const ObjectId* object;
  const float* d;
  [[nodiscard]] bool is_pixel(int x) const {
    return space[x] == ObstacleLabel::obstacle && object[x] == ObjectId::none && d[x] == d[x];
  }
  [[nodiscard]] bool follows(int x) const { return is_pixel(x) && std::abs(d[x] - d[x - 1]) <= 1; }
  [[nodiscard]] bool joins(const RestRow& above, int x) const { return std::abs(d[x] - above.d[x]) <= 1; }
};

struct IslandStatistics {
  Rect box;
  std::int64_t pixels = 0;
  std::int64_t on_wall = 0;
  double disparity_px = 0;
  double x = 0;
  double y = 0;
  float likeliest = 0;
};

}  // namespace

Image<ObstacleLabel> label_obstacles(const ObstacleCues& cues, const std::optional<StereoRig>& rig,
                                     const GroundConfig& config, const Exec& exec) {
  Image<ObstacleLabel> space(cues.disparity.disparity_px.size(), exec.pool);
  const kernels::ObstacleKernels& run = kernels::obstacle_kernels(exec);
  const int width = space.width();
  parallel_for(exec, space.height(), kGrain, [&](int first, int last) {
    BackgroundRow behind(cues, rig, exec);
    SeenRow seen(cues, exec);
    const std::vector<float> not_judged(cues.floor_probability.empty() ? slot(width) : 0, kNan);
    for (int y = first; y < last; ++y) {
      behind.look_at(y);
      seen.look_at(y);
      const float* const likely_floor =
          cues.floor_probability.empty() ? not_judged.data() : cues.floor_probability.row(y);
      run.label({cues.objects.row(y), seen.disparity_px(), seen.surface_px(), seen.confidence(), likely_floor,
                 behind.free_floor_px(), behind.barrier_px()},
                config.margin, width, space.row(y));
      for (int x = 0; x < width; ++x) {
        if (has(cues.disparity.reject(x, y), Reject::sky) && cues.objects(x, y) == ObjectId::none)
          space(x, y) = ObstacleLabel::sky;
      }
    }
  });
  return space;
}

Image<float> obstacle_disparities(View<const ObstacleLabel> space, const ObstacleCues& cues,
                                  const Exec& exec) {
  const View<const float> matched = cues.disparity.disparity_px;
  const kernels::ObstacleKernels& run = kernels::obstacle_kernels(exec);
  // Without a floor, nothing contradicts a label: every disparity is in front of this plane.
  const GroundPlane floor =
      cues.ground.plane.value_or(GroundPlane{0, 0, -std::numeric_limits<float>::infinity()});
  Image<float> all(matched.size(), exec.pool);
  for (int y = 0; y < all.height(); ++y) {
    if (cues.refined_px.empty()) {
      std::copy_n(matched.row(y), all.width(), all.row(y));
      continue;
    }
    run.place({space.row(y), cues.objects.row(y), matched.row(y), cues.refined_px.row(y),
               cues.refined_confidence.row(y)},
              floor, y, all.width(), all.row(y));
  }
  return all;
}

Image<std::uint8_t> floor_of(View<const ObstacleLabel> space, const Exec& exec) {
  Image<std::uint8_t> floor(space.size(), exec.pool);
  for (int y = 0; y < space.height(); ++y) {
    std::transform(space.row(y), space.row(y) + space.width(), floor.row(y), [](ObstacleLabel s) {
      return s == ObstacleLabel::floor ? std::uint8_t{255} : std::uint8_t{0};
    });
  }
  return floor;
}

ObstacleScan scan_obstacles(View<const ObstacleLabel> space, View<const float> disparity_px,
                            const FloorFrame& floor, const StereoRig& rig, const ObstaclesConfig& config) {
  constexpr float kIncrement = std::numbers::pi_v<float> / 180;
  constexpr std::size_t kRank = 3;  // from 0
  float widest = 0;
  for (const int x : {0, space.width() - 1}) {
    for (const int y : {0, space.height() - 1}) {
      const Vec3 ray{(static_cast<float>(x) - rig.cx_px) / rig.focal_px,
                     (static_cast<float>(y) - rig.cy_px) / rig.focal_px, 1};
      const Vec3 at = floor.to_floor(ray);
      const bool is_ahead = at.x > 0 && std::isfinite(at.y);
      widest = std::max(widest, is_ahead ? std::atan2(std::abs(at.y), at.x) : std::numbers::pi_v<float>);
    }
  }
  const int half = std::clamp(static_cast<int>(std::ceil(widest / kIncrement)), 1, 180);
  ObstacleScan scan{-kIncrement * static_cast<float>(half), kIncrement, config.range, {}};
  std::vector<std::vector<float>> ranges(slot(2 * half + 1));
  for_each_obstacle_point(space, disparity_px, floor, rig, config, [&](const FloorPoint& place) {
    const float bearing = std::atan2(place.in_floor_m.y, place.in_floor_m.x);
    const int bin = std::clamp(static_cast<int>(std::lround(bearing / kIncrement)) + half, 0, 2 * half);
    ranges[slot(bin)].push_back(place.distance_m());
  });
  for (std::vector<float>& found : ranges) {
    if (found.size() <= kRank) {
      scan.ranges_m.push_back(kNan);
      continue;
    }
    std::nth_element(found.begin(), found.begin() + kRank, found.end());
    scan.ranges_m.push_back(found[kRank]);
  }
  return scan;
}

ObstacleGrid map_obstacles(View<const ObstacleLabel> space, View<const float> disparity_px,
                           const FloorFrame& floor, const StereoRig& rig, const ObstaclesConfig& config) {
  constexpr int kEnough = 3;  // pixels
  // Slightly less, so that rounding errors do not add a cell.
  const float cells = std::ceil(config.range / config.cell_size - 1e-4F);
  const int reach = static_cast<int>(std::clamp(cells, 1.0F, float{ObstacleGrid::kMaxCells}));
  ObstacleGrid grid{config.cell_size, reach, 2 * reach, 0, -config.cell_size * static_cast<float>(reach), {}};
  grid.cells.assign(slot(grid.width) * slot(grid.height), ObstacleGrid::kUnknown);
  const auto at = [&](int column, int row) { return slot(row) * slot(grid.width) + slot(column); };

  for (int row = 0; row < grid.height; ++row) {
    for (int column = 0; column < grid.width; ++column) {
      const Vec3 middle{(static_cast<float>(column) + 0.5F) * grid.cell_size_m,
                        grid.origin_y_m + (static_cast<float>(row) + 0.5F) * grid.cell_size_m, 0};
      const Vec3 point = floor.to_camera(middle);
      if (!(point.z > 0)) continue;
      const float x = rig.cx_px + rig.focal_px * point.x / point.z;
      const float y = rig.cy_px + rig.focal_px * point.y / point.z;
      const bool inside = x > -0.5F && y > -0.5F && x < static_cast<float>(space.width()) - 0.5F &&
                          y < static_cast<float>(space.height()) - 0.5F;
      if (!inside) continue;
      const auto u = static_cast<int>(std::lround(x));
      const auto v = static_cast<int>(std::lround(y));
      if (space(u, v) == ObstacleLabel::floor && !std::isnan(disparity_px(u, v)))
        grid.cells[at(column, row)] = ObstacleGrid::kFree;
    }
  }

  std::vector<std::int32_t> counts(grid.cells.size());
  for_each_obstacle_point(space, disparity_px, floor, rig, config, [&](const FloorPoint& place) {
    const auto column = static_cast<int>(std::floor(place.in_floor_m.x / grid.cell_size_m));
    const auto row = static_cast<int>(std::floor((place.in_floor_m.y - grid.origin_y_m) / grid.cell_size_m));
    if (column >= 0 && row >= 0 && column < grid.width && row < grid.height) ++counts[at(column, row)];
  });
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (counts[i] >= kEnough) grid.cells[i] = ObstacleGrid::kOccupied;
  }
  return grid;
}

std::vector<RejectedObstacle> rejected_obstacles(View<const ObstacleLabel> space, const ObstacleCues& cues,
                                                 const std::vector<float>& likeliest,
                                                 const std::optional<StereoRig>& rig,
                                                 const RejectedObstacleLimits& limits, const Exec& exec) {
  constexpr double kMinShare = 0.0005;
  const Image<float> d = obstacle_disparities(space, cues, exec);
  BackgroundRow behind(cues, rig, exec);
  const auto rows = [&](int y) { return RestRow{space.row(y), cues.objects.row(y), d.row(y)}; };
  const Islands islands(space.size(), rows, exec);
  std::vector<IslandStatistics> found(islands.count());
  for (int y = 0; y < space.height(); ++y) {
    behind.look_at(y);
    islands.for_each_run(y, [&](std::int32_t island, int begin, int end) {
      IslandStatistics& of = found[slot(island)];
      of.box = united(of.box, {begin, y, end - begin, 1});
      const double run = end - begin;
      of.pixels += end - begin;
      of.x += run * (begin + end - 1) / 2;
      of.y += run * y;
      for (int x = begin; x < end; ++x) {
        of.on_wall += std::abs(d(x, y) - behind.wall_px()[x]) <= limits.wall_tolerance_px ? 1 : 0;
        of.disparity_px += double{d(x, y)};
        if (!likeliest.empty())
          of.likeliest = std::max(of.likeliest, likeliest[index(cues.superpixels(x, y))]);
      }
    });
  }

  std::vector<RejectedObstacle> all;
  for (const IslandStatistics& of : found) {
    if (static_cast<double>(of.pixels) < kMinShare * static_cast<double>(space.size().area())) continue;
    const auto count = static_cast<double>(of.pixels);
    const auto x = static_cast<float>(of.x / count);
    const auto y = static_cast<float>(of.y / count);
    RejectedObstacle left{RejectionReason::low_confidence,
                          of.box,
                          static_cast<int>(of.pixels),
                          static_cast<float>(of.disparity_px / count),
                          std::nullopt,
                          of.likeliest};
    if (rig) left.position_in_camera_m = rig->point_in_camera_m(x, y, left.disparity_px);
    if (of.pixels < limits.min_area) left.reason = RejectionReason::too_small;
    if (2 * of.on_wall >= of.pixels) left.reason = RejectionReason::background;
    all.push_back(left);
  }
  // Stable: ties stay in raster order.
  std::stable_sort(all.begin(), all.end(), [](const RejectedObstacle& p, const RejectedObstacle& q) {
    return p.disparity_px > q.disparity_px;
  });
  return all;
}

}  // namespace cairn
