// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/scene/homography.hpp>
#include <cairn/scene/plane_fit.hpp>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace cairn {
namespace {

using Matrix3 = std::array<double, 9>;  // row-major

Matrix3 operator*(const Matrix3& m, const Matrix3& n) {
  Matrix3 product{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      for (std::size_t k = 0; k < 3; ++k) product[3 * i + j] += m[3 * i + k] * n[3 * k + j];
    }
  }
  return product;
}

/// Moves the points' mean to the origin and their mean distance from it to √2.
struct Normalization {
  double scale = 0;
  double x = 0;
  double y = 0;
  [[nodiscard]] Matrix3 matrix() const { return {scale, 0, -scale * x, 0, scale, -scale * y, 0, 0, 1}; }
  [[nodiscard]] Matrix3 inverse() const { return {1 / scale, 0, x, 0, 1 / scale, y, 0, 0, 1}; }
};

template <class GetX, class GetY>
Normalization normalize(std::span<const PointPair> pairs, GetX get_x, GetY get_y) {
  Normalization result;
  const auto n = static_cast<double>(pairs.size());
  for (const auto& pair : pairs) {
    result.x += get_x(pair) / n;
    result.y += get_y(pair) / n;
  }
  double distance = 0;
  for (const auto& pair : pairs) distance += std::hypot(get_x(pair) - result.x, get_y(pair) - result.y) / n;
  result.scale = distance > 0 ? std::sqrt(2.0) / distance : 0;
  return result;
}

/// Eigenvalues and eigenvectors of a symmetric matrix.
template <std::size_t N>
struct Eigen {
  std::array<double, N> values{};
  std::array<std::array<double, N>, N> vectors{};  // vectors[i] belongs to values[i]
};

/// Jacobi's method: rotate the largest symmetric pairs away until the matrix is diagonal. It converges
/// quadratically, so a fixed dozen of sweeps is plenty for N = 9.
template <std::size_t N>
Eigen<N> eigen(std::array<std::array<double, N>, N> m) {
  Eigen<N> result;
  auto& v = result.vectors;
  for (std::size_t i = 0; i < N; ++i) v[i][i] = 1;
  for (int sweep = 0; sweep < 12; ++sweep) {
    for (std::size_t p = 0; p < N; ++p) {
      for (std::size_t q = p + 1; q < N; ++q) {
        if (m[p][q] == 0) continue;
        const double theta = (m[q][q] - m[p][p]) / (2 * m[p][q]);
        const double t = (theta < 0 ? -1 : 1) / (std::abs(theta) + std::hypot(theta, 1.0));
        const double c = 1 / std::hypot(t, 1.0);
        const double s = t * c;
        const auto rotate = [c, s](double& x, double& y) {
          const double old = x;
          x = c * old - s * y;
          y = s * old + c * y;
        };
        for (std::size_t k = 0; k < N; ++k) rotate(m[k][p], m[k][q]);
        for (std::size_t k = 0; k < N; ++k) rotate(m[p][k], m[q][k]);
        for (std::size_t k = 0; k < N; ++k) rotate(v[p][k], v[q][k]);
      }
    }
  }
  for (std::size_t i = 0; i < N; ++i) result.values[i] = m[i][i];
  return result;
}

/// Σ of the outer products of the transform's two equations per pair, in normalised coordinates.
std::array<std::array<double, 9>, 9> normal_matrix(std::span<const PointPair> pairs,
                                                   const Normalization& left, const Normalization& right) {
  std::array<std::array<double, 9>, 9> sum{};
  for (const auto& pair : pairs) {
    const double x = left.scale * (double{pair.x_left} - left.x);
    const double y = left.scale * (double{pair.y_left} - left.y);
    const double u = right.scale * (double{pair.x_right} - right.x);
    const double v = right.scale * (double{pair.y_right} - right.y);
    const std::array<std::array<double, 9>, 2> equations{
        {{-x, -y, -1, 0, 0, 0, u * x, u * y, u}, {0, 0, 0, -x, -y, -1, v * x, v * y, v}}};
    for (const auto& row : equations) {
      for (std::size_t i = 0; i < 9; ++i) {
        for (std::size_t j = 0; j < 9; ++j) sum[i][j] += row[i] * row[j];
      }
    }
  }
  return sum;
}

