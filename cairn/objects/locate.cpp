// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <array>
#include <cairn/core/error.hpp>
#include <cairn/core/parallel.hpp>
#include <cairn/objects/locate.hpp>
#include <cairn/objects/point_kernels.hpp>
#include <cairn/objects/ranks.hpp>
#include <cairn/scene/floor_frame.hpp>
#include <cairn/stereo/islands.hpp>
#include <cairn/stereo/label_kernels.hpp>
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

// Neighbours on one surface differ by less, neighbours on two surfaces rarely; as in reject_speckles().
constexpr float kStep = 1.0F;  // px

// ln σ = kBias + kSpread · ln(interquartile range + 0.1 px) + kSeen · valid share, fitted to the disparity
// errors of found objects: ./dev bench geometry --fit.
constexpr double kBias = 1.756;
constexpr double kSpread = 0.427;
constexpr double kSeen = -2.888;
constexpr double kWidth95 = 1.96;   // standard deviations on either side of the mean: 95 %
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
  [[nodiscard]] int length() const { return last - first; }
};

/// The pixels of each object: its main part, and the valid disparities of the whole mask.
struct Part {
  std::vector<Stretch> main;
  std::vector<float> disparities_px;
  std::size_t main_pixels = 0;
};

std::vector<Part> parts_of(const Objects& objects, View<const float> disparity_px, const Exec& exec) {
  const auto rows = [&](int y) { return SurfaceRow{objects.labels.row(y), disparity_px.row(y)}; };
  const Islands islands(disparity_px.size(), rows, exec);
  std::vector<std::int32_t> largest(objects.list.size(), -1);
  std::vector<std::size_t> pixels(objects.list.size());
  const auto object_at = [&](int x, int y) { return slot(number(objects.labels(x, y)) - 1); };
  for (int y = 0; y < disparity_px.height(); ++y) {
    islands.for_each_run(y, [&](std::int32_t island, int begin, int end) {
      const std::size_t i = object_at(begin, y);
      if (largest[i] < 0 || islands.pixels(island) > islands.pixels(largest[i])) largest[i] = island;
      pixels[i] += slot(end - begin);
    });
  }
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  std::vector<Interval> within_px(pixels.size(), Interval{kInfinity, -kInfinity});
  std::vector<Part> parts(pixels.size());
  for (std::size_t i = 0; i < parts.size(); ++i) parts[i].disparities_px.reserve(pixels[i]);
  const kernels::LabelKernels& run = kernels::label_kernels(exec);
  for (int y = 0; y < disparity_px.height(); ++y) {
    islands.for_each_run(y, [&](std::int32_t island, int begin, int end) {
      const std::size_t i = object_at(begin, y);
      const float* const d = disparity_px.row(y) + begin;
      parts[i].disparities_px.insert(parts[i].disparities_px.end(), d, d + (end - begin));
      if (island != largest[i]) return;
      const auto [low, high] = run.find_range(d, slot(end - begin));
      Interval& within = within_px[i];
      within = {std::min(within.low, low), std::max(within.high, high)};
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
        parts[i].main_pixels += slot(x - first);
      }
    });
  }
  return parts;
}

constexpr std::size_t rank_of(std::size_t percent, std::size_t count) {
  return (percent * (count - 1) + 50) / 100;
}

/// The ranks of the `percent`-th percentile and of its counterpart from the other end: ⌊(p·(n−1) + 50)/100⌋
/// in ascending order, so that a few outliers do not stretch the interval. Reorders `values`, which must not
/// be empty.
Interval without_tails(std::span<float> values, std::size_t percent, const Exec& exec) {
  const std::size_t n = values.size();
  const auto [low, high] = values_at_ranks(values, rank_of(percent, n), rank_of(100 - percent, n), exec);
  return {low, high};
}
constexpr std::size_t kTail = 1;         // %; few points are visible at the far ends of an object's sides
constexpr std::size_t kTailOfDepth = 5;  // %; depth has more outliers than width

