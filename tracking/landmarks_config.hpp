// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/fields.hpp>

namespace cairn {

/// Which tracks become landmarks, and when a landmark is recognised.
struct LandmarksConfig {
  int min_frames = 8;
  float max_sigma = 0.10F;    // m
  float min_baseline = 0.1F;  // m
  float min_angle = 5.0F;     // degrees
  float gate = 16.3F;         // χ² of 3 degrees of freedom, 0.999
  float min_score = 0.8F;     // likeness of colours
  int min_pairs = 2;          // recognised landmarks that correct the pose
  int relocation_pairs = 3;   // recognised landmarks that tell the pose
  float moved = 0.3F;         // m
  int max_known = 100000;
};
template <class V>
void fields(LandmarksConfig& c, V&& v) {
  v("min_frames", c.min_frames, "frames", "in which a track must be seen before it becomes a landmark",
    range(2, 1000));
  v("max_sigma", c.max_sigma, "m", "standard deviation of a landmark's position, at most",
    range(0.005F, 10.0F));
  v("min_baseline", c.min_baseline, "m", "camera travel while a landmark is seen, or min_angle",
    range(0.0F, 10.0F));
  v("min_angle", c.min_angle, "degrees", "between viewpoints of a landmark, or min_baseline",
    range(0.0F, 180.0F));
  v("gate", c.gate, "χ²", "largest squared distance at which a landmark is recognised", range(1.0F, 100.0F));
  v("min_score", c.min_score, "", "likeness of colours at which a landmark is recognised", range(0.0F, 1.0F));
  v("min_pairs", c.min_pairs, "", "recognised landmarks that correct the pose", range(1, 20));
  v("relocation_pairs", c.relocation_pairs, "", "recognised landmarks that tell a pose not known before",
    range(2, 20));
  v("moved", c.moved, "m", "shortest displacement reported as moved", range(0.02F, 100.0F));
  v("max_known", c.max_known, "", "landmarks in a map, at most", range(1, 1000000));
}

}  // namespace cairn
