// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <array>
#include <cairn/disparity/background.hpp>
#include <cairn/disparity/row_kernels.hpp>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>

namespace cairn {
namespace {

constexpr int kTrials = 300;
constexpr std::size_t kSample = 600;
constexpr double kBehindWeight = 2.0;  // a point behind a wall speaks against it as two on it speak for it

struct Point3 {
  float x, y, d;
};

/// Minimal standard generator: the same walls on every machine.
class Draw {
 public:
  std::size_t below(std::size_t n) {
    state_ = state_ * 6364136223846793005ULL + 1442695040888963407ULL;
    return static_cast<std::size_t>((state_ >> 33U) % n);
  }

 private:
  std::uint64_t state_ = 0x9E3779B97F4A7C15ULL;
};

float at(const GroundPlane& p, const Point3& q) {
  return p.a * q.x + p.b * q.y + p.c;
}

/// A linear condition k·(a, b, c) = value on planes.
struct Condition {
  std::array<double, 3> k{};
  double value = 0;
};

/// Square on `other`: a plane d = a·x + b·y + c has the normal (a·f, b·f, a·cx + b·cy + c + doffs) in the
/// camera's frame (from 1/Z), and two planes are square on each other where their normals are.
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

/// Some of the points, one array per coordinate, so that several are judged at once.
class Sample {
 public:
  Sample(const std::vector<std::size_t>& chosen, const std::vector<Point3>& points,
         const std::vector<float>& behind) {
    for (const std::size_t i : chosen) {
      x_.push_back(points[i].x);
      y_.push_back(points[i].y);
      d_.push_back(points[i].d);
      behind_.push_back(behind[i]);
    }
  }
  [[nodiscard]] std::size_t size() const { return x_.size(); }
  [[nodiscard]] kernels::PointArrays arrays() const {
    return {x_.data(), y_.data(), d_.data(), behind_.data(), static_cast<int>(size())};
  }

 private:
  std::vector<float> x_, y_, d_, behind_;
};

/// Looks for walls among points; keeps what was found so far.
class WallSearch {
 public:
  /// `rig`: given where the first of `planes` is a floor that walls stand upright on.
  WallSearch(std::vector<Point3> points, std::vector<GroundPlane> planes, std::optional<StereoRig> rig,
             int width, const BackgroundConfig& config, const Exec& exec)
      : run_(kernels::row_kernels(exec)),
        points_(std::move(points)),
        behind_(points_.size(), 0.0F),
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

  /// Adds the best wall; false where none is good enough.
  bool find_next() { return add_best(min_share_); }

  /// Adds the best wall square on the first one. One point tells where such a wall is, so less evidence will
  /// do. For a wall that hardly shows any: a side wall with a window.
  bool find_next_square() {
    if (!rig_ || planes_.size() < 2) return false;
    conditions_.push_back(square(planes_[1], *rig_));
    const bool found = add_best(min_share_square_);
    conditions_.pop_back();
    return found;
  }

  [[nodiscard]] std::vector<GroundPlane> planes() && { return std::move(planes_); }

 private:
  [[nodiscard]] std::vector<std::size_t> in_front() const {
    std::vector<std::size_t> before;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (points_[i].d - behind_[i] > tolerance_) before.push_back(i);
    }
    return before;
  }

  bool add_best(double min_share) {
    const std::vector<std::size_t> before = in_front();
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
    for (std::size_t i = 0; i < points_.size(); ++i) behind_[i] = std::max(behind_[i], at(plane, points_[i]));
  }

  [[nodiscard]] std::vector<std::size_t> sample(const std::vector<std::size_t>& of) {
    if (of.size() <= kSample) return of;
    std::vector<std::size_t> drawn(kSample);
    for (std::size_t& i : drawn) i = of[draw_.below(of.size())];
    return drawn;
  }

  /// Through as many points as the conditions leave free.
  std::optional<GroundPlane> hypothesis(const std::vector<std::size_t>& before) {
    std::array<Condition, 3> all{};
    std::copy(conditions_.begin(), conditions_.end(), all.begin());
    std::array<float, 3> columns{};
    for (std::size_t i = conditions_.size(); i < all.size(); ++i) {
      const Point3& point = points_[before[draw_.below(before.size())]];
      all.at(i) = through(point);
      columns.at(i) = point.x;
      if (i == conditions_.size() + 1 && std::abs(columns.at(i) - columns.at(i - 1)) < least_distance_) {
        return std::nullopt;
      }
    }
    return solve(all);
  }