double cross(double ax, double ay, double bx, double by) {
  return ax * by - ay * bx;
}

/// The weights w with w0·p0 + w1·p1 + w2·p2 ~ p3 in homogeneous coordinates, times a common factor: areas of
/// triangles. nullopt where three of the four lie on a line.
std::optional<std::array<double, 3>> projective_weights(const std::array<std::array<double, 2>, 4>& p) {
  const auto area = [&](std::size_t i, std::size_t j, std::size_t k) {
    return cross(p[j][0] - p[i][0], p[j][1] - p[i][1], p[k][0] - p[i][0], p[k][1] - p[i][1]);
  };
  constexpr double kLeastArea = 1.0;  // px²
  const std::array weights{area(3, 1, 2), area(0, 3, 2), area(0, 1, 3)};
  for (const double w : {weights[0], weights[1], weights[2], area(0, 1, 2)}) {
    if (!(std::abs(w) >= kLeastArea)) return std::nullopt;
  }
  return weights;
}

/// The homography through four pairs, by way of the projective basis that they are; a hundred times the speed
/// of fit_homography.
std::optional<Homography> homography_through(const std::array<PointPair, 4>& pairs) {
  std::array<std::array<double, 2>, 4> p{};
  std::array<std::array<double, 2>, 4> q{};
  for (std::size_t i = 0; i < 4; ++i) {
    p[i] = {pairs[i].x_left, pairs[i].y_left};
    q[i] = {pairs[i].x_right, pairs[i].y_right};
  }
  const auto left = projective_weights(p);
  const auto right = projective_weights(q);
  if (!left || !right) return std::nullopt;
  Matrix3 from_basis{};  // its columns: the right points, weighted
  Matrix3 to_basis{};    // the inverse of the left points, but for a factor
  for (std::size_t i = 0; i < 3; ++i) {
    const double weight = (*right)[i] / (*left)[i];
    from_basis[i] = weight * q[i][0];
    from_basis[3 + i] = weight * q[i][1];
    from_basis[6 + i] = weight;
    const auto& next = p[(i + 1) % 3];
    const auto& last = p[(i + 2) % 3];
    to_basis[3 * i] = next[1] - last[1];
    to_basis[3 * i + 1] = last[0] - next[0];
    to_basis[3 * i + 2] = cross(next[0], next[1], last[0], last[1]);
  }
  return Homography{from_basis * to_basis};
}

double transfer_error(const Homography& homography, const PointPair& pair) {
  const auto [u, v] = map_to_right(homography, pair.x_left, pair.y_left);
  return std::hypot(u - pair.x_right, v - pair.y_right);
}

std::vector<PointPair> agreeing(const Homography& homography, std::span<const PointPair> pairs) {
  std::vector<PointPair> inliers;
  for (const auto& pair : pairs) {
    if (transfer_error(homography, pair) <= kPairTolerance) inliers.push_back(pair);
  }
  return inliers;
}

/// Mean squared distance of the pairs' disparities from their plane.
double distance_from_plane(std::span<const PointPair> pairs) {
  PlaneFit fit(pairs[0].x_left, pairs[0].y_left);
  for (const auto& pair : pairs) fit.add(pair.x_left, pair.y_left, double{pair.x_left} - pair.x_right);
  const auto plane = fit.solve();
  if (!plane) return std::numeric_limits<double>::infinity();
  double sum = 0;
  for (const auto& pair : pairs) {
    const double off = double{pair.x_left} - pair.x_right - plane->disparity_px(pair.x_left, pair.y_left);
    sum += off * off;
  }
  return sum / static_cast<double>(pairs.size());
}

using Quadruple = std::array<std::size_t, 4>;

