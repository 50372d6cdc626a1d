// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <array>
#include <cairn/core/error.hpp>
#include <cairn/core/parallel.hpp>
#include <cairn/disparity/islands.hpp>
#include <cairn/objects/locate.hpp>
#include <cairn/objects/point_kernels.hpp>
#include <cairn/objects/ranks.hpp>
#include <cairn/scene/floor_frame.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace cairn {
namespace {

// Neighbours on one surface differ by less, those on two surfaces rarely; as in reject_speckles().
constexpr float kStep = 1.0F;  // px

// ln σ = kBias + kSpread · ln(interquartile range + 0.1 px) + kSeen · valid share, fitted to how far the
// median disparities of found objects were from the true ones: ./dev bench geometry --fit.
constexpr double kBias = 1.58;
constexpr double kSpread = 0.441;
constexpr double kSeen = -2.693;
constexpr double kWidth95 = 1.96;   // standard deviations on either side that hold 95 %
constexpr double kSideSigma = 2.0;  // px: uncertainty of an object's centre by its mask …
constexpr double kEndShare = 0.2;   // … and of the end of each side of a box, as a share of its length

/// Pixels of one object with disparities of one surface.
struct SurfaceRow {
  const ObjectId* object;
  const float* d;
  [[nodiscard]] bool is_pixel(int x) const { return object[x] != ObjectId::none && d[x] == d[x]; }
  [[nodiscard]] bool follows(int x) const {
    return object[x] == object[x - 1] && std::abs(d[x] - d[x - 1]) <= kStep;
  }
  [[nodiscard]] bool joins(const SurfaceRow& above, int x) const {
    return object[x] == above.object[x] && std::abs(d[x] - above.d[x]) <= kStep;
  }
};

struct Stretch {
  int y;
  int first;
  int last;
};

/// The pixels of each object: its main part, and the valid disparities of the whole mask.
struct Part {
  std::vector<Stretch> main;
  std::vector<float> disparities_px;
};

std::vector<Part> parts_of(const Objects& objects, View<const float> disparity_px, const Exec& exec) {
  const auto rows = [&](int y) { return SurfaceRow{objects.labels.row(y), disparity_px.row(y)}; };
  const Islands islands(disparity_px.size(), rows, exec);
  std::vector<std::int32_t> largest(objects.list.size(), -1);
  std::vector<Part> parts(objects.list.size());
  const auto object_at = [&](int x, int y) { return slot(number(objects.labels(x, y)) - 1); };
  for (int y = 0; y < disparity_px.height(); ++y) {
    islands.for_each_run(y, [&](std::int32_t island, int begin, int end) {
      const std::size_t i = object_at(begin, y);
      if (largest[i] < 0 || islands.pixels(island) > islands.pixels(largest[i])) largest[i] = island;
      std::vector<float>& all = parts[i].disparities_px;
      all.insert(all.end(), disparity_px.row(y) + begin, disparity_px.row(y) + end);
    });
  }
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  std::vector<Interval> within_px(parts.size(), Interval{kInfinity, -kInfinity});
  for (int y = 0; y < disparity_px.height(); ++y) {
    islands.for_each_run(y, [&](std::int32_t island, int begin, int end) {
      const std::size_t i = object_at(begin, y);
      if (island != largest[i]) return;
      const auto [low, high] = std::minmax_element(disparity_px.row(y) + begin, disparity_px.row(y) + end);
      Interval& within = within_px[i];
      within = {std::min(within.low, *low), std::max(within.high, *high)};
    });
  }
  for (int y = 0; y < disparity_px.height(); ++y) {
    const float* const d = disparity_px.row(y);
    islands.for_each_run(y, [&](std::int32_t, int begin, int end) {
      const std::size_t i = object_at(begin, y);
      const auto is_main = [&](int x) { return within_px[i].low <= d[x] && d[x] <= within_px[i].high; };
      for (int x = begin; x < end;) {
        const int first = x++;
        if (!is_main(first)) continue;
        while (x < end && is_main(x)) ++x;
        parts[i].main.push_back({y, first, x});
      }
    });
  }
  return parts;
}

std::size_t rank_of(std::size_t percent, std::size_t count) {
  return (percent * (count - 1) + 50) / 100;
}

/// The ranks of the `percent`-th percentile and of the one as far from the other end: ⌊(p·(n−1) + 50)/100⌋ in
/// ascending order. A few outliers do not stretch the interval. Reorders `values`, which must not be empty.
Interval without_tails(std::span<float> values, std::size_t percent, const Exec& exec) {
  const std::size_t n = values.size();
  const auto [low, high] = values_at_ranks(values, rank_of(percent, n), rank_of(100 - percent, n), exec);
  return {low, high};
}
constexpr std::size_t kTailOfBox = 1;     // %; few points are visible at the far ends of the sides
constexpr std::size_t kTailOfExtent = 5;  // %; depth has more outliers than width

float sigma_px(std::span<float> disparities_px, float valid_share, const Exec& exec) {
  const std::size_t n = disparities_px.size();
  const auto [low, high] = values_at_ranks(disparities_px, rank_of(25, n), rank_of(75, n), exec);
  const double logarithm =
      kBias + kSpread * std::log(double{high} - double{low} + 0.1) + kSeen * double{valid_share};
  // What exp() gives in the last place may differ between processors; nearly all of it is rounded away here.
  return static_cast<float>(std::floor(std::exp(logarithm) * 1024 + 0.5) / 1024);
}

/// Points of a surface, one list per axis.
struct Points {
  std::array<std::vector<float>, 3> axis;
  [[nodiscard]] std::size_t size() const { return axis[0].size(); }
  void push_back(Vec3 p) {
    axis[0].push_back(p.x);
    axis[1].push_back(p.y);
    axis[2].push_back(p.z);
  }
};

/// Farther points are ignored: their coordinates would overflow when rotated.
bool is_near(Vec3 p) {
  constexpr float kFarthest = 1e6F;  // m
  return std::abs(p.x) <= kFarthest && std::abs(p.y) <= kFarthest && std::abs(p.z) <= kFarthest;
}

/// The disparities of an object's main part, in the smallest rectangle around them.
class Surface {
 public:
  Surface(const Part& part, View<const float> disparity_px) {
    left_ = disparity_px.width();
    int right = 0;
    for (const Stretch& run : part.main) {
      left_ = std::min(left_, run.first);
      right = std::max(right, run.last);
    }
    top_ = part.main.front().y;
    width_ = right - left_;
    height_ = part.main.back().y + 1 - top_;
    pitch_ = slot(width_) + 2 * kReach;
    values_.resize((slot(height_) + 2 * kReach) * pitch_);
    is_main_.resize(values_.size());
    for (const auto& [y, first, last] : part.main) {
      const std::size_t i = at(first - left_, y - top_);
      std::copy(disparity_px.row(y) + first, disparity_px.row(y) + last, &values_[i]);
      std::fill_n(&is_main_[i], last - first, 1.0F);
    }
  }