float sigma_px(std::span<float> disparities_px, float valid_share, const Exec& exec) {
  const std::size_t n = disparities_px.size();
  const auto [low, high] = values_at_ranks(disparities_px, rank_of(25, n), rank_of(75, n), exec);
  const double logarithm =
      kBias + kSpread * std::log(double{high} - double{low} + 0.1) + kSeen * double{valid_share};
  // The last bit of exp() may differ between processors; rounding removes nearly all such differences.
  return static_cast<float>(std::floor(std::exp(logarithm) * 1024 + 0.5) / 1024);
}

/// Farther points are ignored: their coordinates would overflow when rotated.
constexpr float kMaxDistance = 1e6F;  // m
bool is_near(Vec3 p) {
  return std::abs(p.x) <= kMaxDistance && std::abs(p.y) <= kMaxDistance && std::abs(p.z) <= kMaxDistance;
}

/// Points of a surface, one list per axis.
class Points {
 public:
  explicit Points(std::size_t size) : size_(size) {
    for (auto& list : axis_) list.resize(size);
  }

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] std::span<float> axis(std::size_t i) { return {axis_.at(i).data(), size_}; }
  [[nodiscard]] std::span<const float> axis(std::size_t i) const { return {axis_.at(i).data(), size_}; }
  /// The points from the i-th on.
  [[nodiscard]] kernels::PointLists from(std::size_t i) {
    return {axis_[0].data() + i, axis_[1].data() + i, axis_[2].data() + i};
  }
  /// Moves the near ones of `count` points from the i-th on to the front.
  void keep_near(std::size_t i, int count) {
    std::size_t kept = i;
    for (const std::size_t end = i + slot(count); i < end; ++i) {
      const Vec3 p{axis_[0][i], axis_[1][i], axis_[2][i]};
      if (!is_near(p)) continue;
      axis_[0][kept] = p.x;
      axis_[1][kept] = p.y;
      axis_[2][kept] = p.z;
      ++kept;
    }
  }
  void shrink_to(std::size_t size) { size_ = size; }

 private:
  std::size_t size_;
  std::array<std::vector<float>, 3> axis_;
};

/// The near points of an object's main part, in raster order. `disparities_px(stretch)`: the disparities of
/// its pixels.
template <class Disparities>
Points points_of(const Part& part, Disparities disparities_px, const StereoRig& rig, const Exec& exec) {
  const kernels::PointKernels& run = kernels::point_kernels(exec);
  Points points(part.main_pixels);
  std::size_t count = 0;
  for (const Stretch& stretch : part.main) {
    const int length = stretch.length();
    const int near = run.points_in_camera(rig, {stretch.first, stretch.y}, length, disparities_px(stretch),
                                          kMaxDistance, points.from(count));
    if (near < length) points.keep_near(count, length);
    count += slot(near);
  }
  points.shrink_to(count);
  return points;
}

/// The disparities of an object's main part, each the mean over those in the window of 5 x 5 px around it.
class SmoothSurface {
 public:
  SmoothSurface(const Part& part, View<const float> disparity_px) {
    left_ = disparity_px.width();
    int right = 0;
    for (const Stretch& run : part.main) {
      left_ = std::min(left_, run.first);
      right = std::max(right, run.last);
    }
    top_ = part.main.front().y;
    const int height = part.main.back().y + 1 - top_;
    pitch_ = slot(right - left_) + 2 * kReach;
    values_.resize((slot(height) + 2 * kReach) * pitch_);
    std::vector<float> counts(values_.size());  // 1 or 0
    for (const Stretch& run : part.main) {
      const float* const d = disparity_px.row(run.y);
      std::copy(d + run.first, d + run.last, values_.begin() + at(run));
      std::fill_n(counts.begin() + at(run), run.length(), 1.0F);
    }
    std::vector<float> sums(values_.size());
    for (std::vector<float>* const all : {&values_, &counts}) {
      sum_five(*all, 1, sums);
      sum_five(sums, pitch_, *all);
    }
    for (std::size_t i = 0; i < values_.size(); ++i) values_[i] /= std::max(counts[i], 1.0F);
  }

  [[nodiscard]] const float* disparities_px(const Stretch& run) const { return values_.data() + at(run); }

 private:
  static constexpr std::size_t kReach = 2;  // px

