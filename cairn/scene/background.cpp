// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <array>
#include <cairn/core/pool_memory.hpp>
#include <cairn/core/random.hpp>
#include <cairn/scene/background.hpp>
#include <cairn/scene/plane_kernels.hpp>
#include <cmath>
#include <cstdint>
#include <memory_resource>
#include <utility>

namespace cairn {
namespace {

constexpr int kTrials = 300;
constexpr std::size_t kSample = 600;
constexpr double kBehindWeight = 2.0;  // a point behind a wall cancels two points on it

struct Point3 {
  float x, y, d;
};

/// Points, one array per coordinate, so that several are judged at once; and the background's disparity at
/// each.
struct Points {
  std::pmr::vector<float> x, y, d, behind;
  Points(std::size_t count, std::pmr::memory_resource* memory)
      : x(count, memory), y(count, memory), d(count, memory), behind(count, memory) {}
  [[nodiscard]] std::size_t size() const { return x.size(); }
  [[nodiscard]] Point3 operator[](std::size_t i) const { return {x[i], y[i], d[i]}; }
  void shrink_to(std::size_t count) {
    for (auto* const list : {&x, &y, &d, &behind}) list->resize(count);
  }
  [[nodiscard]] kernels::PointArrays arrays() const {
    return {x.data(), y.data(), d.data(), behind.data(), static_cast<int>(size())};
  }
};

float at(const GroundPlane& p, const Point3& q) {
  return p.a * q.x + p.b * q.y + p.c;
}

/// A linear condition k·(a, b, c) = value on planes.
struct Condition {
  std::array<double, 3> k{};
  double value = 0;
};

/// Perpendicular to `other`: a plane d = a·x + b·y + c has the normal (a·f, b·f, a·cx + b·cy + c + doffs) in the
/// camera's frame (from 1/Z), and two planes are perpendicular if their normals are.
Condition square(const GroundPlane& other, const StereoRig& rig) {
  const double f = rig.focal_px;
  const double nx = other.a * f;
  const double ny = other.b * f;
  const double nz = other.a * rig.cx_px + other.b * rig.cy_px + other.c + rig.doffs_px;
  const double length = std::sqrt(nx * nx + ny * ny + nz * nz);
  return {{(f * nx + rig.cx_px * nz) / length, (f * ny + rig.cy_px * nz) / length, nz / length},
          -rig.doffs_px * nz / length};
}

std::optional<GroundPlane> solve(const std::array<Condition, 3>& c) {
  const auto& [p, q, r] = c;
  const auto det = [](const std::array<double, 3>& u, const std::array<double, 3>& v,
                      const std::array<double, 3>& w) {
    return u[0] * (v[1] * w[2] - v[2] * w[1]) - u[1] * (v[0] * w[2] - v[2] * w[0]) +
           u[2] * (v[0] * w[1] - v[1] * w[0]);
  };
  const double determinant = det(p.k, q.k, r.k);
  if (!(std::abs(determinant) > 1e-6)) return std::nullopt;
  std::array<double, 3> solution{};
  for (std::size_t i = 0; i < 3; ++i) {
    std::array<std::array<double, 3>, 3> m{p.k, q.k, r.k};
    m[0][i] = p.value;
    m[1][i] = q.value;
    m[2][i] = r.value;
    solution[i] = det(m[0], m[1], m[2]) / determinant;
  }
  return GroundPlane{static_cast<float>(solution[0]), static_cast<float>(solution[1]),
                     static_cast<float>(solution[2])};
}

Condition through(const Point3& p) {
  return {{p.x, p.y, 1}, p.d};
}

/// Searches for walls among points, and stores those found.
class WallSearch {
 public:
  /// `rig`: given if the first of `planes` is a floor, to which walls are perpendicular.
  WallSearch(Points points, std::vector<GroundPlane> planes, std::optional<StereoRig> rig, int width,
             const BackgroundConfig& config, const Exec& exec, std::pmr::memory_resource* memory)
      : run_(kernels::plane_kernels(exec)),
        memory_(memory),
        points_(std::move(points)),
        planes_(std::move(planes)),
        rig_(rig),
        least_distance_(0.06F * static_cast<float>(width)),
        tolerance_(config.tolerance * 0.001F * static_cast<float>(width)),
        min_share_(config.min_share * 0.01),
        min_share_square_(config.min_share_square * 0.01),
        max_behind_(config.max_behind * 0.01) {
    for (const GroundPlane& plane : planes_) put_behind(plane);
    if (rig_) conditions_.push_back(square(planes_.front(), *rig_));
  }

