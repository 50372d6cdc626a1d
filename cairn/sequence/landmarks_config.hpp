// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/fields.hpp>

namespace cairn {

/// The conditions for a track to become a landmark, and for a landmark to be recognised.
struct LandmarksConfig {
  int min_frames = 8;
  float min_baseline = 0.1F;  // m
  float moved = 0.3F;         // m
  // Constants, not options.
  float max_sigma = 0.25F;   // m; largest standard deviation of a position on the floor
  float min_angle = 5.0F;    // degrees; smallest angle between viewpoints, unless min_baseline is reached
  float gate = 16.3F;        // χ² of 3 degrees of freedom, 0.999
  float min_score = 0.8F;    // similarity of colours of a recognised landmark
  int min_pairs = 2;         // recognised landmarks that correct the pose
  int max_known = 100000;    // landmarks in a map: bounds memory
  int relocation_pairs = 3;  // recognised landmarks that determine an unknown pose
};
template <class V>
void fields(LandmarksConfig& c, V&& v) {
  v("min_frames", c.min_frames, "frames", "observations of a track before it becomes a landmark",
    range(2, 1000));
  v("min_baseline", c.min_baseline, "m", "smallest camera travel before a landmark; 0 for a fixed camera",
    range(0.0F, 10.0F));
  v("moved", c.moved, "m", "smallest displacement reported as moved", range(0.02F, 100.0F));
}

}  // namespace cairn
