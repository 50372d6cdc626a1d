// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "lab/worlds/dice.hpp"
#include "lab/worlds/mesh.hpp"

namespace cairn::worlds {

/// What the renderer needs to know of a point.
struct Surface {
  Vec3 albedo;          // linear, 0 … 1
  float gloss = 0;      // 0 … 1: share of mirror-like reflection at normal incidence
  float roughness = 1;  // 0: a mirror, 1: matt
};

enum class Pattern : std::uint8_t {
  plain,
  two_tone,  // divided by a plane, or banded
  stripes,
  checks,
  dots,
  label,        // marks like print on a rectangle
  wood,         // rings around an axis
  weave,        // threads, coloured as in a plaid
  dead_leaves,  // overlapping shapes of all sizes: the statistics of photographs
  noise,        // two colours mixed by fractal noise
  tiles,        // tiles, slabs and planks with joints
  pebbles,      // gravel, terrazzo, cork: cells with their own colours
  carpet,       // a rectangle with a border on a plain floor
};

inline constexpr int kImageSide = 256;  // px, a power of two

/// kImageSide² colours, repeated on all sides, gamma 2.
using TextureImage = std::shared_ptr<const std::vector<std::array<std::uint8_t, 3>>>;

/// Parameters of a texture; cheap to copy.
struct Look {
  Pattern pattern = Pattern::plain;
  std::array<Vec3, 4> colours{};
  float gloss = 0;
  float roughness = 1;
  Vec2 period{0.1F, 0.1F};  // metres
  float share = 0.5F;       // of the second colour; of tiles: width of the joints in metres
  float variation = 0;      // of tiles and pebbles: how their brightness differs
  float grain = 0;          // of tiles: strength of the wood's grain
  float shift = 0;          // of tiles: by how much of a tile each row is shifted; > 1: at random
  float wear = 0;  // how much the brightness varies over the surface, at all scales below wear_period
  float wear_period = 0.1F;   // metres
  bool checker = false;       // of tiles: two colours
  float marks = 0;            // chance of a flat mark in a square of marks_period
  float marks_period = 0.3F;  // metres
  float marks_edge = 0;       // how soft their edges are: 0 … 1 of their radius
  std::array<Vec3, 2> mark_colours{};
  float rim = 0;  // width of the marks' rims: 0 … 1 of their radius
  float rim_relief =
      0;  // brightness of a rim on the side of its light, and less on the other: a lid, a drain
  Vec3 rim_colour{};
  Vec2 turn{1, 0};  // cosine and sine of the pattern's direction
  Vec3 axis{0, 0, 1};
  std::uint32_t seed = 0;
  TextureImage image;  // of dead leaves, photographs and models
};

/// For a thing or one of its parts: half of them are plain or two-tone.
Look random_look(Dice& dice);
Look floor_look(Dice& dice);
Look wall_look(Dice& dice);
Look masonry_look(Dice& dice);
/// Marks that are no objects: stickers, stains, spots of light or shadow, painted signs; with a rim: lids, drains.
void scatter_marks(Look& look, Dice& dice);
/// Outdoors: asphalt, paving, gravel, lawn.
Look ground_look(Dice& dice);

/// 0 … 1: the spots of a projector in a direction, given as ahead = 1; at most one in each square of 1 / 60.
float spots_at(Vec2 direction);

/// `point` is in the coordinates of the thing, so that patterns of the volume move with it.
Surface surface_at(const Look& look, Vec2 uv, Vec3 point);

}  // namespace cairn::worlds
