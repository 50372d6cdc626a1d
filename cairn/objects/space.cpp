// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/core/parallel.hpp>
#include <cairn/disparity/islands.hpp>
#include <cairn/objects/space.hpp>
#include <cmath>
#include <limits>
#include <numbers>

namespace cairn {
namespace {

constexpr int kGrain = 64;  // rows
constexpr float kRatherRight = 0.5F;
constexpr std::int64_t kKnownPart = 5;  // a fifth of a superpixel
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// The disparities of floor and walls behind the pixels of a row, px.
class BackgroundRow {
 public:
  BackgroundRow(const SpaceCues& cues, const std::optional<StereoRig>& rig)
      : floor_(cues.ground.plane), infinity_(rig ? rig->doffs_px : 0.0F), width_(cues.objects.width()) {
    const auto& planes = cues.background.planes;
    walls_.assign(planes.begin() + (cues.background.has_floor ? 1 : 0), planes.end());
    for (std::vector<float>* row : {&floor_px_, &wall_px_, &barrier_px_}) row->resize(slot(width_));
  }
  [[nodiscard]] bool has_any() const { return floor_.has_value() || !walls_.empty(); }

  void look_at(int y) {
    std::fill(floor_px_.begin(), floor_px_.end(), kNan);
    std::fill(wall_px_.begin(), wall_px_.end(), -std::numeric_limits<float>::infinity());
    for (const GroundPlane& wall : walls_) {
      for (int x = 0; x < width_; ++x) {
        const float d = wall.disparity_px(static_cast<float>(x), static_cast<float>(y));
        wall_px_[slot(x)] = std::max(wall_px_[slot(x)], d);
      }
    }
    for (int x = 0; x < width_ && floor_; ++x) {
      const float d = floor_->disparity_px(static_cast<float>(x), static_cast<float>(y));
      floor_px_[slot(x)] = d + infinity_ > 0 ? d : kNan;
    }
    for (int x = 0; x < width_; ++x) {
      const float floor = floor_px_[slot(x)];
      const float beyond = floor_ ? -infinity_ : std::max(wall_px_[slot(x)], -infinity_);
      barrier_px_[slot(x)] = std::isnan(floor) ? beyond : floor;
    }
  }

  /// NaN above the horizon, without a floor, and where a wall hides the floor.
  [[nodiscard]] float free_floor_px(int x) const {
    return floor_px_[slot(x)] >= wall_px_[slot(x)] ? floor_px_[slot(x)] : kNan;
  }
  /// −∞ where there is none.
  [[nodiscard]] float wall_px(int x) const { return wall_px_[slot(x)]; }
  /// The surface that an obstacle must be in front of: the floor or, without one, the walls.
  [[nodiscard]] float barrier_px(int x) const { return barrier_px_[slot(x)]; }