  /// Makes each disparity the mean over those in the window of 5 x 5 px around it.
  void smooth() {
    std::vector<float> counts = is_main_;
    for (const std::size_t step : {std::size_t{1}, pitch_}) {
      values_ = sums_of_five(values_, step);
      counts = sums_of_five(counts, step);
    }
    for (std::size_t i = 0; i < values_.size(); ++i) values_[i] /= std::max(counts[i], 1.0F);
  }

  [[nodiscard]] Points points(const StereoRig& rig, const Exec& exec) const {
    const kernels::PointKernels& run = kernels::point_kernels(exec);
    std::vector<float> d(slot(left_ + width_));
    std::array<std::vector<float>, 3> row;
    for (auto& axis : row) axis.resize(d.size());
    Points points;
    for (int y = 0; y < height_; ++y) {
      const std::size_t first = at(0, y);
      std::copy_n(&values_[first], width_, &d[slot(left_)]);
      run.points_in_camera(rig, top_ + y, left_, left_ + width_, d.data(), row[0].data(), row[1].data(),
                           row[2].data());
      for (std::size_t x = 0; x < slot(width_); ++x) {
        const std::size_t i = slot(left_) + x;
        const Vec3 point{row[0][i], row[1][i], row[2][i]};
        if (is_main_[first + x] > 0 && is_near(point)) points.push_back(point);
      }
    }
    return points;
  }

