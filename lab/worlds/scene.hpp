// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <string>
#include <vector>

#include "lab/worlds/families.hpp"
#include "lab/worlds/render.hpp"

namespace cairn::worlds {

enum class Place : std::uint8_t { room, table, shelf, clutter, corridor, outdoor };
inline constexpr std::array kPlaces{"room", "table", "shelf", "clutter", "corridor", "outdoor"};

/// One thing of a world.
struct Thing {
  int id = 0;
  std::string kind;
  std::string placed;  // free, wall, on, touch, edge, shelf, row, inside, bars
  Vec3 size_m;
  Vec3 centre;  // of the box around it
};

/// A higher part of the ground: all points on one side of a line.
struct Raised {
  Vec2 edge;
  Vec2 inward;  // unit
  float height_m = 0;
};

/// What to draw worlds of.
struct WorldOptions {
  std::uint64_t seed = 1;
  Use use = Use::fit;
  Size size{320, 240};
  double outdoor_share = 0.25;
};

struct World {
  Place place = Place::room;
  Scene scene;
  Sensor sensor;
  std::vector<Thing> things;
  std::vector<Raised> raised;  // nothing in the yardstick
};

/// World number `index`: depends on the options and the index only.
World make_world(const WorldOptions& options, int index);

inline constexpr int kLaboratorySequences = 4, kLaboratoryFrames = 200;

/// A frame of the paper's experiment made again: a robot drives through a laboratory with a mirroring floor, towards a
/// blue, a yellow and a red object, in that order of ids. In sequence 2 the yellow one stands close in front of the blue
/// one, as in the paper's image c; in sequence 3 there is no red one.
World make_laboratory(int sequence, int frame);

}  // namespace cairn::worlds
