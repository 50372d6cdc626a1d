// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cairn/core/stereo_pair.hpp>
#include <cairn/pipeline/segment.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <cairn/sequence/warp.hpp>

namespace cairn {

struct TrackedFrame;

/// The indicators of the reliability of a frame, each 0 … 1 or unknown. (docs/stages/reliability.md)
struct Witnesses {
  std::optional<float> stereo;       // share of matches confirmed by the right image
  std::optional<float> photometric;  // similarity of both images at corresponding pixels
  std::optional<float>
      temporal;                // share of objects with the position and size predicted from the frame before
  std::optional<float> floor;  // agreement of the floor with the camera motion; 0 if not found
  std::optional<float> odometry;  // share of corners consistent with the motion; 0 if it was refused
  std::optional<float> scan;      // share of laser beams consistent with the disparities
};

struct WitnessName {
  std::string_view name;
  std::optional<float> Witnesses::*value;
};
inline constexpr std::array kWitnesses{
    WitnessName{"stereo", &Witnesses::stereo},     WitnessName{"photometric", &Witnesses::photometric},
    WitnessName{"temporal", &Witnesses::temporal}, WitnessName{"floor", &Witnesses::floor},
    WitnessName{"odometry", &Witnesses::odometry}, WitnessName{"scan", &Witnesses::scan}};

/// A laser scan in a level plane. Beam i points to first_rad + i·step_rad, counter-clockwise from straight
/// ahead.
struct LaserScan {
  Stamp stamp;
  double first_rad = 0;
  double step_rad = 0;
  std::vector<float> ranges_m;  // NaN or 0: no echo
  Point3 in_level_camera_m;     // position of the laser, x right, y down along gravity, z forward
};

/// The floor relative to the camera.
struct FloorInCamera {
  Point3 up;
  double height_m = 0;  // of the camera above it
};

struct Reliability {
  std::optional<float> value;  // 0 … 1: geometric mean of the known ones
  Witnesses witnesses;
  std::string weakest;                 // name of the lowest of them; empty if none is known
  float steadiness = 0;                // see steadiness()
  int weak_frames = 0;                 // consecutive frames with a value below kUnreliable
  bool is_unreliable = false;          // weak_frames ≥ kUnreliableFrames
  std::optional<FloorInCamera> floor;  // as last seen, relative to the present camera
};
inline constexpr float kUnreliable = 0.5F;
inline constexpr int kUnreliableFrames = 10;
/// Lower limit of a witness, so that a single zero pulls five others of 1 below kUnreliable.
inline constexpr float kMinWitness = 0.01F;

/// The inputs of judge() besides the step.
struct ReliabilityInputs {
  View<const Gray> left;
  View<const Gray> right;               // empty with external disparities
  View<const std::int16_t> best_right;  // see Matches; may be empty
  std::optional<StereoRig> rig;
  bool looks_for_floor = false;  // fitted to each frame, not given
  const LaserScan* scan = nullptr;
};

/// The reliability of a frame from its own data. `warped`: the tracks as predicted; `before`: the result of
/// the frame before. (docs/stages/reliability.md)
Reliability assess_reliability(const TrackedFrame& step, const MaskPrediction& warped,
                               const ReliabilityInputs& evidence, const Reliability& before);

/// The number of objects, weighted by confidence and stability: `temporal`, the witness, times the sum of the
/// confidences of the objects with a confirmed track. A plane of more than 5 % of the image does not count,
/// since walls are steady too. Compares settings on the same frames, as a mean over ten or more.
float steadiness(const TrackedFrame& step, float temporal);

}  // namespace cairn
