// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <vector>

#include <cairn/sequence/landmark_geometry.hpp>

/// Objects that moved, came or left; internal to this library.
namespace cairn::landmarks {

/// find() in a map that may be changed.
Landmark* find_in(LandmarkMap& map, LandmarkId id);

/// Whether two places of one landmark are apart beyond doubt.
bool are_apart(const Eigen::Vector3d& way, const Matrix3& covariance, const LandmarksConfig& config);

/// The frames of this run that show the place of a landmark empty.
std::vector<int> frames_of(const LandmarksState& state, LandmarkId id);

/// The landmark is no longer one that disappeared in this run.
void forget_vanished(LandmarksState& state, LandmarkId id);

/// Pairs landmarks that disappeared with new ones that may be the same object, moved.
std::vector<LandmarkEvent> find_moved(LandmarksState& state, const LandmarkFrame& frame,
                                      const LandmarksConfig& config);

/// Reports landmarks that are where the map had floor, and are not moved ones.
std::vector<LandmarkEvent> report_new(LandmarksState& state, const LandmarkFrame& frame,
                                      const LandmarksConfig& config);

}  // namespace cairn::landmarks