 private:
  static constexpr std::size_t kReach = 2;  // px

  [[nodiscard]] std::size_t at(int x, int y) const { return (slot(y) + kReach) * pitch_ + slot(x) + kReach; }
  /// Of values `step` apart. The frame around the surface need not be right.
  static std::vector<float> sums_of_five(const std::vector<float>& v, std::size_t step) {
    std::vector<float> sums(v.size());
    for (std::size_t i = 2 * step; i + 2 * step < v.size(); ++i)
      sums[i] = v[i - 2 * step] + v[i - step] + v[i] + v[i + step] + v[i + 2 * step];
    return sums;
  }

  int left_ = 0;
  int top_ = 0;
  int width_ = 0;
  int height_ = 0;
  std::size_t pitch_ = 0;
  // With a frame of zeros, which saves the questions at the ends of a row.
  std::vector<float> values_;
  std::vector<float> is_main_;  // 1 or 0
};

// ---- boxes on the floor ----

/// Points seen from above: their coordinates on the floor.
using Plan = std::array<std::vector<float>, 2>;

/// `count` of the points. Fewer than all are drawn at random: every n-th point could come from only a few columns
/// of the image.
Plan plan_of(const Points& points, std::size_t count) {
  constexpr std::uint64_t kStride = 2654435761;  // Knuth's multiplier: 2³² divided by the golden ratio
  Plan plan;
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t i = count < points.size() ? k * kStride % points.size() : k;
    plan[0].push_back(points.axis[0][i]);
    plan[1].push_back(points.axis[1][i]);
  }
  return plan;
}

/// The coordinates along axes turned by the yaw.
void turn(std::span<const float> xs, std::span<const float> ys, float yaw_rad, Plan& turned) {
  const float c = std::cos(yaw_rad);
  const float s = std::sin(yaw_rad);
  for (auto& axis : turned) axis.resize(xs.size());
  for (std::size_t i = 0; i < xs.size(); ++i) {
    const float x = xs[i];
    const float y = ys[i];
    turned[0][i] = c * x + s * y;
    turned[1][i] = c * y - s * x;
  }
}

float length(Interval i) {
  return i.high - i.low;
}
float middle(Interval i) {
  return (i.low + i.high) / 2;
}
/// The distance of a value from the nearer end.
float from_end(Interval i, float value) {
  return std::min(std::abs(value - i.low), std::abs(i.high - value));
}
float radians(int degrees) {
  return static_cast<float>(degrees) * std::numbers::pi_v<float> / 180;
}

/// The yaw of the rectangle whose sides are closest to the points, 0 … 89 degrees. (From above, the visible part
/// of a box is an L, for which the rectangle of least area may be askew. Zhang, Xu, Dong, Dolan: Efficient L-shape
/// fitting, 2017.)
int closest_yaw(const Points& points, const Exec& exec) {
  constexpr std::size_t kEnough = 512;  // points for finding the yaw
  constexpr int kCoarse = 6;            // degrees
  const Plan plan = plan_of(points, std::min(points.size(), kEnough));
  Plan room;
  Plan ranked;
  const auto distance = [&](int degrees) {
    turn(plan[0], plan[1], radians(degrees), room);
    ranked = room;
    const Interval u = without_tails(ranked[0], kTailOfBox, exec);
    const Interval v = without_tails(ranked[1], kTailOfBox, exec);
    double sum = 0;
    for (std::size_t i = 0; i < room[0].size(); ++i)
      sum += double{std::min(from_end(u, room[0][i]), from_end(v, room[1][i]))};
    return sum;
  };
  int best = 0;
  double least = std::numeric_limits<double>::infinity();
  const auto try_one = [&](int degrees) {
    const double found = distance(degrees);
    if (found < least) {
      least = found;
      best = degrees;
    }
  };
  for (int degrees = 0; degrees < 90; degrees += kCoarse) try_one(degrees);
  const int about = best;
  for (int off = 1; off < kCoarse; ++off) {
    try_one((about + off) % 90);
    try_one((about + 90 - off) % 90);
  }
  return best;
}