  std::optional<GroundPlane> best_guess(const std::vector<std::size_t>& before) {
    std::vector<std::size_t> everything(points_.size());
    std::iota(everything.begin(), everything.end(), std::size_t{0});
    const Sample all(sample(everything), points_, behind_);
    const Sample front(sample(before), points_, behind_);
    const double front_share = static_cast<double>(before.size()) / static_cast<double>(points_.size());
    std::optional<GroundPlane> best;
    double best_score = 0;
    for (int trial = 0; trial < kTrials; ++trial) {
      const std::optional<GroundPlane> plane = hypothesis(before);
      if (!plane) continue;
      const int on = run_.count_on(front.arrays(), *plane, 0.7F * tolerance_);
      const double most = front_share * static_cast<double>(on) / static_cast<double>(front.size());
      if (!(most > best_score)) continue;  // what lies beyond can only speak against it
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

  /// Least squares over the wall's own points; the condition of uprightness kept.
  [[nodiscard]] GroundPlane refined(GroundPlane plane, const std::vector<std::size_t>& before) const {
    for (int round = 0; round < 3; ++round) {
      std::array<Condition, 3> normal{};
      double weight = 0;
      for (const std::size_t i : before) {
        const Point3& p = points_[i];
        if (!(std::abs(p.d - at(plane, p)) < 0.7F * tolerance_)) continue;
        const std::array<double, 3> row{p.x, p.y, 1};
        for (std::size_t r = 0; r < 3; ++r) {
          for (std::size_t c = 0; c < 3; ++c) normal[r].k[c] += row[r] * row[c];
          normal[r].value += row[r] * p.d;
        }
        weight += 1;
      }
      if (weight < 3) return plane;
      for (const Condition& condition : conditions_) {  // as an observation so heavy that nothing moves it
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
    std::size_t on = 0;
    std::size_t beyond = 0;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const float d = at(wall, points_[i]);
      if (d > behind_[i] && std::abs(points_[i].d - d) < 0.7F * tolerance_) ++on;
      if (points_[i].d - std::max(behind_[i], d) < -tolerance_) ++beyond;
    }
    const auto all = static_cast<double>(points_.size());
    return static_cast<double>(on) >= min_share * all &&
           static_cast<double>(beyond) <= max_behind_ * static_cast<double>(on);
  }

  const kernels::RowKernels& run_;
  std::vector<Point3> points_;
  std::vector<float> behind_;  // the background's disparity at each point
  std::vector<GroundPlane> planes_;
  std::optional<StereoRig> rig_;
  std::vector<Condition> conditions_;  // that every wall keeps
  float least_distance_;
  float tolerance_;
  double min_share_;
  double min_share_square_;
  double max_behind_;
  Draw draw_;
};

}  // namespace

float Background::disparity_px(float x, float y) const {
  float d = 0;
  for (const GroundPlane& plane : planes) d = std::max(d, plane.disparity_px(x, y));
  return d;
}

Background fit_background(View<const float> evidence_px, const Ground& ground,
                          const std::optional<StereoRig>& rig, const BackgroundConfig& config,
                          const Exec& exec) {
  const Size size = evidence_px.size();
  const float tolerance = config.tolerance * 0.001F * static_cast<float>(size.width);
  std::vector<Point3> points;
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const Point3 point{static_cast<float>(x), static_cast<float>(y), evidence_px(x, y)};
      // What a glossy floor mirrors lies behind every wall and would speak against each.
      const bool mirrored = ground.plane && point.d < at(*ground.plane, point) - tolerance;
      if (!std::isnan(point.d) && !mirrored) points.push_back(point);
    }
  }
  std::vector<GroundPlane> planes;
  if (ground.plane) planes.push_back(*ground.plane);
  WallSearch search(std::move(points), std::move(planes), ground.plane ? rig : std::nullopt, size.width,
                    config, exec);
  for (int i = 0; i < config.max_walls && (search.find_next() || search.find_next_square()); ++i) {
  }
  return {std::move(search).planes(), ground.plane.has_value()};
}

}  // namespace cairn
