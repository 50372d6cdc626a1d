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

#include "warp.hpp"

namespace cairn {

struct Step;

/// What speaks for a frame of a sequence, each 0 … 1 or not known. (docs/stages/reliability.md)
struct Witnesses {
  std::optional<float> stereo;       // matches that the right picture's own confirm
  std::optional<float> photometric;  // how alike both pictures are where they are said to show the same
  std::optional<float> temporal;     // objects that are where, and as large as, the frame before said
  std::optional<float> floor;        // it is found, and where the camera's motion would have it
  std::optional<float> odometry;     // corners that agree with the motion; 0 where it was refused
  std::optional<float> scan;         // beams of a laser that agree with the disparities
};

struct WitnessName {
  std::string_view name;
  std::optional<float> Witnesses::*value;
};
inline constexpr std::array kWitnesses{
    WitnessName{"stereo", &Witnesses::stereo},     WitnessName{"photometric", &Witnesses::photometric},
    WitnessName{"temporal", &Witnesses::temporal}, WitnessName{"floor", &Witnesses::floor},
    WitnessName{"odometry", &Witnesses::odometry}, WitnessName{"scan", &Witnesses::scan}};

/// A laser's scan in a level plane. Beam i looks along first_rad + i·step_rad, from straight ahead to the
/// left.
struct LaserScan {
  Stamp stamp;
  double first_rad = 0;
  double step_rad = 0;
  std::vector<float> ranges_m;  // NaN or 0: nothing was hit
  Point3 in_level_camera_m;     // where the laser is, x right, y down along gravity, z forward
};

/// Where the floor is, seen from the camera.
struct FloorInCamera {
  Point3 up;
  double height_m = 0;  // of the camera over it
};

struct Reliability {
  std::optional<float> value;  // 0 … 1: geometric mean of the known ones
  Witnesses witnesses;
  std::string weakest;                 // name of the least of them; empty where none is known
  float steadiness = 0;                // see steadiness()
  int weak_frames = 0;                 // in a row whose value is below kUnreliable
  bool is_unreliable = false;          // they are kUnreliableFrames or more
  std::optional<FloorInCamera> floor;  // as it was seen last, moved to where the camera is now
};
inline constexpr float kUnreliable = 0.5F;
inline constexpr int kUnreliableFrames = 10;
/// A witness that denies everything counts this much, so that it pulls five others of 1 below kUnreliable.
inline constexpr float kLeastWitness = 0.01F;

/// What judge() looks at beside the step.
struct Evidence {
  StereoPair pair;
  View<const std::int16_t> best_right;  // see Matches; may be empty
  std::optional<StereoRig> rig;
  bool looks_for_floor = false;  // it is fitted to each frame, and not given
  const LaserScan* scan = nullptr;
};

/// How far a frame is to be trusted, by what it shows itself. `warped`: the tracks as they should show;
/// `before`: of the frame before. (docs/stages/reliability.md)
Reliability judge(const Step& step, const Warped& warped, const Evidence& evidence,
                  const Reliability& before);

/// How many objects there are, how surely and how steadily: `temporal`, the witness, times the sum of the
/// confidences of the objects whose tracks count. A plane of more than 5 % of the image counts nothing, since
/// walls are steady, too. Compares settings on the same frames, as a mean over ten or more.
float steadiness(const Step& step, float temporal);

}  // namespace cairn
