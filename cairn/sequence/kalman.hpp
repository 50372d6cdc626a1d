// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/sequence/tracks.hpp>

/// The two filters of a track (Kalman 1960). Private to the library.
namespace cairn {

/// A static object: its position wanders by static_noise·√dt.
Filter3 predicted(const Filter3& filter, double dt_s, double static_noise);
/// A moving object: its acceleration is constant within a step and independent from step to step, with the
/// standard deviation `acceleration_noise` (Bar-Shalom 2001, section 6.3.2).
Filter6 predicted(const Filter6& filter, double dt_s, double acceleration_noise);

/// The fit of a measured position to a predicted one with covariance `expected_m2`.
struct Innovation {
  double d2 = 0;              // Mahalanobis distance, squared
  double log_widening = 0;    // ln(|expected + measured| / |measured|) ≥ 0
  double log_likelihood = 0;  // of the position, natural logarithm
};
Innovation innovation(Point3 expected_m, const Covariance3& expected_m2, Point3 measured_m,
                      const Covariance3& measured_m2);
/// ln(|measured| / |(0.15 m)²·I|), at least 0: how little such a place says about what is there.
double log_vagueness(const Covariance3& measured_m2);
/// The upper left block: the covariance of the position.
Covariance3 of_position(const Filter6& filter);

Filter3 updated(const Filter3& filter, Point3 measured_m, const Covariance3& measured_m2);
Filter6 updated(const Filter6& filter, Point3 measured_m, const Covariance3& measured_m2);

/// The covariance of a point of the camera frame in the map: R·C·Rᵀ + J·P·Jᵀ. `pose_covariance`: of the
/// translation of the camera and of its rotation about itself, both along the axes of the map.
Covariance3 in_map(const Covariance3& in_camera_m2, Point3 point_in_camera_m, const Pose& map_from_camera,
                   const Covariance6& pose_covariance);

/// A static object seen from a new side: the centre of its visible surface moves around it with the camera, on
/// the floor, by a share of its width, and is less certain. (nearer_surface)
Filter3 moved_viewpoint(Filter3 filter, Vec3 extent_m, Point3 seen_from_m, Point3 camera_m);

/// A linear motion through positions (least squares, constant weights).
struct Drift {
  Point3 velocity_m_s;
  double sigma_m_s = 0;  // of the speed, along the velocity, for independent position errors
};
/// From three or more places, not all with the same stamp.
Drift drift_of(const std::vector<Place>& places);

}  // namespace cairn