/// Every quadruple of n things, or a fixed choice of them where they are more than `most`.
std::vector<Quadruple> quadruples(std::size_t n, std::size_t most) {
  std::vector<Quadruple> chosen;
  if (n <= 10) {  // 210 quadruples
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = i + 1; j < n; ++j) {
        for (std::size_t k = j + 1; k < n; ++k) {
          for (std::size_t l = k + 1; l < n; ++l) chosen.push_back({i, j, k, l});
        }
      }
    }
    return chosen;
  }
  std::uint64_t state = 1;
  const auto next = [&] {  // Knuth's MMIX generator; its high bits are the good ones
    state = state * 6364136223846793005U + 1442695040888963407U;
    return static_cast<std::size_t>((state >> 33U) % n);
  };
  while (chosen.size() < most) {
    const Quadruple q{next(), next(), next(), next()};
    const bool distinct =
        q[0] != q[1] && q[0] != q[2] && q[0] != q[3] && q[1] != q[2] && q[1] != q[3] && q[2] != q[3];
    if (distinct) chosen.push_back(q);
  }
  return chosen;
}

}  // namespace

std::array<double, 2> map_to_right(const Homography& homography, double x, double y) {
  const auto& h = homography.h;
  const double w = h[6] * x + h[7] * y + h[8];
  return {(h[0] * x + h[1] * y + h[2]) / w, (h[3] * x + h[4] * y + h[5]) / w};
}

std::optional<Homography> fit_homography(std::span<const PointPair> pairs) {
  if (pairs.size() < 4) return std::nullopt;
  const auto left = normalize(
      pairs, [](const PointPair& p) { return double{p.x_left}; },
      [](const PointPair& p) { return double{p.y_left}; });
  const auto right = normalize(
      pairs, [](const PointPair& p) { return double{p.x_right}; },
      [](const PointPair& p) { return double{p.y_right}; });
  if (left.scale == 0 || right.scale == 0) return std::nullopt;

  const auto solution = eigen(normal_matrix(pairs, left, right));
  std::array<std::size_t, 9> order{0, 1, 2, 3, 4, 5, 6, 7, 8};
  std::sort(order.begin(), order.end(),
            [&](std::size_t i, std::size_t j) { return solution.values[i] < solution.values[j]; });
  // A second null direction: more than one homography fits. Normalised coordinates are of order 1, and points
  // that are off a common line by one pixel in a thousand leave about 1e-6.
  constexpr double kNull = 1e-9;
  if (solution.values[order[1]] < kNull * solution.values[order[8]]) return std::nullopt;
  const Homography homography{right.inverse() * solution.vectors[order[0]] * left.matrix()};
  for (const auto& pair : pairs) {
    if (!std::isfinite(transfer_error(homography, pair))) return std::nullopt;
  }
  return homography;
}

std::optional<RobustHomography> fit_homography_robustly(std::span<const PointPair> pairs) {
  if (pairs.size() <= 4) {
    const auto exact = fit_homography(pairs);
    if (!exact) return std::nullopt;
    return RobustHomography{*exact, {pairs.begin(), pairs.end()}};
  }
  constexpr std::size_t kMostTrials = 300;  // with half the pairs wrong, one in 16 holds four right ones
  std::vector<PointPair> best;
  double best_distance = 0;
  for (const auto& [i, j, k, l] : quadruples(pairs.size(), kMostTrials)) {
    const std::array sample{pairs[i], pairs[j], pairs[k], pairs[l]};
    const auto homography = homography_through(sample);
    if (!homography) continue;
    auto inliers = agreeing(*homography, pairs);
    if (inliers.size() < best.size() || inliers.size() < 4) continue;
    const double distance = distance_from_plane(inliers);
    if (inliers.size() == best.size() && distance >= best_distance) continue;
    best = std::move(inliers);
    best_distance = distance;
  }
  const auto refined = fit_homography(best);
  if (!refined) return std::nullopt;
  return RobustHomography{*refined, std::move(best)};
}

}  // namespace cairn