/// The covariance of a box's centre: from depth along the ray, from the mask across it, and from the ends of its
/// sides.
std::array<float, 6> covariance(const FloorBox& box, Vec3 position_in_camera_m, double sigma_z_m,
                                double sigma_side_m, const FloorFrame& floor) {
  const Vec3 at_m = floor.to_floor(position_in_camera_m);
  const Vec3 ray{at_m.x, at_m.y, at_m.z - floor.camera_height_m};
  const double c = std::cos(double{box.yaw_rad});
  const double s = std::sin(double{box.yaw_rad});
  const auto end = [](float size) { return kEndShare * kEndShare * size * size; };
  const double longer = end(box.size_m.x);
  const double shorter = end(box.size_m.y);
  const double square = double{ray.x} * ray.x + double{ray.y} * ray.y + double{ray.z} * ray.z;
  const double far = square / (double{position_in_camera_m.z} *
                               position_in_camera_m.z);  // a step of z along the ray, squared
  const double along = sigma_z_m * sigma_z_m * far;
  const double across = sigma_side_m * sigma_side_m;
  const auto entry = [&](float p, float q, double more) {
    return static_cast<float>((along - across) * p * q / square + more);
  };
  return {entry(ray.x, ray.x, across + c * c * longer + s * s * shorter),
          entry(ray.x, ray.y, c * s * (longer - shorter)),
          entry(ray.x, ray.z, 0),
          entry(ray.y, ray.y, across + s * s * longer + c * c * shorter),
          entry(ray.y, ray.z, 0),
          entry(ray.z, ray.z, across + end(box.size_m.z))};
}

FloorBox box_on(const FloorFrame& floor, const Points& in_camera, const Exec& exec) {
  Points points;
  for (std::size_t i = 0; i < in_camera.size(); ++i)
    points.push_back(floor.to_floor({in_camera.axis[0][i], in_camera.axis[1][i], in_camera.axis[2][i]}));
  int degrees = closest_yaw(points, exec);
  const float yaw = radians(degrees);
  Plan room;
  turn(points.axis[0], points.axis[1], yaw, room);
  const Interval u = without_tails(room[0], kTailOfBox, exec);
  const Interval v = without_tails(room[1], kTailOfBox, exec);
  const Interval up = without_tails(points.axis[2], kTailOfBox, exec);
  const float c = std::cos(yaw);
  const float s = std::sin(yaw);
  FloorBox box;
  box.centre_in_floor_m = {c * middle(u) - s * middle(v), s * middle(u) + c * middle(v), middle(up)};
  box.size_m = {std::max(length(u), length(v)), std::min(length(u), length(v)), length(up)};
  if (length(v) > length(u)) degrees -= degrees > 0 ? 90 : -90;
  box.yaw_rad = radians(degrees);
  return box;
}

// ---- objects ----

