// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "lab/worlds/dice.hpp"
#include "lab/worlds/mesh.hpp"

/// Builders of meshes. Triangles face outward; uv is in metres along the surface. Points are shared where a surface is
/// smooth and doubled at creases. Solids stand on z = 0 around the z axis unless a comment says otherwise.
///
/// The order in which C++ evaluates the arguments of a call differs between compilers. Two draws from the same dice
/// therefore never appear in one call or one expression, only in braces, whose order is defined.
namespace cairn::worlds {

using Outline = std::vector<Vec2>;  // a polygon, counter-clockwise
using Path = std::vector<Vec3>;

inline constexpr float kPi = std::numbers::pi_v<float>;
inline constexpr Vec3 kX{1, 0, 0};
inline constexpr Vec3 kY{0, 1, 0};
inline constexpr Vec3 kZ{0, 0, 1};

inline float draw(Dice& dice, double least, double most) {
  return static_cast<float>(dice.uniform(least, most));
}
/// `i` of `n` as a fraction of a full turn, in radians.
inline float turn_of(int i, int n) {
  return 2 * kPi * static_cast<float>(i) / static_cast<float>(n);
}
inline float fraction(int i, int n) {
  return static_cast<float>(i) / static_cast<float>(n);
}
inline float length(Vec3 a) {
  return std::sqrt(dot(a, a));
}
inline Vec3 unit(Vec3 a) {
  return (1 / std::max(length(a), 1e-12F)) * a;
}
inline Vec3 mix(Vec3 a, Vec3 b, float t) {
  return (1 - t) * a + t * b;
}
/// The point at `angle` on a circle around the z axis.
inline Vec3 polar(float radius, float angle, float z = 0) {
  return {radius * std::cos(angle), radius * std::sin(angle), z};
}

Outline circle(float radius, int n, float stretch = 1);
Outline rectangle(float width, float height);
/// `n` spikes; also gears and regular polygons (inner = outer · cos(π / n)).
Outline star(int n, float outer, float inner);
/// Rounds the corners of an outline.
Outline rounded(const Outline& outline, float radius);
/// Catmull-Rom spline through the points, `steps` pieces between two of them.
Path spline(const Path& through, int steps, bool closed = false);
/// Cuts the corners of a polyline and puts arcs there, as in bent tubes.
Path filleted(const Path& path, float radius);
/// From angle `from` to `to` in the plane of `u` and `v`.
Path arc(Vec3 centre, Vec3 u, Vec3 v, float from, float to, int n);

Mesh box(Vec3 size, float bevel = 0);
/// A box whose faces are divided, for bending.
Mesh slab(Vec3 size, int nx, int ny, int nz = 1);
Mesh frustum(float below, float above, float height, int sides = 24);
Mesh cylinder(float radius, float height, int sides = 24);
/// Turns a profile of (radius, height) around z. It goes up on the outside; ends are closed, or joined if `closed`.
Mesh lathe(const Outline& profile, int sides = 28, bool closed = false);
/// Centred at the origin. Exponents: 1 and 1 an ellipsoid, towards 0 a box, 2 an octahedron.
Mesh superquadric(Vec3 radii, float vertical = 1, float horizontal = 1, int n = 20);
inline Mesh ball(Vec3 radii, int n = 16) {
  return superquadric(radii, 1, 1, n);
}
/// Lies in the xy plane around the origin.
Mesh torus(float radius, float thickness, int sides = 36, int section = 10);
/// Moves a section along a path; `scales` (empty: 1) holds its size at each point of the path.
Mesh sweep(const Outline& section, const Path& path, const std::vector<float>& scales = {},
           bool closed = false);
Mesh tube(const Path& path, float radius, bool closed = false, int sides = 8);
Mesh rod(Vec3 from, Vec3 to, float radius, int sides = 8);
Mesh beam(Vec3 from, Vec3 to, float width, float height);
/// A capsule with two radii.
Mesh limb(Vec3 from, Vec3 to, float radius_from, float radius_to, int sides = 12);
Mesh extrusion(const Outline& outline, float height);
/// An ellipsoid with smooth random bumps, centred at the origin. `frequency` is in waves per radius.
Mesh blob(Vec3 radii, float bumps, float frequency, Dice& dice, int n = 24);

/// `part` < 0 keeps the parts of `other`.
void append(Mesh& mesh, const Mesh& other, int part = -1);
Mesh moved(Mesh mesh, Vec3 by);
Mesh turned(Mesh mesh, Vec3 axis, float angle);
Mesh scaled(Mesh mesh, Vec3 factors);
template <class F>
Mesh warped(Mesh mesh, F&& to) {
  for (Vec3& point : mesh.points) point = to(point);
  return mesh;
}
/// Bends what extends along z towards +x, by `angle` over its height.
Mesh bent(Mesh mesh, float angle);
/// Turns what extends along z about z, by `angle` over its height.
Mesh twisted(Mesh mesh, float angle);
/// Scales x and y by 1 at the bottom to `top` at the top.
Mesh tapered(Mesh mesh, float top);
/// Pushes the surface inwards around some of its points.
Mesh dented(Mesh mesh, Dice& dice, int dents, float depth);

std::array<Vec3, 2> bounds(const Mesh& mesh);
/// Scales the mesh and its uv so that the longest side of its bounding box is `longest`.
void resize(Mesh& mesh, float longest);
/// Moves the lowest point to z = 0 and the centre of the bounding box to x = y = 0.
void settle(Mesh& mesh);

}  // namespace cairn::worlds
