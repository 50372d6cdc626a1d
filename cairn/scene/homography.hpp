// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cairn/core/stereo_pair.hpp>
#include <optional>
#include <span>
#include <vector>

namespace cairn {

/// A projective map of the left image onto the right one, row-major: (u, v, 1) ~ h · (x, y, 1).
struct Homography {
  std::array<double, 9> h{};
};

/// Where `homography` sends the left pixel (x, y); not finite where that is at infinity.
std::array<double, 2> map_to_right(const Homography& homography, double x, double y);

/// The homography of least algebraic error over the pairs: the normalised direct linear transform (Hartley
/// 1997). nullopt where the pairs do not determine one: fewer than four, or all but at most one on a line.
std::optional<Homography> fit_homography(std::span<const PointPair> pairs);

/// A homography and the pairs that agree with it.
struct RobustHomography {
  Homography homography;
  std::vector<PointPair> inliers;
};

/// fit_homography over the largest set of pairs that agree within kPairTolerance (RANSAC; Fischler and Bolles
/// 1981). Deterministic: all quadruples are tried where they are few, else a fixed pseudo-random choice of
/// them. Among sets of equal size, which five pairs always leave, it prefers the one whose disparities lie
/// closest to a plane, since that is what the floor of a rectified pair looks like.
std::optional<RobustHomography> fit_homography_robustly(std::span<const PointPair> pairs);

/// Transfer error in the right image, px, that a pair picked by hand may have.
inline constexpr double kPairTolerance = 2.0;

}  // namespace cairn
