// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>

#include "lab/worlds/families_parts.hpp"

/// Families of persons, animals and plants, and of what stands outdoors.
namespace cairn::worlds {
namespace {

void standing_person(Mesh& m, Dice& d) {
  add_figure(m, d, 0);
}

void sitting_person(Mesh& m, Dice& d) {
  add_figure(m, d, draw(d, 0.85, 1.05));
  append(m, moved(plate(d, {0.45F, 0.45F, 0.36F}), {-0.05F, 0, 0}), 3);
}

void quadruped(Mesh& m, Dice& d) {
  const float l = draw(d, 0.25, 0.5), girth = draw(d, 0.1, 0.22), leg = draw(d, 0.15, 0.6),
              step = draw(d, -0.2, 0.2);
  const float thin = draw(d, 0.025, 0.06), head = draw(d, 0.08, 0.16), snout = draw(d, 0.05, 0.3);
  const float chest = girth * draw(d, 0.8, 1.2);
  append(m, limb({-l, 0, leg}, {l, 0, leg + draw(d, -0.05, 0.1)}, girth, chest), 0);
  const Vec3 skull{l + draw(d, 0.1, 0.4), 0, leg + draw(d, 0.1, 0.7)};
  append(m, limb({l, 0, leg}, skull, girth * 0.7F, head * 0.7F), 0);
  append(m, limb(skull, skull + Vec3{snout, 0, -0.3F * snout}, head, head * 0.5F), 1);
  append(
      m,
      tube(spline({{-l, 0, leg}, {-l - 0.2F, 0, leg + draw(d, -0.2, 0.3)}, {-l - 0.3F, 0.1F, leg + 0.1F}}, 6),
           thin),
      0);
  const float ear = draw(d, 0.05, 0.25);
  for (const float side : {-1.0F, 1.0F}) {
    append(m, limb(skull, skull + Vec3{-0.05F, side * head, ear + 0.5F * head}, head * 0.3F, 0.02F, 8), 1);
    for (const float x : {-l, l}) {
      const Vec3 foot{x + side * step, side * girth * 0.6F, 0};
      append(m, limb({x, side * girth * 0.5F, leg}, foot, 1.8F * thin, thin), 2);
    }
  }
}

void bird(Mesh& m, Dice& d) {
  const float l = draw(d, 0.2, 0.45), r = draw(d, 0.13, 0.25), leg = draw(d, 0.05, 0.6),
              neck = draw(d, 0.1, 0.7);
  append(m, limb({-l, 0, leg + r}, {l * 0.4F, 0, leg + 1.3F * r}, r * 0.4F, r), 0);
  const Vec3 head{l * 0.4F + draw(d, 0.05, 0.25), 0, leg + r + neck};
  append(m, limb({l * 0.4F, 0, leg + 1.3F * r}, head, r * 0.5F, r * 0.45F), 0);
  append(m, limb(head, head + Vec3{draw(d, 0.12, 0.4), 0, -0.05F}, r * 0.25F, 0.01F, 8), 1);
  for (const float side : {-1.0F, 1.0F}) {
    append(m, limb({0, side * r * 0.4F, leg + r * 0.6F}, {0, side * r * 0.5F, 0.02F}, 0.025F, 0.02F, 8), 1);
    append(m, limb({-0.05F, side * r * 0.5F, 0.02F}, {0.15F, side * r * 0.7F, 0.02F}, 0.02F, 0.02F, 8), 1);
    append(m,
           leaf({0.1F, side * r * 0.9F, leg + 1.3F * r}, {-1.3F * l, 0, draw(d, -0.1, 0.5)}, 0.7F * r, 0.1F),
           2);
  }
}

void soft_toy(Mesh& m, Dice& d) {
  const float r = draw(d, 0.2, 0.3), head = draw(d, 0.15, 0.28), ear = draw(d, 0.05, 0.14),
              tall = draw(d, 0.8, 4);
  append(m, moved(ball({r * 0.85F, r, r * 1.15F}), {0, 0, r}), 0);
  const Vec3 at{0.03F, 0, 2 * r + head * 0.8F};
  append(m, moved(ball({head, head * 1.1F, head}), at), 0);
  append(m,
         moved(ball({head * 0.5F, head * 0.45F, head * 0.35F}, 10), at + Vec3{head * 0.8F, 0, -0.2F * head}),
         1);
  for (const float side : {-1.0F, 1.0F}) {
    append(m,
           moved(ball({ear * 0.5F, ear, ear * tall}, 10),
                 at + Vec3{0, side * head * 0.75F, head + ear * 0.4F * tall}),
           1);
    append(m,
           limb({0, side * r * 0.8F, 1.6F * r}, {draw(d, -0.1, 0.3), side * r * 1.6F, draw(d, 0.1, 0.6)},
                0.09F, 0.08F),
           0);
    append(m, limb({0.05F, side * r * 0.5F, 0.1F}, {draw(d, 0.25, 0.45), side * r, 0.09F}, 0.11F, 0.1F), 2);
  }
}

void add_pot(Mesh& m, Dice& d, float h) {
  const float r = h * draw(d, 0.3, 0.7), high = r * draw(d, 0.9, 1.6);
  append(m,
         lathe({{r, -h},
                {high, -0.1F * h},
                {high * 1.1F, -0.1F * h},
                {high * 1.1F, 0},
                {high * 0.95F, 0},
                {high * 0.95F, -0.04F * h}}),
         3);
  append(m, rod({0, 0, -0.1F * h}, {0, 0, 0.1F * h}, 0.15F * r), 0);
}

void leafy_plant(Mesh& m, Dice& d) {
  const int n = d.between(5, 40);
  const float stem = draw(d, 0, 0.6), l = draw(d, 0.25, 0.6), w = draw(d, 0.02, 0.16),
              droop = draw(d, 0, 0.8), rise = draw(d, 0.2, 2);
  for (int i = 0; i < n; ++i) {
    const Vec3 out =
        polar(1, 2.4F * static_cast<float>(i) + draw(d, -0.2, 0.2), rise * (0.4F + fraction(i, n)));
    append(m, leaf({0, 0, stem * fraction(i, n)}, l * draw(d, 0.7, 1.2) * unit(out), w, droop),
           i % 5 == 0 ? 1 : 0);
  }
  if (stem > 0.05F) append(m, rod({}, {0, 0, stem}, 0.02F), 2);
  if (d.chance(0.8)) add_pot(m, d, draw(d, 0.1, 0.4));
}

struct Growth {
  float spread = 0;
  float shrink = 0;
  int forks = 2;
  float leaf = 0;  // width; 0: bare
};

void grow(Mesh& m, Dice& d, const Growth& rule, Vec3 from, Vec3 step, float radius, int depth) {
  const Vec3 to = from + step;
  append(m, sweep(circle(radius, 6), {from, to}, {1, rule.shrink}), 0);
  if (rule.leaf > 0 && depth < 2) {
    for (int i = 0; i < 2; ++i) {
      const Vec3 aside{draw(d, -1, 1), draw(d, -1, 1), draw(d, -0.3, 0.8)};
      append(m, leaf(mix(from, to, 0.5F + 0.5F * static_cast<float>(i)), 0.2F * unit(aside), rule.leaf, 0.2F),
             1);
    }
  }
  for (int i = 0; depth > 0 && i < rule.forks; ++i) {
    const Vec3 aside{draw(d, -1, 1), draw(d, -1, 1), draw(d, -0.7, 0.9)};
    const Vec3 next = draw(d, 0.65, 0.95) * length(step) * unit(unit(step) + rule.spread * unit(aside));
    grow(m, d, rule, to, next, radius * rule.shrink, depth - 1);
  }
}

void branch(Mesh& m, Dice& d) {  // bare or with leaves; standing, in a pot, or lying
  const Growth rule{draw(d, 0.4, 1), draw(d, 0.6, 0.85), d.between(2, 3),
                    d.chance(0.5) ? draw(d, 0.02, 0.06) : 0};
  const float h = draw(d, 0.2, 0.5), r = draw(d, 0.02, 0.05);
  grow(m, d, rule, {}, {0, 0, h}, r, rule.forks == 2 ? d.between(3, 5) : 3);
  if (d.chance(0.4)) add_pot(m, d, 0.25F);
}

void cactus(Mesh& m, Dice& d) {
  const int ribs = d.between(6, 14), arms = d.below(4);
  const float r = draw(d, 0.08, 0.3), h = draw(d, 0.3, 1), depth = draw(d, 0.7, 0.9);
  const Outline section = star(ribs, 1, depth);
  append(m,
         sweep(section, {{}, {0, 0, 0.3F * h}, {0, 0, 0.85F * h}, {0, 0, 0.96F * h}, {0, 0, h}},
               {0.8F * r, r, r, 0.6F * r, 0}),
         0);
  for (int i = 0; i < arms; ++i) {
    const float angle = draw(d, 0, 6), z = h * draw(d, 0.2, 0.6), up = draw(d, 0.1, 0.4),
                out = r + draw(d, 0.1, 0.25);
    append(m,
           sweep(circle(0.4F * r, 10),
                 filleted({{0, 0, z}, polar(out, angle, z), polar(out, angle, z + up)}, 0.1F)),
           0);
    append(m, moved(ball({0.4F * r, 0.4F * r, 0.4F * r}, 8), polar(out, angle, z + up)), 0);
  }
  add_pot(m, d, draw(d, 0.15, 0.35));
}

void bouquet(Mesh& m, Dice& d) {
  const int n = d.between(3, 12);
  const float spread = draw(d, 0.1, 0.5), bloom = draw(d, 0.04, 0.12), h = draw(d, 0.3, 0.7);
  for (int i = 0; i < n; ++i) {
    const Vec3 top =
        polar(spread * std::sqrt(fraction(i, n)), 2.4F * static_cast<float>(i), h * draw(d, 0.7, 1.1));
    const Vec3 fork{0.4F * top.x, 0.4F * top.y, 0.6F * top.z};
    append(m, tube(spline({{0, 0, -0.29F}, {}, fork, top}, 5), 0.012F, false, 6), 0);
    append(m, moved(superquadric({bloom, bloom, bloom * draw(d, 0.4, 1.2)}, 1.4F, 1, 8), top), 1 + i % 2);
    append(m, leaf(fork, 0.5F * (top - Vec3{0, 0, 0.8F * top.z}), 0.05F, 0.3F), 0);
  }
  append(m,
         moved(lathe(hollow(smooth({{0.1F, 0}, {draw(d, 0.1, 0.2), 0.15F}, {draw(d, 0.05, 0.12), 0.35F}}),
                            0.01F)),
               {0, 0, -0.3F}),
         3);
}

void tree(Mesh& m, Dice& d) {
  const float trunk = draw(d, 0.5, 1.6), r = draw(d, 0.04, 0.12), crown = draw(d, 0.4, 0.9);
  const Vec3 top{draw(d, -0.2, 0.2), draw(d, -0.2, 0.2), trunk};
  append(m, sweep(circle(r, 10), spline({{}, {0.03F, 0, 0.4F * trunk}, top}, 5), std::vector<float>(11, 1)),
         0);
  const int lumps = d.between(1, 7), boughs = d.between(2, 5);
  for (int i = 0; i < boughs; ++i) {
    append(
        m,
        limb(0.8F * top, top + polar(crown * 0.6F, turn_of(i, boughs), crown * 0.4F), r * 0.6F, r * 0.2F, 8),
        0);
  }
  for (int i = 0; i < lumps; ++i) {
    const Vec3 at = top + Vec3{0, 0, 0.5F * crown} +
                    polar(lumps == 1 ? 0 : 0.6F * crown, 2.4F * static_cast<float>(i), draw(d, 0, 0.5));
    const float size = crown * (lumps == 1 ? 1 : draw(d, 0.4, 0.7)), flat = draw(d, 0.7, 1.3);
    append(m, moved(blob({size, size, size * flat}, 0.25F, 9, d, 26), at), 1);
  }
}

void bush(Mesh& m, Dice& d) {  // of leaves, or clipped
  if (d.chance(0.4)) {
    const float bumps = draw(d, 0.03, 0.2), frequency = draw(d, 4, 14);
    return append(m, blob({draw(d, 0.4, 1), draw(d, 0.4, 1), draw(d, 0.4, 0.8)}, bumps, frequency, d, 32));
  }
  const int n = d.between(80, 260);
  const float l = draw(d, 0.12, 0.3), flat = draw(d, 0.5, 1.3), broad = draw(d, 0.15, 0.4);
  for (int i = 0; i < n; ++i) {
    const Vec3 out = unit({draw(d, -1, 1), draw(d, -1, 1), draw(d, -0.2, 1)});
    const Vec3 aside{draw(d, -0.8, 0.8), draw(d, -0.8, 0.8), draw(d, -0.4, 0.8)};
    append(m, leaf(0.38F * Vec3{out.x, out.y, flat * out.z}, l * unit(out + aside), broad * l, 0.4F), i % 2);
  }
  append(m, blob({0.4F, 0.4F, 0.4F * flat}, 0.1F, 6, d, 14), 0);
}

void car(Mesh& m, Dice& d) {
  const float l = draw(d, 0.85, 1.1), w = draw(d, 0.7, 0.95), hood = draw(d, 0.3, 0.45),
              roof = draw(d, 0.5, 0.7);
  const float front = draw(d, 0.25, 0.5), back = draw(d, -0.75, -0.35), r = draw(d, 0.14, 0.2),
              slope = draw(d, 0.1, 0.4);
  const Outline body{{-l, 0.15F}, {l, 0.15F}, {l * 1.02F, hood * 0.8F}, {front, hood}, {-l, hood}};
  append(m, upright(rounded(body, draw(d, 0.03, 0.12)), w), 0);
  const Outline cabin{{back, hood - 0.02F},
                      {front, hood - 0.02F},
                      {front - slope, roof},
                      {std::max(back + slope * 0.6F, -l), roof}};
  append(m, upright(rounded(cabin, 0.06F), w * 0.88F), 1);
  for (const float x : {-0.62F * l, 0.62F * l}) {
    for (const float y : {-w / 2, w / 2}) append(m, moved(wheel(r, 0.12F, 0, 0.3F), {x, y, 0}), 2);
  }
  for (const float y : {-0.35F * w, 0.35F * w})
    append(m, moved(ball({0.03F, 0.06F, 0.05F}, 8), {l, y, hood * 0.7F}), 3);
}

void bicycle(Mesh& m, Dice& d) {
  const float r = draw(d, 0.22, 0.36), base = draw(d, 0.8, 1.1), seat = draw(d, 0.75, 1),
              t = draw(d, 0.012, 0.03);
  const int spokes = d.between(6, 18);
  const Vec3 rear{0, 0, r}, front{base, 0, r}, crank{base * 0.42F, 0, r * draw(d, 0.7, 1)};
  const Vec3 saddle{base * 0.28F, 0, seat}, head{base * 0.82F, 0, seat * draw(d, 0.8, 1)};
  for (const Vec3 hub : {rear, front}) append(m, moved(wheel(r, 0.05F, spokes, 0.06F), {hub.x, 0, 0}), 1);
  const Bars tube_of{m, 2 * t};
  const Vec3 under = mix(crank, saddle, 0.85F);
  tube_of(crank, saddle), tube_of(rear, crank), tube_of(rear, under),
      tube_of(front, head + Vec3{0, 0, 0.05F});
  tube_of(crank, mix(front, head, 0.75F));
  if (d.chance(0.7)) tube_of(under, head);
  append(m, moved(superquadric({0.13F, 0.06F, 0.03F}, 0.8F, 1.2F, 10), saddle), 2);
  const float bar = draw(d, 0.2, 0.32), back = draw(d, -0.2, 0.2);
  const Vec3 grip = head + Vec3{back, 0, 0.15F};
  append(m,
         tube(filleted({grip + Vec3{-0.1F, -bar, 0}, grip + Vec3{0, -0.1F, 0}, grip + Vec3{0, 0.1F, 0},
                        grip + Vec3{-0.1F, bar, 0}},
                       0.08F),
              t),
         2);
  tube_of(head, grip);
  append(m, moved(turned(cylinder(0.09F, 0.01F), kX, kPi / 2), crank), 2);
  append(m, beam(crank + Vec3{0.12F, 0.05F, -0.1F}, crank + Vec3{-0.12F, -0.05F, 0.1F}, 0.02F, 0.02F), 2);
}

void bollard(Mesh& m, Dice& d) {
  const float r = draw(d, 0.05, 0.2), top = r * draw(d, 0.6, 1.4), cap = draw(d, 0.02, 0.2),
              band = draw(d, 0.05, 0.2);
  const int kind = d.below(3);
  if (kind == 0) {
    append(m,
           lathe(smooth({{r, 0}, {r * 0.8F, 0.1F}, {top, 0.9F}, {top * 0.7F, 0.9F + cap}, {0, 0.95F + cap}})),
           0);
  }
  if (kind == 1) append(m, tapered(box({2 * r, 2 * r, 1}, 0.03F), draw(d, 0.6, 1)), 0);
  if (kind == 2) append(m, frustum(r, top, 1, d.between(6, 24)), 0);
  if (d.chance(0.5)) append(m, moved(cylinder(std::max(r, top) * 1.1F, band), {0, 0, 1 - 2.5F * band}), 1);
  if (d.chance(0.3)) append(m, moved(ball({1.2F * top, 1.2F * top, 1.2F * top}), {0, 0, 1 + top}), 1);
}

void sign(Mesh& m, Dice& d) {
  const float h = draw(d, 0.8, 2.2), w = draw(d, 0.3, 0.7), r = draw(d, 0.015, 0.04),
              yaw = draw(d, -0.4, 0.4);
  const int kind = d.below(4), posts = d.between(1, 2);
  for (int i = 0; i < posts; ++i) {
    const float y = posts == 1 ? 0 : w * (0.6F * static_cast<float>(i) - 0.3F);
    append(m, rod({0, y, 0}, {0, y, h}, r), 0);
  }
  Mesh face =
      kind == 0   ? cylinder(w / 2, 0.02F, 32)
      : kind == 1 ? extrusion(rounded(star(3, w * 0.6F, w * 0.3F), 0.06F), 0.02F)
      : kind == 2
          ? extrusion(rounded(rectangle(w * draw(d, 0.5, 1.6), w), 0.05F), 0.02F)
          : extrusion({{-0.4F * w, -w}, {0.4F * w, -w}, {0.4F * w, w * 0.6F}, {0, w}, {-0.4F * w, w * 0.6F}},
                      0.02F);
  face = turned(turned(face, kZ, kind == 1 ? 0 : kPi / 2), kY, kPi / 2);
  append(m, moved(turned(face, kZ, yaw), {r, 0, h - 0.3F * w}), 1);
  if (d.chance(0.5)) append(m, frustum(0.2F, 0.12F, 0.08F), 2);
}

void waste_bin(Mesh& m, Dice& d) {  // with slats, a lid on wheels, or on a post
  const float w = draw(d, 0.2, 0.35), h = draw(d, 0.5, 1.1);
  const int kind = d.below(3), slats = d.between(8, 18);
  if (kind == 0) {
    m = tapered(box({2 * w, 2 * w, h}, 0.03F), draw(d, 1, 1.3));
    append(m, moved(turned(box({2.5F * w, 2.4F * w, 0.06F}, 0.02F), kY, draw(d, -0.2, 0.1)), {0, 0, h}), 1);
    for (const float y : {-w, w}) append(m, moved(wheel(0.09F, 0.05F, 0, 0.3F), {-w, y, 0}), 2);
  } else if (kind == 1) {
    for (const Vec3 p : ring(slats, w)) {
      append(
          m,
          moved(turned(box({0.02F, 3.5F * w / static_cast<float>(slats), h}), kZ, std::atan2(p.y, p.x)), p),
          0);
    }
    append(m, lathe(hollow({{w * 0.9F, 0.02F}, {w * 0.9F, h * 0.97F}}, 0.01F)), 1);
    append(m, moved(torus(w, 0.03F), {0, 0, h}), 1);
  } else {
    append(m, moved(lathe(hollow({{w * 0.8F, 0}, {w, h * 0.6F}}, 0.012F)), {w, 0, h * 0.5F}), 0);
    append(m, rod({-0.03F, 0, 0}, {-0.03F, 0, 1.2F * h}, 0.04F), 1);
  }
}

void hydrant(Mesh& m, Dice& d) {
  const float r = draw(d, 0.12, 0.22), h = draw(d, 0.5, 0.9);
  append(m,
         lathe({{r * 1.5F, 0},
                {r * 1.5F, 0.06F},
                {r, 0.06F},
                {r * draw(d, 0.8, 1.1), h},
                {r * 1.3F, h},
                {r * 1.3F, h + 0.05F},
                {r * 0.9F, h + 0.12F},
                {0.04F, h + 0.22F}}),
         0);
  append(m, moved(cylinder(0.05F, 0.08F, 6), {0, 0, h + 0.18F}), 1);
  const int arms = d.between(1, 4);
  for (int i = 0; i < arms; ++i) {
    const Vec3 at = polar(r * 0.7F, kPi / 2 * static_cast<float>(i), h * draw(d, 0.6, 0.85)),
               end = polar(r * 1.7F, kPi / 2 * static_cast<float>(i), at.z);
    append(m, rod(at, end, r * 0.45F, 14), 0);
    append(m, rod(mix(at, end, 0.8F), mix(at, end, 1.15F), r * 0.55F, 6), 1);
  }
}

void cone(Mesh& m, Dice& d) {
  const float r = draw(d, 0.15, 0.3), h = draw(d, 0.5, 1), top = draw(d, 0.02, 0.08), low = draw(d, 0.3, 0.5);
  append(
      m,
      d.chance(0.6) ? box({2.7F * r, 2.7F * r, 0.05F}, 0.02F) : cylinder(1.35F * r, 0.05F, d.between(6, 24)),
      2);
  append(m, frustum(r, top, h), 0);
  const auto radius = [&](float t) { return 1.02F * (r + (top - r) * t) + 0.003F; };
  for (const float t : {low, low + 0.25F})
    append(m, moved(frustum(radius(t), radius(t + 0.15F), 0.15F * h), {0, 0, t * h}), 1);
}

void planter(Mesh& m, Dice& d) {  // a trough with plants
  const float x = draw(d, 0.3, 1), y = draw(d, 0.2, 0.5), h = draw(d, 0.25, 0.7);
  append(m, tapered(box({2 * x, 2 * y, h}, 0.02F), draw(d, 1, 1.3)), 0);
  const int n = d.between(1, 5);
  for (int i = 0; i < n; ++i) {
    const float at = n == 1 ? 0 : x * (1.6F * fraction(i, n - 1) - 0.8F), size = draw(d, 0.5, 1) * y;
    append(m, moved(blob({size, size, size * draw(d, 0.6, 2)}, 0.25F, 8, d, 16), {at, 0, h}), 1);
  }
}

void park_bench(Mesh& m, Dice& d) {
  const float w = draw(d, 0.5, 1), h = draw(d, 0.38, 0.48), l = draw(d, 0.35, 0.5), lean = draw(d, 0, 0.3);
  const float back = d.chance(0.7) ? draw(d, 0.25, 0.6) : 0;
  const int slats = d.between(2, 6), stand = d.below(3);
  for (int i = 0; i < slats; ++i) {
    const float pitch = 1 / static_cast<float>(slats), t = pitch * (static_cast<float>(i) + 0.5F);
    append(m, moved(box({0.85F * l * pitch, 2 * w, 0.04F}), {l * t, 0, h}), 1);
    const Vec3 at{-lean * t, -w, h + 0.05F + back * t};
    if (back > 0) append(m, beam(at, at + Vec3{0, 2 * w, 0}, 0.03F, 0.8F * back * pitch), 1);
  }
  for (const float y : {-0.85F * w, 0.85F * w}) {
    if (back > 0) append(m, beam({0.03F, y, h}, {0.03F - lean, y, h + back}, 0.05F, 0.05F), 0);
    if (stand == 0) append(m, moved(box({l, draw(d, 0.05, 0.3), h}), {l * 0.5F, y, 0}), 0);
    if (stand == 1) append(m, tube(filleted({{l, y, 0}, {l, y, h}, {0, y, h}, {0, y, 0}}, 0.08F), 0.025F), 0);
    if (stand == 2) {
      append(m, beam({0, y, 0}, {l * 0.1F, y, h}, 0.05F, 0.05F), 0),
          append(m, beam({l, y, 0}, {l * 0.9F, y, h}, 0.05F, 0.05F), 0);
    }
  }
}

void street_lamp(Mesh& m, Dice& d) {
  const float h = draw(d, 1.5, 3), r = draw(d, 0.03, 0.08), out = draw(d, 0, 1), head = draw(d, 0.1, 0.25);
  append(m, lathe(smooth({{3 * r, 0}, {2.4F * r, 0.1F * h}, {r, 0.15F * h}, {r, h}})), 0);
  const int arms = d.between(1, 2);
  for (int i = 0; i < arms && out > 0.3F; ++i) {
    const float side = i == 0 ? 1.0F : -1.0F;
    append(
        m,
        tube(spline(
                 {{0, 0, 0.9F * h}, {0, 0, h}, {side * out * 0.6F, 0, h * 1.12F}, {side * out, 0, h * 1.1F}},
                 6),
             r * 0.7F),
        0);
    append(m, moved(superquadric({2 * head, head, head * 0.5F}, 0.6F, 0.7F, 12), {side * out, 0, h * 1.1F}),
           1);
  }
  if (out <= 0.3F)
    append(m, moved(superquadric({head, head, head * draw(d, 0.8, 1.6)}, 0.7F, 1, 14), {0, 0, h + head}), 1);
}

}  // namespace

std::vector<Family> living_and_outdoor_families() {
  return {family<standing_person, 150, 1950>("standing person"),
          family<sitting_person, 150, 1400>("sitting person"),
          family<quadruped, 150, 1500>("quadruped"),
          family<bird, 100, 700>("bird"),
          family<soft_toy, 120, 800, rarely>("soft toy"),
          family<leafy_plant, 150, 1400>("leafy plant"),
          family<branch, 200, 1500, rarely>("branch"),
          family<cactus, 100, 900>("cactus"),
          family<bouquet, 150, 800>("bouquet"),
          family<tree, 400, 4000>("tree"),
          family<bush, 250, 1800>("bush"),
          family<car, 150, 4000>("car"),
          family<bicycle, 400, 1800>("bicycle"),
          family<bollard, 250, 1200>("bollard"),
          family<sign, 500, 2500>("sign"),
          family<waste_bin, 250, 1300>("waste bin"),
          family<hydrant, 300, 1000>("hydrant"),
          family<cone, 150, 900, rarely>("cone"),
          family<planter, 300, 1800>("planter"),
          family<park_bench, 500, 2000>("park bench"),
          family<street_lamp, 800, 4000>("street lamp")};
}

}  // namespace cairn::worlds
