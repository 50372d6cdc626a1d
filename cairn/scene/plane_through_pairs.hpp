// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/stereo_pair.hpp>
#include <cairn/scene/ground_plane.hpp>
#include <optional>
#include <span>
#include <vector>

namespace cairn {

/// How far the right pixel of a pair picked by hand may lie from where the plane puts it, px.
inline constexpr double kPairTolerance = 2.0;

struct PairsPlane {
  GroundPlane plane;
  std::vector<PointPair> pairs;  // those that it goes through
};

/// The plane of least squares through the largest set of pairs that agree with one within kPairTolerance
/// (RANSAC; Fischler and Bolles 1981); through all where they are four or fewer. Deterministic: all triples
/// are tried where they are few, else a fixed pseudo-random choice of them. Among sets of equal size it
/// prefers the one whose disparities lie closest to their plane. nullopt where the pairs lie on a line.
std::optional<PairsPlane> plane_through(std::span<const PointPair> pairs);

}  // namespace cairn