void place(Object& object, const Part& part, const Image<float>& disparity_px,
           const std::optional<FloorFrame>& floor, const StereoRig& rig, const Exec& exec) {
  std::int64_t sum_x = 0;
  std::int64_t sum_y = 0;
  std::int64_t count = 0;
  for (const auto& [y, first, last] : part.main) {
    const std::int64_t run = last - first;
    count += run;
    sum_x += run * (first + last - 1);
    sum_y += run * y;
  }
  const double x = static_cast<double>(sum_x) / (2.0 * static_cast<double>(count));
  const double y = static_cast<double>(sum_y) / static_cast<double>(count);
  object.position_in_camera_m =
      rig.point_in_camera_m(static_cast<float>(x), static_cast<float>(y), object.disparity_px);
  if (!object.position_in_camera_m) return;
  if (!is_near(*object.position_in_camera_m)) {
    object.position_in_camera_m.reset();
    return;
  }

  const double focal_baseline = double{rig.focal_px} * rig.baseline_m;
  const double before_infinity = double{object.disparity_px} + rig.doffs_px;
  const double either_side = kWidth95 * double{object.disparity_sigma_px};
  object.depth_interval_m = {static_cast<float>(focal_baseline / (before_infinity + either_side)),
                             before_infinity > either_side
                                 ? static_cast<float>(focal_baseline / (before_infinity - either_side))
                                 : std::numeric_limits<float>::infinity()};

  Surface surface(part, disparity_px);
  Points points = surface.points(rig, exec);
  if (points.size() == 0) return;
  Points smooth;
  if (floor) {
    surface.smooth();  // the noise of single pixels would widen the box
    smooth = surface.points(rig, exec);
  }
  // At infinity, means may have no point where single pixels have one.
  if (smooth.size() > 0) {
    object.box_on_floor = box_on(*floor, smooth, exec);
    const double z = object.position_in_camera_m->z;
    std::array<float, 6>& known = object.box_on_floor->centre_covariance_m2;
    known =
        covariance(*object.box_on_floor, *object.position_in_camera_m,
                   z * z * object.disparity_sigma_px / focal_baseline, kSideSigma * z / rig.focal_px, *floor);
    if (!std::all_of(known.begin(), known.end(), [](float c) { return std::isfinite(c); }))
      object.box_on_floor.reset();
  }
  // Compensates for the tails that were cut off, assuming evenly spread points.
  const auto span = [&](std::size_t axis) {
    return length(without_tails(points.axis.at(axis), kTailOfExtent, exec)) * 100 /
           float{100 - 2 * kTailOfExtent};
  };
  object.extent_in_camera_m = Vec3{span(0), span(1), span(2)};
}

}  // namespace

Objects locate(Objects objects, const DisparityMap& disparity, const Ground& ground,
               const std::optional<StereoRig>& rig, const Exec& exec) {
  if (objects.list.empty()) return objects;
  std::vector<Part> parts = parts_of(objects, disparity.disparity_px, exec);
  const auto floor = floor_frame(ground, rig);
  parallel_for(exec, static_cast<int>(parts.size()), 1, [&](int first, int last) {
    for (auto i = slot(first); i < slot(last); ++i) {
      Object& object = objects.list[i];
      object.disparity_sigma_px = 0;
      object.position_in_camera_m.reset();
      object.depth_interval_m.reset();
      object.extent_in_camera_m.reset();
      object.box_on_floor.reset();
      if (parts[i].main.empty()) continue;
      object.disparity_sigma_px = sigma_px(parts[i].disparities_px, object.valid_share, exec);
      if (rig) place(object, parts[i], disparity.disparity_px, floor, *rig, exec);
    }
  });
  return objects;
}

std::vector<Vec3> object_points(const Objects& objects, ObjectId id, View<const float> disparity_px,
                                const StereoRig& rig) {
  const auto count = static_cast<std::int32_t>(objects.list.size());
  if (number(id) < 1 || number(id) > count)
    throw Error("object: found id " + std::to_string(number(id)) + ", expected 1 … " + std::to_string(count));
  const Object& object = objects.list[slot(number(id) - 1)];
  std::vector<Vec3> points;
  points.reserve(slot(object.pixel_count));
  const Rect box = object.box_px;
  for (int y = box.y; y < box.y + box.height; ++y) {
    for (int x = box.x; x < box.x + box.width; ++x) {
      if (objects.labels(x, y) != id) continue;
      const auto point =
          rig.point_in_camera_m(static_cast<float>(x), static_cast<float>(y), disparity_px(x, y));
      if (point) points.push_back(*point);
    }
  }
  return points;
}

}  // namespace cairn