  [[nodiscard]] std::ptrdiff_t at(const Stretch& run) const {
    return static_cast<std::ptrdiff_t>((slot(run.y - top_) + kReach) * pitch_ + slot(run.first - left_) +
                                       kReach);
  }
  /// For values `step` apart. The frame around the surface may have any content.
  static void sum_five(const std::vector<float>& v, std::size_t step, std::vector<float>& sums) {
    for (std::size_t i = 2 * step; i + 2 * step < v.size(); ++i)
      sums[i] = v[i - 2 * step] + v[i - step] + v[i] + v[i + step] + v[i + 2 * step];
  }

  int left_ = 0;
  int top_ = 0;
  std::size_t pitch_ = 0;
  std::vector<float> values_;  // with a frame, to avoid bounds checks at the ends of a row
};

// ---- boxes on the floor ----

/// Points seen from above: their coordinates on the floor.
using Plan = std::array<std::vector<float>, 2>;

/// `count` of the points, drawn at random: every n-th point could come from only a few columns of the image.
Plan plan_of(const Points& points, std::size_t count) {
  constexpr std::uint64_t kStride = 2654435761;  // Knuth's multiplier: 2³² divided by the golden ratio
  Plan plan{std::vector<float>(count), std::vector<float>(count)};
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t i = count < points.size() ? k * kStride % points.size() : k;
    plan[0][k] = points.axis(0)[i];
    plan[1][k] = points.axis(1)[i];
  }
  return plan;
}

/// The intervals of the points along axes turned by a yaw, without the tails.
std::array<Interval, 2> sides_of(std::span<const float> xs, std::span<const float> ys, float cosine,
                                 float sine, Plan& room, const Exec& exec) {
  for (auto& axis : room) axis.resize(xs.size());
  kernels::point_kernels(exec).turn(xs.data(), ys.data(), static_cast<int>(xs.size()), cosine, sine,
                                    room[0].data(), room[1].data());
  return {without_tails(room[0], kTail, exec), without_tails(room[1], kTail, exec)};
}

