// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/stereo_pair.hpp>
#include <cairn/scene/ground_plane.hpp>
#include <optional>
#include <span>
#include <vector>

namespace cairn {

/// The largest distance of a picked right pixel from its position by the plane, px.
inline constexpr double kPairTolerance = 2.0;

struct PairsPlane {
  GroundPlane plane;
  std::vector<PointPair> pairs;  // the inliers
};

/// The least-squares plane of the largest set of pairs that agree with one plane within kPairTolerance
/// (RANSAC; Fischler and Bolles 1981); of all pairs if there are four or fewer. Deterministic: tries all
/// triples if there are few, else a fixed pseudo-random choice. Of sets of equal size the one with the
/// smallest residuals wins. nullopt if the pairs are collinear.
std::optional<PairsPlane> plane_through(std::span<const PointPair> pairs);

}  // namespace cairn
