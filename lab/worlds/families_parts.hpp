// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <string_view>
#include <vector>

#include "lab/worlds/families.hpp"
#include "lab/worlds/shapes.hpp"

/// What the files that define the families share. A family is a function that adds a shape to an empty mesh, in any
/// unit, anywhere; `family` scales, wears and places it.
namespace cairn::worlds {

/// Chance in percent that a thing lies instead of standing.
enum Tips : std::uint8_t { never = 0, rarely = 12, often = 45 };

Mesh finished(Mesh mesh, Dice& dice, int tip_percent, double least_m, double most_m);

template <void (*shape)(Mesh&, Dice&), int least_mm, int most_mm, Tips tips = never>
Family family(std::string_view name, Use use = Use::fit) {
  const auto make = [](Dice& dice) {
    Mesh mesh;
    shape(mesh, dice);
    return finished(std::move(mesh), dice, tips, least_mm * 1e-3, most_mm * 1e-3);
  };
  return {name, use, least_mm * 1e-3, most_mm * 1e-3, make};
}

std::vector<Family> frame_families();
std::vector<Family> solid_families();
std::vector<Family> living_and_outdoor_families();
std::vector<Family> yardstick_families();

/// Adds straight bars of one kind.
struct Bars {
  Mesh& mesh;
  float thickness = 0;
  bool round = true;
  int part = 0;

  void operator()(Vec3 from, Vec3 to) const;
  void loop(const Path& corners) const;
};
/// `n` points around the z axis.
Path ring(int n, float radius, float z = 0, float phase = 0);
Path corners(float x, float y, float z);
/// A table top or seat of random outline whose lower side is at `z`.
Mesh plate(Dice& dice, Vec3 size, float z = 0);
/// Legs of one random kind from `tops` down to z = 0, often joined by bars.
void add_legs(Mesh& mesh, Dice& dice, const Path& tops, int part);
/// A wheel that stands on z = 0 with its axle along y; no spokes: a disc.
Mesh wheel(float radius, float width, int spokes, float rim = 0.12F);
/// A vessel: the outer profile from the bottom up, then a wall's thickness inside it down again.
Outline hollow(const Outline& outer, float wall);
Outline smooth(const Outline& through, int steps = 6);
/// An outline in the xz plane as thick as `width` along y.
Mesh upright(const Outline& outline, float width);
/// A flat blade that begins at `from` and droops.
Mesh leaf(Vec3 from, Vec3 direction, float width, float droop);
/// A line through random points near the floor, as a dropped cable lies.
Path scribble(Dice& dice, int points, float spread, float lift);
/// A person: joints of capsules. `sitting` is 0 … 1.
void add_figure(Mesh& mesh, Dice& dice, float sitting);

}  // namespace cairn::worlds