float length(Interval i) {
  return i.high - i.low;
}
float middle(Interval i) {
  return (i.low + i.high) / 2;
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
  static_assert(rank_of(kTail, kEnough) < kernels::TurnedRectangles::kMaxTail);
  const Plan plan = plan_of(points, std::min(points.size(), kEnough));
  const kernels::PointKernels& run = kernels::point_kernels(exec);
  int best = 0;
  double least = std::numeric_limits<double>::infinity();
  const auto try_all = [&](std::span<const int> all_degrees) {
    kernels::TurnedRectangles turned;
    for (std::size_t k = 0; k < all_degrees.size(); ++k) {
      turned.cosine[k] = std::cos(radians(all_degrees[k]));
      turned.sine[k] = std::sin(radians(all_degrees[k]));
    }
    // The ranks of without_tails(), which are not symmetric for every number of points.
    const std::size_t n = plan[0].size();
    const auto count = static_cast<int>(n);
    run.find_sides(plan[0].data(), plan[1].data(), count, rank_of(kTail, n), n - 1 - rank_of(100 - kTail, n),
                   turned);
    kernels::TurnedRectangles::Each<double> sums;
    run.sum_distances(plan[0].data(), plan[1].data(), count, turned, sums);
    for (std::size_t k = 0; k < all_degrees.size(); ++k) {
      if (!(sums[k] < least)) continue;
      least = sums[k];
      best = all_degrees[k];
    }
  };
  std::array<int, 90 / kCoarse> coarse;
  for (std::size_t k = 0; k < coarse.size(); ++k) coarse[k] = static_cast<int>(k) * kCoarse;
  try_all(coarse);
  std::array<int, 2 * (kCoarse - 1)> fine;
  for (int off = 1; off < kCoarse; ++off) {
    fine[slot(2 * off - 2)] = (best + off) % 90;
    fine[slot(2 * off - 1)] = (best + 90 - off) % 90;
  }
  try_all(fine);
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

FloorBox box_on(const FloorFrame& floor, Points in_camera, const Exec& exec) {
  Points points(in_camera.size());
  kernels::point_kernels(exec).points_in_floor(floor, in_camera.from(0), static_cast<int>(points.size()),
                                               points.from(0));
  int degrees = closest_yaw(points, exec);
  const float yaw = radians(degrees);
  const float c = std::cos(yaw);
  const float s = std::sin(yaw);
  Plan room;
  const auto [u, v] = sides_of(points.axis(0), points.axis(1), c, s, room, exec);
  const Interval up = without_tails(points.axis(2), kTail, exec);
  FloorBox box;
  box.centre_in_floor_m = {c * middle(u) - s * middle(v), s * middle(u) + c * middle(v), middle(up)};
  box.size_m = {std::max(length(u), length(v)), std::min(length(u), length(v)), length(up)};
  if (length(v) > length(u)) degrees -= degrees > 0 ? 90 : -90;
  box.yaw_rad = radians(degrees);
  return box;
}

// ---- objects ----

struct Centroid {
  double x = 0;
  double y = 0;
};

/// The centroid of each object's mask, px.
std::vector<Centroid> centroids_of(const Objects& objects) {
  struct Sums {
    std::int64_t count = 0;
    std::int64_t twice_x = 0;
    std::int64_t y = 0;
  };
  std::vector<Sums> sums(objects.list.size() + 1);
  for (int y = 0; y < objects.labels.height(); ++y) {
    const ObjectId* const row = objects.labels.row(y);
    for (int x = 0; x < objects.labels.width();) {
      const int first = x++;
      while (x < objects.labels.width() && row[x] == row[first]) ++x;
      if (row[first] == ObjectId::none) continue;
      Sums& of = sums[slot(number(row[first]))];
      const std::int64_t run = x - first;
      of.count += run;
      of.twice_x += run * (first + x - 1);
      of.y += run * y;
    }
  }
  std::vector<Centroid> centroids;
  for (std::size_t i = 1; i < sums.size(); ++i) {
    const auto count = static_cast<double>(std::max<std::int64_t>(sums[i].count, 1));
    centroids.push_back(
        {static_cast<double>(sums[i].twice_x) / (2 * count), static_cast<double>(sums[i].y) / count});
  }
  return centroids;
}

void place(Object& object, Centroid centroid, const Part& part, const Image<float>& disparity_px,
           const std::optional<FloorFrame>& floor, const StereoRig& rig, const Exec& exec) {
  object.position_in_camera_m = rig.point_in_camera_m(static_cast<float>(centroid.x),
                                                      static_cast<float>(centroid.y), object.disparity_px);
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

  Points points = points_of(
      part, [&](const Stretch& run) { return disparity_px.row(run.y) + run.first; }, rig, exec);
  if (points.size() == 0) return;
  Points smooth(0);
  if (floor) {
    const SmoothSurface surface(part, disparity_px);  // noise of single pixels would widen the box
    smooth = points_of(
        part, [&](const Stretch& run) { return surface.disparities_px(run); }, rig, exec);
  }
  // At infinity, means may have no position even if single pixels have one.
  if (smooth.size() > 0) {
    object.box_on_floor = box_on(*floor, std::move(smooth), exec);
    const double z = object.position_in_camera_m->z;
    std::array<float, 6>& known = object.box_on_floor->centre_covariance_m2;
    known =
        covariance(*object.box_on_floor, *object.position_in_camera_m,
                   z * z * object.disparity_sigma_px / focal_baseline, kSideSigma * z / rig.focal_px, *floor);
    if (!std::all_of(known.begin(), known.end(), [](float c) { return std::isfinite(c); }))
      object.box_on_floor.reset();
  }
  // Compensates for the removed tails, assuming uniformly spread points.
  const auto span = [&](std::size_t axis, std::size_t tail) {
    return length(without_tails(points.axis(axis), tail, exec)) * 100 / static_cast<float>(100 - 2 * tail);
  };
  object.extent_in_camera_m = Vec3{span(0, kTail), span(1, kTail), span(2, kTailOfDepth)};
}

}  // namespace

Objects locate(Objects objects, const DisparityMap& disparity, const Ground& ground,
               const std::optional<StereoRig>& rig, const Exec& exec) {
  if (objects.list.empty()) return objects;
  std::vector<Part> parts = parts_of(objects, disparity.disparity_px, exec);
  const std::vector<Centroid> centroids =
      rig ? centroids_of(objects) : std::vector<Centroid>(objects.list.size());
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
      if (!rig) continue;
      place(object, centroids[i], parts[i], disparity.disparity_px, floor, *rig, exec);
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
