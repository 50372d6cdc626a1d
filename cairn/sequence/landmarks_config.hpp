// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/fields.hpp>

namespace cairn {

/// The conditions for a track to become a landmark, and for a landmark to be recognised.
struct LandmarksConfig {
  int min_frames = 8;
  float max_sigma = 0.10F;    // m
  float min_baseline = 0.1F;  // m
  float min_angle = 5.0F;     // degrees
  float gate = 16.3F;         // χ² of 3 degrees of freedom, 0.999
  float min_score = 0.8F;     // similarity of colours
  int min_pairs = 2;          // recognised landmarks that correct the pose
  int relocation_pairs = 3;   // recognised landmarks that determine the pose
  float moved = 0.3F;         // m
  int max_known = 100000;
};
template <class V>
void fields(LandmarksConfig& c, V&& v) {
  v("min_frames", c.min_frames, "frames", "observations of a track before it becomes a landmark",
    range(2, 1000));
  v("max_sigma", c.max_sigma, "m", "largest standard deviation of a landmark's position on the floor",
    range(0.005F, 10.0F));
  v("min_baseline", c.min_baseline, "m",
    "smallest camera travel while observing a landmark, unless min_angle is reached", range(0.0F, 10.0F));
  v("min_angle", c.min_angle, "degrees", "smallest angle between viewpoints, unless min_baseline is reached",
    range(0.0F, 180.0F));
  v("gate", c.gate, "χ²", "largest squared Mahalanobis distance of a recognised landmark",
    range(1.0F, 100.0F));
  v("min_score", c.min_score, "", "smallest colour similarity of a recognised landmark", range(0.0F, 1.0F));
  v("min_pairs", c.min_pairs, "", "smallest number of recognised landmarks that correct the pose",
    range(1, 20));
  v("relocation_pairs", c.relocation_pairs, "",
    "smallest number of recognised landmarks that determine an unknown pose", range(2, 20));
  v("moved", c.moved, "m", "smallest displacement reported as moved", range(0.02F, 100.0F));
  v("max_known", c.max_known, "", "largest number of landmarks in a map", range(1, 1000000));
}

}  // namespace cairn