 private:
  std::optional<GroundPlane> floor_;
  std::vector<GroundPlane> walls_;
  float infinity_;
  int width_;
  std::vector<float> floor_px_;
  std::vector<float> wall_px_;
  std::vector<float> barrier_px_;
};

struct Tally {
  std::int64_t pixels = 0;
  std::int64_t known = 0;
  std::int64_t on_floor = 0;
  [[nodiscard]] bool is_floor() const {
    return on_floor > 0 && kKnownPart * known >= pixels && 5 * on_floor >= 3 * known;
  }
};

/// For each superpixel whether it is floor; none where there are no superpixels.
std::vector<bool> floor_pieces(const SpaceCues& cues, View<const float> seen_px, BackgroundRow behind,
                               float margin) {
  if (cues.superpixels.empty()) return {};
  std::vector<Tally> pieces;
  for (int y = 0; y < seen_px.height(); ++y) {
    behind.look_at(y);
    const RegionId* const superpixel = cues.superpixels.row(y);
    const float* const seen = seen_px.row(y);
    for (int first = 0, x = 0; first < seen_px.width(); first = x) {
      int known = 0;
      int on_floor = 0;
      for (; x < seen_px.width() && superpixel[x] == superpixel[first]; ++x) {
        known += std::isnan(seen[x]) ? 0 : 1;
        on_floor += std::abs(seen[x] - behind.free_floor_px(x)) <= margin ? 1 : 0;
      }
      const std::size_t i = index(superpixel[first]);
      if (i >= pieces.size()) pieces.resize(i + 1);
      Tally& piece = pieces[i];
      piece.pixels += x - first;
      piece.known += known;
      piece.on_floor += on_floor;
    }
  }
  std::vector<bool> floor(pieces.size());
  for (std::size_t i = 0; i < pieces.size(); ++i) floor[i] = pieces[i].is_floor();
  return floor;
}

/// An obstacle pixel in the floor frame.
struct FloorPoint {
  Vec3 in_floor_m;
  [[nodiscard]] float distance_m() const { return std::hypot(in_floor_m.x, in_floor_m.y); }
};

/// Calls visit(point) for every obstacle pixel within height and range.
template <class Visit>
void for_each_obstacle_point(View<const Space> space, View<const float> disparity_px, const FloorFrame& floor,
                             const StereoRig& rig, const SpaceConfig& config, Visit visit) {
  for (int y = 0; y < space.height(); ++y) {
    for (int x = 0; x < space.width(); ++x) {
      if (space(x, y) != Space::obstacle || std::isnan(disparity_px(x, y))) continue;
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
  const Space* space;
  const ObjectId* object;
  const float* d;
  [[nodiscard]] bool is_pixel(int x) const {
    return space[x] == Space::obstacle && object[x] == ObjectId::none && d[x] == d[x];
  }
  [[nodiscard]] bool follows(int x) const {
    return is_pixel(x) && is_pixel(x - 1) && std::abs(d[x] - d[x - 1]) <= 1;
  }
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

Image<Space> label_space(const SpaceCues& cues, const std::optional<StereoRig>& rig,
                         const GroundConfig& config, const Exec& exec) {
  const View<const float> disparity_px = cues.disparity.disparity_px;
  const View<const float> seen_px = cues.seen_px.empty() ? disparity_px : cues.seen_px;
  const BackgroundRow planes(cues, rig);
  const std::vector<bool> pieces = floor_pieces(cues, seen_px, planes, config.margin);
  Image<Space> space(disparity_px.size(), exec.pool);
  const bool has_any = planes.has_any();
  parallel_for(exec, space.height(), kGrain, [&](int first, int last) {
    BackgroundRow behind = planes;
    for (int y = first; y < last; ++y) {
      behind.look_at(y);
      const ObjectId* const object = cues.objects.row(y);
      const float* const disparity = disparity_px.row(y);
      const float* const seen = seen_px.row(y);
      const float* const confidence = cues.confidence.empty() ? nullptr : cues.confidence.row(y);
      const RegionId* const piece = pieces.empty() ? nullptr : cues.superpixels.row(y);
      const auto is_floor = [&](int x) {
        const float floor = behind.free_floor_px(x);
        if (piece == nullptr) return std::abs(seen[x] - floor) <= config.margin;
        // A hole in a piece of floor is floor; a pixel with a disparity off the floor is not.
        return pieces[index(piece[x])] &&
               std::abs((std::isnan(seen[x]) ? floor : seen[x]) - floor) <= config.margin;
      };
      const auto is_obstacle = [&](int x) {
        return disparity[x] - behind.barrier_px(x) > config.margin &&
               (confidence == nullptr || confidence[x] >= kRatherRight);
      };
      Space* const out = space.row(y);
      for (int x = 0; x < space.width(); ++x) {
        if (object[x] != ObjectId::none) {
          out[x] = Space::obstacle;
        } else if (!has_any) {
          out[x] = Space::unknown;
        } else {
          out[x] = is_floor(x) ? Space::floor : is_obstacle(x) ? Space::obstacle : Space::unknown;
        }
      }
    }
  });
  return space;
}

Image<std::uint8_t> floor_of(View<const Space> space, const Exec& exec) {
  Image<std::uint8_t> floor(space.size(), exec.pool);
  for (int y = 0; y < space.height(); ++y) {
    std::transform(space.row(y), space.row(y) + space.width(), floor.row(y),
                   [](Space s) { return s == Space::floor ? std::uint8_t{255} : std::uint8_t{0}; });
  }
  return floor;
}

ObstacleScan scan_obstacles(View<const Space> space, View<const float> disparity_px, const FloorFrame& floor,
                            const StereoRig& rig, const SpaceConfig& config) {
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

ObstacleGrid map_obstacles(View<const Space> space, View<const float> disparity_px, const FloorFrame& floor,
                           const StereoRig& rig, const SpaceConfig& config) {
  constexpr int kEnough = 3;  // pixels
  // Slightly less, so that rounding errors do not add a cell.
  const float cells = std::ceil(config.range / config.cell_size - 1e-4F);
  const int reach = static_cast<int>(std::clamp(cells, 1.0F, float{ObstacleGrid::kMostCells}));
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
      if (space(u, v) == Space::floor && !std::isnan(disparity_px(u, v)))
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

std::vector<LeftOut> left_out_of(View<const Space> space, const SpaceCues& cues,
                                 const std::vector<float>& likeliest, const std::optional<StereoRig>& rig,
                                 const LeftOutLimits& limits, const Exec& exec) {
  constexpr double kLeastShare = 0.0005;
  const View<const float> d = cues.disparity.disparity_px;
  BackgroundRow behind(cues, rig);
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
        of.on_wall += std::abs(d(x, y) - behind.wall_px(x)) <= limits.wall_tolerance_px ? 1 : 0;
        of.disparity_px += double{d(x, y)};
        if (!likeliest.empty())
          of.likeliest = std::max(of.likeliest, likeliest[index(cues.superpixels(x, y))]);
      }
    });
  }

  std::vector<LeftOut> all;
  for (const IslandStatistics& of : found) {
    if (static_cast<double>(of.pixels) < kLeastShare * static_cast<double>(space.size().area())) continue;
    const auto count = static_cast<double>(of.pixels);
    const auto x = static_cast<float>(of.x / count);
    const auto y = static_cast<float>(of.y / count);
    LeftOut left{LeftOutReason::low_confidence,
                 of.box,
                 static_cast<int>(of.pixels),
                 static_cast<float>(of.disparity_px / count),
                 std::nullopt,
                 of.likeliest};
    if (rig) left.position_in_camera_m = rig->point_in_camera_m(x, y, left.disparity_px);
    if (of.pixels < limits.min_area) left.reason = LeftOutReason::too_small;
    if (2 * of.on_wall >= of.pixels) left.reason = LeftOutReason::background;
    all.push_back(left);
  }
  // Stable: ties stay in raster order.
  std::stable_sort(all.begin(), all.end(),
                   [](const LeftOut& p, const LeftOut& q) { return p.disparity_px > q.disparity_px; });
  return all;
}

}  // namespace cairn