  /// Adds the best wall; false if none is good enough.
  bool find_next() { return add_best(min_share_); }

  /// Adds the best wall perpendicular to the first one. A single point determines such a wall, so less
  /// support suffices, for example for a side wall with a window.
  bool find_next_square() {
    if (!rig_ || planes_.size() < 2) return false;
    conditions_.push_back(square(planes_[1], *rig_));
    const bool found = add_best(min_share_square_);
    conditions_.pop_back();
    return found;
  }

  [[nodiscard]] std::vector<GroundPlane> planes() && { return std::move(planes_); }

 private:
  [[nodiscard]] Points in_front() const {
    Points before(points_.size() + 1, memory_);
    std::size_t count = 0;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      before.x[count] = points_.x[i];
      before.y[count] = points_.y[i];
      before.d[count] = points_.d[i];
      before.behind[count] = points_.behind[i];
      count += points_.d[i] - points_.behind[i] > tolerance_ ? 1 : 0;
    }
    before.shrink_to(count);
    return before;
  }

  bool add_best(double min_share) {
    const Points before = in_front();
    const double least = min_share * static_cast<double>(points_.size());
    if (static_cast<double>(before.size()) < least || before.size() < 8) return false;
    const std::optional<GroundPlane> guess = best_guess(before);
    if (!guess) return false;
    const GroundPlane wall = refined(*guess, before);
    if (!good_enough(wall, min_share)) return false;
    planes_.push_back(wall);
    put_behind(wall);
    return true;
  }

  void put_behind(const GroundPlane& plane) {
    run_.put_behind(points_.arrays(), plane, points_.behind.data());
  }

  /// A sample of the points, or all if they are few.
  Points sample(const Points& points) {
    const bool all = points.size() <= kSample;
    Points drawn(all ? points.size() : kSample, memory_);
    for (std::size_t i = 0; i < drawn.size(); ++i) {
      const std::size_t from = all ? i : draw_.below(points.size());
      drawn.x[i] = points.x[from];
      drawn.y[i] = points.y[from];
      drawn.d[i] = points.d[from];
      drawn.behind[i] = points.behind[from];
    }
    return drawn;
  }

  /// A plane through as many points as the conditions leave free.
  std::optional<GroundPlane> hypothesis(const Points& before) {
    std::array<Condition, 3> all{};
    std::copy(conditions_.begin(), conditions_.end(), all.begin());
    std::array<float, 3> columns{};
    for (std::size_t i = conditions_.size(); i < all.size(); ++i) {
      const Point3 point = before[draw_.below(before.size())];
      all.at(i) = through(point);
      columns.at(i) = point.x;
      if (i == conditions_.size() + 1 && std::abs(columns.at(i) - columns.at(i - 1)) < least_distance_) {
        return std::nullopt;
      }
    }
    return solve(all);
  }

  std::optional<GroundPlane> best_guess(const Points& before) {
    const Points all = sample(points_);
    const Points front = sample(before);
    const double front_share = static_cast<double>(before.size()) / static_cast<double>(points_.size());
    std::optional<GroundPlane> best;
    double best_score = 0;
    for (int trial = 0; trial < kTrials; ++trial) {
      const std::optional<GroundPlane> plane = hypothesis(before);
      if (!plane) continue;
      const int on = run_.count_on(front.arrays(), *plane, 0.7F * tolerance_);
      const double most = front_share * static_cast<double>(on) / static_cast<double>(front.size());
      if (!(most > best_score)) continue;  // the remaining points can only lower the score
      const int beyond = run_.count_beyond(all.arrays(), *plane, tolerance_);
      const double score =
          most - kBehindWeight * static_cast<double>(beyond) / static_cast<double>(all.size());
      if (score > best_score) {
        best_score = score;
        best = plane;
      }
    }
    return best;
  }

