// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>

#include "lab/worlds/families_parts.hpp"

/// Families of the yardstick: shapes that no family of the fit has.
namespace cairn::worlds {
namespace {

Path coiled(float low, float high, float height, float turns, int steps) {
  Path made;
  for (int i = 0; i <= steps; ++i) {
    const float t = fraction(i, steps);
    made.push_back(polar(low + (high - low) * t, 2 * kPi * turns * t, height * t));
  }
  return made;
}

void deck_chair(Mesh& m, Dice& d) {  // crossed frames with a sling
  const float w = draw(d, 0.2, 0.35), h = draw(d, 0.5, 0.9), l = draw(d, 0.7, 1.1), sag = draw(d, 0.05, 0.25);
  const Bars bar{m, draw(d, 0.025, 0.05), d.chance(0.5)};
  for (const float y : {-w, w}) bar({0, y, 0}, {l, y, h * 0.4F}), bar({l * 0.8F, y, 0}, {-0.1F, y, h});
  bar({l, -w, h * 0.4F}, {l, w, h * 0.4F}), bar({-0.1F, -w, h}, {-0.1F, w, h}), bar({0, -w, 0}, {0, w, 0});
  append(m,
         warped(slab({1, 1.8F * w, 0.01F}, 16, 2),
                [&](Vec3 p) {
                  const float t = p.x + 0.5F;
                  return Vec3{-0.1F + (l + 0.1F) * t, p.y, h * (1 - 0.6F * t) - 4 * sag * t * (1 - t) + p.z};
                }),
         1);
}

void umbrella(Mesh& m, Dice& d) {  // open or shut
  const int ribs = d.between(6, 10);
  const float open = d.chance(0.6) ? draw(d, 0.5, 0.9) : draw(d, 0.06, 0.12), drop = 0.9F - 0.7F * open,
              r = 0.012F;
  Outline line =
      smooth({{open, -drop}, {open * 0.75F, -drop * 0.4F}, {open * 0.4F, -drop * 0.1F}, {0.01F, 0}});
  for (std::size_t i = line.size(); i-- > 0;) line.push_back({line[i].x, line[i].y - 0.012F});
  append(m,
         warped(lathe(line, 4 * ribs, true),
                [&](Vec3 p) {
                  const float valley = std::sin(0.5F * static_cast<float>(ribs) * std::atan2(p.y, p.x)),
                              scale = 1 - 0.12F * valley * valley;
                  return Vec3{p.x * scale, p.y * scale, p.z};
                }),
         1);
  append(m, rod({0, 0, 0.08F}, {0, 0, -0.9F}, r), 0);
  append(m, tube(arc({0.08F, 0, -0.9F}, -0.08F * kX, -0.08F * kZ, 0, kPi, 10), 1.6F * r), 0);
  m = turned(m, kX, d.chance(0.4) ? 1.9F : kPi * draw(d, 0.5, 1));
}

void teapot(Mesh& m, Dice& d) {
  const float r = draw(d, 0.35, 0.6), h = draw(d, 0.5, 1), top = draw(d, 0.12, 0.3), out = draw(d, 0.25, 0.5);
  append(m, lathe(smooth({{r * 0.6F, 0}, {r, h * 0.35F}, {r * 0.85F, h * 0.7F}, {top, h}})), 0);
  append(m,
         moved(lathe(smooth({{top, 0}, {top * 0.7F, 0.05F}, {0.04F, 0.08F}, {0.07F, 0.14F}, {0, 0.18F}})),
               {0, 0, h}),
         1);
  append(m,
         sweep(circle(0.09F, 12),
               spline({{r * 0.8F, 0, h * 0.3F}, {r + 0.15F, 0, h * 0.45F}, {r + 0.35F, 0, h * 0.95F}}, 6),
               std::vector<float>{1.4F, 1.3F, 1.2F, 1.1F, 1, 1, 0.9F, 0.8F, 0.7F, 0.7F, 0.6F, 0.6F, 0.6F}),
         0);
  append(m,
         tube(filleted({{-r * 0.7F, 0, h * 0.75F},
                        {-r - out, 0, h * 0.8F},
                        {-r - out * 0.6F, 0, h * 0.25F},
                        {-r * 0.8F, 0, h * 0.25F}},
                       0.2F),
              draw(d, 0.03, 0.07)),
         1);
}

void wheelbarrow(Mesh& m, Dice& d) {
  const float w = draw(d, 0.2, 0.32), r = draw(d, 0.14, 0.22), l = draw(d, 0.5, 0.7), h = draw(d, 0.35, 0.5),
              flare = draw(d, 1.2, 1.7);
  const Mesh tray = lathe(hollow({{0.7F, 0}, {0.7F * flare, draw(d, 0.2, 0.35)}}, 0.02F), 4);
  append(m, moved(scaled(turned(tray, kZ, kPi / 4), {l, w * 1.6F, 1}), {0.5F * l, 0, h - 0.05F}), 1);
  append(m, moved(wheel(r, 0.07F, d.below(2) * 6, 0.3F), {1.35F * l, 0, 0}), 2);
  const Bars bar{m, 0.04F};
  for (const float side : {-1.0F, 1.0F}) {
    bar({-0.8F * l, side * w, h + 0.15F}, {0.2F * l, side * w, h - 0.05F}),
        bar({0.2F * l, side * w, h - 0.05F}, {1.35F * l, side * 0.06F, r});
    append(m,
           tube(filleted({{0.1F, side * w, h}, {0, side * w, 0}, {0.25F, side * w, 0}, {0.35F, side * w, h}},
                         0.06F),
                0.02F),
           0);
  }
}

void coat_stand(Mesh& m, Dice& d) {
  const float h = draw(d, 1.2, 1.9), r = draw(d, 0.015, 0.035);
  const int hooks = d.between(3, 8), feet = d.between(3, 4);
  append(m, rod({0, 0, 0.1F}, {0, 0, h}, r), 0);
  const float out = draw(d, 0.12, 0.3), up = draw(d, 0.1, 0.25), foot = draw(d, 0.2, 0.35);
  for (int i = 0; i < hooks; ++i) {
    const float z = h * (i % 2 == 0 ? 0.95F : 0.8F), a = turn_of(i, hooks);
    append(m, tube(spline({{0, 0, z}, polar(out * 0.6F, a, z - 0.06F), polar(out, a, z + up)}, 6), r * 0.6F),
           1);
  }
  for (int i = 0; i < feet; ++i) {
    append(m,
           tube(spline({{0, 0, 0.3F},
                        polar(foot * 0.5F, turn_of(i, feet), 0.16F),
                        polar(foot, turn_of(i, feet), 0)},
                       6),
                r),
           0);
  }
}

void candelabra(Mesh& m, Dice& d) {
  const int arms = d.between(2, 7);
  const bool flat = d.chance(0.5);
  const float h = draw(d, 0.4, 0.8), candle = draw(d, 0.05, 0.3), r = draw(d, 0.015, 0.03),
              w = draw(d, 0.2, 0.5);
  append(m, lathe(smooth({{0.2F, 0}, {0.06F, 0.06F}, {r, 0.15F}, {r, h}})), 0);
  for (int i = 0; i < arms; ++i) {
    const float t = arms == 1 ? 0 : 2 * fraction(i, arms - 1) - 1;
    const Vec3 out = flat ? Vec3{w * t, 0, 0} : polar(w, turn_of(i, arms)), tip = out + Vec3{0, 0, h};
    append(
        m,
        tube(spline({{0, 0, h * 0.5F}, 0.6F * out + Vec3{0, 0, h * 0.55F}, out + Vec3{0, 0, h * 0.75F}, tip},
                    6),
             r),
        0);
    append(m, moved(frustum(0.02F, 0.06F, 0.04F, 14), tip), 0);
    append(m, moved(cylinder(0.025F, candle + 0.05F, 10), tip), 1);
  }
}

void hourglass(Mesh& m, Dice& d) {
  const float r = draw(d, 0.2, 0.35), neck = draw(d, 0.02, 0.1), plate = r * draw(d, 1.1, 1.4),
              t = draw(d, 0.03, 0.1);
  append(m, lathe(smooth({{r * 0.8F, 0}, {r, 0.2F}, {neck, 0.5F}, {r, 0.8F}, {r * 0.8F, 1}})), 1);
  for (const float z : {-t, 1.0F}) append(m, moved(cylinder(plate, t, d.between(5, 28)), {0, 0, z}), 0);
  for (const Vec3 p : ring(d.between(3, 5), plate * 0.88F)) append(m, rod(p, p + kZ, 0.025F), 0);
}

void coil(Mesh& m, Dice& d) {
  const float low = draw(d, 0.15, 0.5), high = draw(d, 0.1, 0.5), h = draw(d, 0.4, 1.4),
              turns = draw(d, 2.5, 8), gap = h / turns;
  append(m, tube(coiled(low, high, h, turns, static_cast<int>(20 * turns)), gap * draw(d, 0.12, 0.4)));
}

void knot(Mesh& m, Dice& d) {
  const int p = d.between(2, 3), q = p == 2 ? d.pick({3, 5}) : d.pick({2, 4, 5});
  const float inner = draw(d, 0.25, 0.5);
  Path path;
  for (int i = 0; i < 140; ++i) {
    const float a = turn_of(i, 140), b = static_cast<float>(q) * a;
    path.push_back(polar(1 + inner * std::cos(b), static_cast<float>(p) * a, inner * std::sin(b)));
  }
  append(m, tube(path, draw(d, 0.06, 0.2), true, 10));
}

void nested_rings(Mesh& m, Dice& d) {  // a globe of rings, or a ball in a bow
  const int n = d.between(2, 6);
  const float thick = draw(d, 0.02, 0.05), core = draw(d, 0.15, 0.85), tilt = draw(d, 0, 1);
  for (int i = 0; i < n; ++i) {
    const float yaw = draw(d, 0, kPi), lean = kPi / 2;
    append(m, turned(turned(torus(1 - 0.06F * static_cast<float>(i), thick), kX, lean), kZ, yaw), 0);
  }
  append(m, turned(torus(0.95F, thick), kX, tilt), 1);
  append(m, rod({0, 0, -1}, {0, 0, 1}, 0.02F), 1);
  append(m, ball({core, core, core}, 20), 2);
  append(m, moved(lathe(smooth({{0.5F, -0.5F}, {0.1F, -0.4F}, {0.06F, 0}})), {0, 0, -0.95F}), 1);
}

void truss(Mesh& m, Dice& d) {
  const int bays = d.between(3, 9), sides = d.between(3, 4);
  const float r = draw(d, 0.12, 0.3), l = draw(d, 0.2, 0.4);
  const Bars bar{m, draw(d, 0.02, 0.05)};
  for (int k = 0; k < bays; ++k) {
    const Path low = ring(sides, r, l * static_cast<float>(k)),
               high = ring(sides, r, l * static_cast<float>(k + 1));
    bar.loop(high);
    if (k == 0) bar.loop(low);
    for (std::size_t i = 0; i < low.size(); ++i)
      bar(low[i], high[i]), bar(low[i], high[(i + (k % 2 == 0 ? 1 : low.size() - 1)) % low.size()]);
  }
  if (d.chance(0.5)) m = turned(m, kY, kPi / 2);
}

void pagoda(Mesh& m, Dice& d) {
  const int n = d.between(3, 7), sides = d.between(4, 6);
  float z = 0, r = draw(d, 0.3, 0.6);
  const float eave = draw(d, 1.25, 1.9), shrink = draw(d, 0.68, 0.9), h = draw(d, 0.1, 0.3);
  for (int i = 0; i < n; ++i) {
    append(m, moved(cylinder(r, h, sides), {0, 0, z}), 0);
    append(m,
           moved(lathe(smooth({{r * eave, 0.02F}, {r * 1.1F, h * 0.25F}, {r * shrink, h * 0.6F}}), sides),
                 {0, 0, z + h}),
           1);
    z += h * 1.5F, r *= shrink;
  }
  append(m, moved(frustum(r * 0.5F, 0, 2 * h, 8), {0, 0, z}), 1);
}

void rocking_horse(Mesh& m, Dice& d) {
  const float w = draw(d, 0.12, 0.2), leg = draw(d, 0.3, 0.45), arch = draw(d, 0.1, 0.25);
  for (const float y : {-w, w}) {
    Path runner = arc({0, y, arch + 0.05F}, 0.75F * kX, -arch * kZ, 0.1F, kPi - 0.1F, 16);
    append(m, sweep(rectangle(0.05F, 0.06F), runner), 1);
    for (const float x : {-0.3F, 0.3F})
      append(m, beam({1.3F * x, y, 0.06F}, {x, y * 0.5F, leg}, 0.06F, 0.06F), 0);
  }
  append(m, limb({-0.3F, 0, leg}, {0.3F, 0, leg}, 0.13F, 0.13F), 0);
  append(m, limb({0.3F, 0, leg}, {0.45F, 0, leg + 0.35F}, 0.1F, 0.08F), 0);
  append(m, limb({0.45F, 0, leg + 0.35F}, {0.65F, 0, leg + draw(d, 0.15, 0.3)}, 0.09F, 0.06F), 0);
  append(m, rod({0.42F, -0.25F, leg + 0.22F}, {0.42F, 0.25F, leg + 0.22F}, 0.02F), 2);
  append(m, leaf({-0.4F, 0, leg}, {-0.3F, 0, 0.05F}, 0.06F, 0.7F), 2);
}

void guitar(Mesh& m, Dice& d) {
  const float low = draw(d, 0.25, 0.35), waist = draw(d, 0.14, 0.22), high = draw(d, 0.18, 0.28),
              neck = draw(d, 0.4, 0.7), t = draw(d, 0.05, 0.16);
  Path side;
  for (const Vec2 p : {Vec2{0, 0},
                       {low, 0.2F},
                       {waist, 0.5F},
                       {high, 0.72F},
                       {0, 0.9F},
                       {-high, 0.72F},
                       {-waist, 0.5F},
                       {-low, 0.2F}})
    side.push_back({p.x, p.y, 0});
  Outline body;
  for (const Vec3 p : spline(side, 6, true)) body.push_back({p.x, p.y});
  append(m, upright(body, t), 0);
  append(m, beam({0, -t / 2, 0.5F}, {0, -t / 2, 0.9F + neck}, 0.06F, 0.05F), 1);
  append(m, moved(box({0.1F, 0.03F, 0.18F}, 0.01F), {0, -t / 2, 0.9F + neck}), 1);
  append(m, moved(turned(cylinder(0.08F, 0.01F), kX, kPi / 2), {0, -t / 2, 0.45F}), 2);
  m = turned(m, kX, d.chance(0.5) ? -draw(d, 0.1, 0.4) : kPi / 2);
}

void pram(Mesh& m, Dice& d) {
  const float r = draw(d, 0.12, 0.25), l = draw(d, 0.35, 0.5), w = draw(d, 0.2, 0.28),
              h = r + draw(d, 0.25, 0.4), open = draw(d, 1.2, 2.4);
  append(m, moved(lathe(hollow(smooth({{0.5F, 0}, {0.9F, 0.1F}, {1, 0.25F}}), 0.04F)), {}), 0);
  m = moved(scaled(m, {l, w, 1}), {0, 0, h});
  for (int i = 0; i <= 5; ++i) {  // the hood: segments that turn about the middle of the tub
    const Path bow = arc({}, w * kY, -w * 1.4F * kX, 0, kPi, 12);
    append(
        m,
        moved(turned(sweep(rectangle(0.02F, 0.22F), bow), kY, open * fraction(i, 5)), {-0.1F, 0, h + 0.25F}),
        1);
  }
  for (const float x : {-0.7F * l, 0.7F * l}) {
    for (const float y : {-w, w}) {
      append(m, moved(wheel(r, 0.04F, 10, 0.08F), {x, y, 0})),
          append(m, rod({x, y, r}, {-0.4F * x, y * 0.8F, h + 0.08F}, 0.012F), 2);
    }
  }
  append(m,
         tube(filleted({{l * 0.5F, -0.86F * w, h + 0.24F},
                        {l * 1.7F, -w, h + 0.4F},
                        {l * 1.7F, w, h + 0.4F},
                        {l * 0.5F, 0.86F * w, h + 0.24F}},
                       0.08F),
              0.014F),
         2);
}

void bird_house(Mesh& m, Dice& d) {  // a pitched roof, perhaps on a pole
  const float w = draw(d, 0.15, 0.4), l = draw(d, 0.15, 0.4), h = draw(d, 0.25, 0.6),
              rise = draw(d, 0.1, 0.4), over = draw(d, 1.1, 1.5);
  append(m, upright({{-w, 0}, {w, 0}, {w, h}, {0, h + rise}, {-w, h}}, 2 * l), 0);
  for (const float side : {-1.0F, 1.0F}) {
    append(m, beam({0, -l * over, h + rise}, {0, l * over, h + rise}, 0.04F, 0.03F), 1);
    append(m,
           upright(side > 0 ? Outline{{w * over, h - rise * (over - 1)},
                                      {w * over, h + 0.04F - rise * (over - 1)},
                                      {0, h + rise + 0.04F},
                                      {0, h + rise}}
                            : Outline{{-w * over, h - rise * (over - 1)},
                                      {0, h + rise},
                                      {0, h + rise + 0.04F},
                                      {-w * over, h + 0.04F - rise * (over - 1)}},
                   2 * l * over),
           1);
  }
  append(m, moved(turned(cylinder(w * draw(d, 0.2, 0.5), 0.02F), kX, kPi / 2), {0, -l, h * 0.6F}), 2);
  if (d.chance(0.5)) append(m, rod({0, 0, -draw(d, 0.5, 1.5)}, {}, 0.04F), 1);
}

void fruit_bunch(Mesh& m, Dice& d) {  // crescents from one stem
  const int n = d.between(2, 7);
  const float l = draw(d, 0.5, 1), r = draw(d, 0.06, 0.13), curl = draw(d, 0.4, 1.1);
  for (int i = 0; i < n; ++i) {
    const Path path = arc({0, 0, 0}, l * kX, l * kZ, 0, curl + 0.6F, 12);
    const Mesh one = sweep(circle(r, 7), path, {0.35F, 0.5F, 0.8F, 1, 1, 1, 1, 1, 1, 0.9F, 0.7F, 0.4F, 0});
    append(m, turned(moved(one, {-l, 0, 0}), kZ, 0.32F * static_cast<float>(i) + draw(d, -0.08, 0.08)), 0);
  }
  append(m, limb({}, {0, 0, -0.2F}, r * 0.8F, r * 0.5F), 1);
  m = turned(m, kX, draw(d, 0, 6));
}

void mushrooms(Mesh& m, Dice& d) {
  const int n = d.between(1, 5);
  if (n > 1) append(m, moved(ball({0.8F, 0.7F, draw(d, 0.05, 0.25)}), {0.1F, 0, 0}), 2);
  for (int i = 0; i < n; ++i) {
    const float r = draw(d, 0.15, 0.5), h = draw(d, 0.2, 0.9), stem = r * draw(d, 0.2, 0.45),
                dome = r * draw(d, 0.3, 1);
    Mesh one = lathe(smooth({{stem * 1.3F, 0}, {stem * 0.9F, h * 0.5F}, {stem, h}}));
    append(one,
           moved(lathe(smooth({{0.1F * r, 0.02F}, {r, -0.1F * dome}, {r * 0.75F, dome * 0.6F}, {0, dome}})),
                 {0, 0, h}),
           1);
    append(m, moved(bent(one, draw(d, -0.4, 0.4)), polar(i == 0 ? 0 : 0.5F, 2.4F * static_cast<float>(i))));
  }
}

void snail_shell(Mesh& m, Dice& d) {
  const float turns = draw(d, 2, 4), lift = draw(d, 0, 0.9), fat = draw(d, 0.3, 0.5);
  Path path;
  std::vector<float> scales;
  for (int i = 0; i <= 80; ++i) {
    const float size = std::pow(0.04F, 1 - fraction(i, 80));
    path.push_back(polar(size * 0.6F, 2 * kPi * turns * fraction(i, 80), lift * (1 - size)));
    scales.push_back(size * fat);
  }
  append(m, sweep(circle(1, 16), path, scales));
  if (d.chance(0.5)) m = turned(m, kX, kPi / 2);
}

void anchor(Mesh& m, Dice& d) {
  const float r = draw(d, 0.35, 0.6), t = draw(d, 0.03, 0.07), h = draw(d, 0.9, 1.4), bar = draw(d, 0.2, 0.4);
  append(m, rod({}, {0, 0, h}, t), 0);
  append(m, moved(turned(torus(2.2F * t, 0.5F * t, 20, 8), kX, kPi / 2), {0, 0, h + 2 * t}), 1);
  append(m, rod({0, -bar, h * 0.85F}, {0, bar, h * 0.85F}, t * 0.8F), 1);
  append(m, tube(arc({0, 0, r}, r * kX, -r * kZ, 0.2F, kPi - 0.2F, 16), t), 0);
  for (const float side : {-1.0F, 1.0F}) {
    append(m, moved(turned(frustum(3 * t, 0, 5 * t, 3), kY, -0.2F * side), {side * r * 0.98F, 0, 0.75F * r}),
           0);
  }
  if (d.chance(0.6)) m = turned(m, kX, kPi / 2 * 0.93F);
}

}  // namespace

std::vector<Family> yardstick_families() {
  constexpr Use kUse = Use::yardstick;
  return {family<deck_chair, 400, 1300>("deck chair", kUse),
          family<umbrella, 300, 1100>("umbrella", kUse),
          family<teapot, 120, 350>("teapot", kUse),
          family<wheelbarrow, 400, 1500>("wheelbarrow", kUse),
          family<coat_stand, 400, 1900, rarely>("coat stand", kUse),
          family<candelabra, 200, 900>("candelabra", kUse),
          family<hourglass, 100, 500, rarely>("hourglass", kUse),
          family<coil, 100, 900, often>("coil", kUse),
          family<knot, 100, 700, often>("knot", kUse),
          family<nested_rings, 150, 900>("nested rings", kUse),
          family<truss, 300, 1800>("truss", kUse),
          family<pagoda, 120, 1000>("pagoda", kUse),
          family<rocking_horse, 250, 1000>("rocking horse", kUse),
          family<guitar, 300, 1100>("guitar", kUse),
          family<pram, 300, 1100>("pram", kUse),
          family<bird_house, 150, 1700>("bird house", kUse),
          family<fruit_bunch, 100, 500>("fruit bunch", kUse),
          family<mushrooms, 80, 600>("mushrooms", kUse),
          family<snail_shell, 60, 600>("snail shell", kUse),
          family<anchor, 200, 1200>("anchor", kUse)};
}

}  // namespace cairn::worlds
