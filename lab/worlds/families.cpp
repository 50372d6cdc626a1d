// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "lab/worlds/families.hpp"

#include <algorithm>

#include "lab/worlds/families_parts.hpp"

namespace cairn::worlds {

std::span<const Family> families() {
  static const std::vector<Family> all = [] {
    std::vector<Family> made;
    for (const auto list :
         {frame_families, solid_families, living_and_outdoor_families, yardstick_families}) {
      const std::vector<Family> more = list();
      made.insert(made.end(), more.begin(), more.end());
    }
    return made;
  }();
  return all;
}

Mesh finished(Mesh mesh, Dice& dice, int tip_percent, double least_m, double most_m) {
  settle(mesh);
  if (dice.chance(0.5)) {
    mesh = scaled(std::move(mesh), {draw(dice, 0.75, 1.3), draw(dice, 0.75, 1.3), draw(dice, 0.75, 1.3)});
  }
  if (dice.chance(0.15)) mesh = tapered(std::move(mesh), draw(dice, 0.75, 1.2));
  if (dice.chance(0.15)) {
    const float lean = draw(dice, -0.15, 0.15);
    mesh = warped(std::move(mesh), [lean](Vec3 p) { return p + Vec3{lean * p.z, 0, 0}; });
  }
  if (dice.below(100) < tip_percent) {
    mesh = turned(std::move(mesh), kZ, draw(dice, 0, 2 * kPi));
    mesh = turned(std::move(mesh), kX, kPi / 2 * draw(dice, 0.9, 1.1));
  }
  resize(mesh, static_cast<float>(dice.log_uniform(1.001 * least_m, 0.999 * most_m)));
  settle(mesh);
  return mesh;
}

void Bars::operator()(Vec3 from, Vec3 to) const {
  append(mesh, round ? rod(from, to, thickness / 2) : beam(from, to, thickness, thickness), part);
}

void Bars::loop(const Path& corners) const {
  for (std::size_t i = 0; i < corners.size(); ++i) (*this)(corners[i], corners[(i + 1) % corners.size()]);
}

Path ring(int n, float radius, float z, float phase) {
  Path made;
  for (int i = 0; i < n; ++i) made.push_back(polar(radius, turn_of(i, n) + phase, z));
  return made;
}

Path corners(float x, float y, float z) {
  return {{-x, -y, z}, {x, -y, z}, {x, y, z}, {-x, y, z}};
}

Mesh plate(Dice& dice, Vec3 size, float z) {
  Outline outline = rectangle(size.x, size.y);
  const int kind = dice.below(5);
  const float corner = draw(dice, 0.1, 0.5) * std::min(size.x, size.y);
  if (kind == 0) outline = circle(size.x / 2, 32, size.y / size.x);
  if (kind == 1) outline = circle(size.x / 2, dice.between(5, 8), size.y / size.x);
  if (kind == 2) outline = rounded(outline, corner);
  if (kind == 3) return moved(box(size, draw(dice, 0.1, 0.45) * size.z), {0, 0, z});
  return moved(extrusion(outline, size.z), {0, 0, z});
}

void add_legs(Mesh& mesh, Dice& dice, const Path& tops, int part) {
  const int kind = dice.below(5);
  const float height = tops.front().z, thick = height * draw(dice, 0.015, 0.05);
  const float splay = dice.chance(0.5) ? draw(dice, 0.05, 0.4) : 0, bow = draw(dice, -0.25, 0.35);
  const float stretcher = draw(dice, 0.15, 0.6);
  Path joints;
  for (const Vec3 top : tops) {
    const Vec3 foot{top.x * (1 + splay), top.y * (1 + splay), 0};
    const Vec3 out = bow * height * unit({top.x, top.y, 0});
    if (kind == 0) append(mesh, rod(foot, top, thick), part);
    if (kind == 1) append(mesh, beam(foot, top, 2 * thick, 2 * thick), part);
    if (kind == 2) append(mesh, sweep(circle(thick, 12), {foot, top}, {0.5F, 1.3F}), part);
    if (kind == 3) append(mesh, tube(spline({foot, mix(foot, top, 0.5F) + out, top}, 8), thick), part);
    if (kind == 4) append(mesh, sweep(rectangle(2 * thick, 2 * thick), {foot, top}, {0.6F, 1.2F}), part);
    joints.push_back(mix(foot, top, stretcher) + (kind == 3 ? 0.9F : 0.0F) * out);
  }
  if (dice.chance(0.35)) Bars{mesh, thick, kind != 1, part}.loop(joints);
  if (dice.chance(0.15) && tops.size() == 4) {
    Bars{mesh, thick, kind != 1, part}(joints[0], joints[2]);
    Bars{mesh, thick, kind != 1, part}(joints[1], joints[3]);
  }
}

Mesh wheel(float radius, float width, int spokes, float rim) {
  Mesh made = scaled(torus(radius * (1 - rim), radius * rim), {1, 1, width / (2 * radius * rim)});
  append(made, moved(cylinder(radius * 0.15F, width, 12), {0, 0, -width / 2}));
  for (const Vec3 end : ring(spokes, radius * (1 - rim))) append(made, rod({}, end, radius * 0.03F, 6));
  if (spokes == 0) append(made, moved(cylinder(radius * (1 - rim), width / 2, 28), {0, 0, -width / 4}));
  return moved(turned(std::move(made), kX, kPi / 2), {0, 0, radius});
}

Outline hollow(const Outline& outer, float wall) {
  Outline made = outer;
  for (auto p = outer.rbegin(); p != outer.rend(); ++p) {
    const float z = p == outer.rbegin() ? p->y : std::max(p->y, outer.front().y + wall);
    made.push_back({std::max(p->x - wall, 0.0F), z});
  }
  return made;
}

Outline smooth(const Outline& through, int steps) {
  Path path;
  for (const Vec2 p : through) path.push_back({p.x, p.y, 0});
  Outline made;
  for (const Vec3 p : spline(path, steps)) made.push_back({std::max(p.x, 0.0F), p.y});
  return made;
}

Mesh upright(const Outline& outline, float width) {
  return moved(turned(extrusion(outline, width), kX, kPi / 2), {0, width / 2, 0});
}

Mesh leaf(Vec3 from, Vec3 direction, float width, float droop) {
  Path path;
  std::vector<float> scales;
  constexpr int kSteps = 7;
  for (int i = 0; i <= kSteps; ++i) {
    const float t = fraction(i, kSteps);
    path.push_back(from + t * direction - Vec3{0, 0, droop * t * t * length(direction)});
    scales.push_back(i == kSteps ? 0 : 0.12F + std::sin(kPi * std::pow(t, 0.7F)));
  }
  // The blade's broad side lies across the direction.
  const Vec3 across = unit(cross(kZ, direction));
  const bool by_normal = std::abs(across.x) > std::abs(across.y);
  return sweep(by_normal ? rectangle(width, width * 0.06F) : rectangle(width * 0.06F, width), path, scales);
}

Path scribble(Dice& dice, int points, float spread, float lift) {
  Path path;
  Vec3 at;
  float heading = draw(dice, 0, 2 * kPi);
  for (int i = 0; i < points; ++i) {
    path.push_back(at);
    heading += draw(dice, -1.4, 1.6);
    at = at + polar(spread * draw(dice, 0.3, 1), heading);
    at.z = lift * draw(dice, 0, 1);
  }
  return spline(path, 8);
}

void add_figure(Mesh& mesh, Dice& dice, float sitting) {
  const float girth = draw(dice, 0.8, 1.35), shoulder = 0.19F * girth, hip = 0.1F * girth;
  const float leg = draw(dice, 0.72, 0.9), stride = draw(dice, -0.3, 0.3), lean = draw(dice, -0.08, 0.15);
  const Vec3 pelvis{0, 0, sitting > 0 ? 0.45F : leg}, neck = pelvis + Vec3{lean, 0, draw(dice, 0.45, 0.58)};
  append(mesh, limb(pelvis, neck - Vec3{0, 0, 0.1F}, 0.13F * girth, 0.16F * girth), 0);
  append(mesh, moved(ball({0.1F, 0.085F, 0.125F}), neck + Vec3{0.02F, 0, 0.19F}), 2);
  append(mesh, limb(neck, neck + Vec3{0, 0, 0.1F}, 0.055F, 0.05F), 2);
  for (const float side : {-1.0F, 1.0F}) {
    const Vec3 joint = pelvis + Vec3{0, side * hip, 0};
    const float swing = sitting > 0 ? kPi / 2 * sitting : side * stride, bend = draw(dice, 0, 0.3);
    const Vec3 knee = joint + leg / 2 * Vec3{std::sin(swing), side * 0.1F, -std::cos(swing)};
    const float below = sitting > 0 ? draw(dice, -0.3, 0.5) : swing - bend;
    const Vec3 ankle = knee + leg / 2 * Vec3{std::sin(below), 0, -std::cos(below)};
    append(mesh, limb(joint, knee, 0.085F * girth, 0.06F * girth), 1);
    append(mesh, limb(knee, ankle, 0.06F * girth, 0.045F), 1);
    append(mesh, limb(ankle, ankle + Vec3{0.15F, side * 0.02F, -0.02F}, 0.05F, 0.04F), 3);
    const Vec3 top = neck + Vec3{0, side * shoulder, -0.06F};
    const float raise = draw(dice, 0, 1) < 0.75F ? draw(dice, -0.5, 0.7) : draw(dice, 0.7, 2.8);
    const Vec3 elbow = top + 0.28F * Vec3{std::sin(raise), side * draw(dice, 0.1, 0.6), -std::cos(raise)};
    const float fold = raise + draw(dice, 0, 1.6);
    append(mesh, limb(top, elbow, 0.055F * girth, 0.045F), 0);
    append(mesh, limb(elbow, elbow + 0.27F * Vec3{std::sin(fold), 0, -std::cos(fold)}, 0.045F, 0.035F), 2);
  }
}

}  // namespace cairn::worlds
