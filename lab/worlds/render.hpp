// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cairn/core/image.hpp>
#include <cstdint>
#include <vector>

#include "lab/worlds/looks.hpp"
#include "lab/worlds/mesh.hpp"

namespace cairn::worlds {

/// The left camera; the right one is `baseline_m` to its right. Looks along `forward`.
struct Rig {
  Size size;
  float focal_px = 0;
  float cx_px = 0;
  float cy_px = 0;
  float baseline_m = 0;
  Vec3 eye;
  Vec3 right;
  Vec3 down;
  Vec3 forward;
  float right_row_offset_px = 0;  // of the right image only; the truth is without it
};

/// A mesh in the scene: a thing, or a part of the background.
struct Body {
  Mesh mesh;                  // in the scene's coordinates: metres, z up
  std::vector<Vec3> own;      // its points in coordinates of its own, for patterns of volume
  std::array<Look, 4> looks;  // by part
  int id = 0;                 // 0: background
  bool is_ground = false;
  bool is_bright = false;  // a window or a lamp: its colour is seen as it is
};

/// A lamp: a square that shines downward or, with size 0, the sun, far away in direction `at`.
struct Lamp {
  Vec3 at;
  float size_m = 0;
  Vec3 power;
};

struct Scene {
  Rig rig;
  std::vector<Body> bodies;
  std::vector<Lamp> lamps;
  Vec3 ambient;  // light from everywhere
  Vec3 sky_low;  // seen where nothing is hit
  Vec3 sky_high;
  float reach_m = 1.5F;        // ambient light is blocked by what is nearer
  bool has_projector = false;  // of infrared spots, at the left camera, as depth cameras have it
  std::uint64_t seed = 0;
};

/// What one camera sees, linear.
struct Picture {
  Size size;
  std::vector<Vec3> colour;
};

/// Of the left image, at the centres of pixels. Ids, disparity in px (0: sky), 255 where the right camera does not see
/// the point or where the ground is.
struct Truth {
  Image<std::uint8_t> ids;
  Image<float> disparity_px;
  Image<std::uint8_t> occlusion;
  Image<std::uint8_t> ground;
};

struct Rendered {
  Picture left;
  Picture right;
  Truth truth;
};

/// Traces both views with `samples` rays per pixel: the same bits on every processor of one kind.
Rendered render(const Scene& scene, int samples);
/// The truth alone: a twentieth of the time.
Truth truth_of(const Scene& scene);

/// How the sensor turns light into bytes.
struct Sensor {
  float exposure = 1;
  float gamma = 2.2F;
  float blur_px = 0.5F;
  float vignetting = 0;  // darkening at the corners
  float shot_noise = 0;  // σ at white, of 1
  float read_noise = 0;  // σ, of 1
  float right_gain = 1;
  float right_offset = 0;  // of 1
  bool is_grey = false;
  Vec3 grey_weights{0.3F, 0.59F, 0.11F};
};

/// 8-bit RGB.
Image<Rgb> expose(const Picture& picture, const Sensor& sensor, bool is_right, std::uint64_t seed);

}  // namespace cairn::worlds