  /// The normal equations of the points on a plane, and their number.
  struct Normal {
    std::array<Condition, 3> equations{};
    double weight = 0;
  };
  [[nodiscard]] Normal normal_of(const GroundPlane& plane, const Points& before) const {
    std::pmr::vector<float> d_on(before.size(), memory_);
    const kernels::PlaneSums on = run_.sum_on(before.arrays(), plane, 0.7F * tolerance_, d_on.data());
    // Disparities are not integers, so their sums depend on the order.
    double xd = 0;
    double yd = 0;
    double d = 0;
    for (std::size_t i = 0; i < before.size(); ++i) {
      const double here = d_on[i];
      xd += before.x[i] * here;
      yd += before.y[i] * here;
      d += here;
    }
    const auto number = [](std::uint64_t sum) { return static_cast<double>(sum); };
    const double xy = number(on.xy);
    const double x = number(on.x);
    const double y = number(on.y);
    const double count = number(on.count);
    return {{{{{number(on.xx), xy, x}, xd}, {{xy, number(on.yy), y}, yd}, {{x, y, count}, d}}}, count};
  }

  /// Least squares over the wall's own points, keeping it upright.
  [[nodiscard]] GroundPlane refined(GroundPlane plane, const Points& before) const {
    for (int round = 0; round < 3; ++round) {
      auto [normal, weight] = normal_of(plane, before);
      if (weight < 3) return plane;
      for (const Condition& condition : conditions_) {  // as an observation of overwhelming weight
        const double heavy = 1e6 * weight;
        for (std::size_t r = 0; r < 3; ++r) {
          for (std::size_t c = 0; c < 3; ++c) normal[r].k[c] += heavy * condition.k[r] * condition.k[c];
          normal[r].value += heavy * condition.k[r] * condition.value;
        }
      }
      const std::optional<GroundPlane> better = solve(normal);
      if (!better) return plane;
      plane = *better;
    }
    return plane;
  }

  [[nodiscard]] bool good_enough(const GroundPlane& wall, double min_share) const {
    const kernels::PointArrays points = points_.arrays();
    const int on = run_.count_on_before(points, wall, 0.7F * tolerance_);
    if (static_cast<double>(on) < min_share * static_cast<double>(points_.size())) return false;
    return static_cast<double>(run_.count_beyond(points, wall, tolerance_)) <=
           max_behind_ * static_cast<double>(on);
  }

  const kernels::PlaneKernels& run_;
  std::pmr::memory_resource* memory_;
  Points points_;
  std::vector<GroundPlane> planes_;
  std::optional<StereoRig> rig_;
  std::vector<Condition> conditions_;  // for every wall
  float least_distance_;
  float tolerance_;
  double min_share_;
  double min_share_square_;
  double max_behind_;
  Random draw_;
};

/// The textured pixels, in raster order, without reflections on a glossy floor: these are behind every wall
/// and would count against it.
Points points_of(View<const float> textured_px, const std::optional<GroundPlane>& floor, float tolerance,
                 std::pmr::memory_resource* memory) {
  std::size_t most = 0;
  for (int y = 0; y < textured_px.height(); ++y) {
    const float* const row = textured_px.row(y);
    most += static_cast<std::size_t>(
        std::count_if(row, row + textured_px.width(), [](float d) { return !std::isnan(d); }));
  }
  Points points(most + 1, memory);
  std::size_t count = 0;
  for (int y = 0; y < textured_px.height(); ++y) {
    const float* const row = textured_px.row(y);
    for (int x = 0; x < textured_px.width(); ++x) {
      const Point3 point{static_cast<float>(x), static_cast<float>(y), row[x]};
      points.x[count] = point.x;
      points.y[count] = point.y;
      points.d[count] = point.d;
      const bool mirrored = floor && point.d < at(*floor, point) - tolerance;
      count += !std::isnan(point.d) && !mirrored ? 1 : 0;
    }
  }
  points.shrink_to(count);
  return points;
}

}  // namespace

float Background::disparity_px(float x, float y) const {
  float d = 0;
  for (const GroundPlane& plane : planes) d = std::max(d, plane.disparity_px(x, y));
  return d;
}

Background fit_background(View<const float> textured_px, const Ground& ground,
                          const std::optional<StereoRig>& rig, const BackgroundConfig& config,
                          const Exec& exec) {
  const int width = textured_px.width();
  PoolMemory memory(exec.pool);
  std::vector<GroundPlane> planes;
  if (ground.plane) planes.push_back(*ground.plane);
  const float tolerance = wall_tolerance_px(config, textured_px.size());
  WallSearch search(points_of(textured_px, ground.plane, tolerance, &memory), std::move(planes),
                    ground.plane ? rig : std::nullopt, width, config, exec, &memory);
  for (int i = 0; i < config.max_walls && (search.find_next() || search.find_next_square()); ++i) {
  }
  return {std::move(search).planes(), ground.plane.has_value()};
}

}  // namespace cairn
