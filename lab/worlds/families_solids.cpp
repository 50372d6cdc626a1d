// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>

#include "lab/worlds/families_parts.hpp"

/// Families that are solids or sheets: vessels, extrusions, blobs, books, bags, household things, assemblies.
namespace cairn::worlds {
namespace {

void carton(Mesh& m, Dice& d) {  // half of them with open flaps
  const float x = draw(d, 0.1, 0.4), y = draw(d, 0.1, 0.4), z = draw(d, 0.1, 0.8), open = draw(d, 0.2, 2.4);
  const bool flaps = d.chance(0.5);
  if (!flaps) return append(m, box({2 * x, 2 * y, z}, d.chance(0.5) ? draw(d, 0, 0.06) : 0));
  for (int i = 0; i < 4; ++i) {
    const float out = i % 2 == 0 ? x : y, w = i % 2 == 0 ? y : x;
    Mesh side = moved(box({0.01F, 2 * w, z}), {out, 0, 0});
    const Mesh flap = turned(box({0.008F, 2 * w, std::min(x, y)}), kY, open + draw(d, -0.3, 0.3));
    append(side, moved(flap, {out, 0, z}));
    append(m, turned(side, kZ, kPi / 2 * static_cast<float>(i)));
  }
  append(m, box({2 * x, 2 * y, 0.01F}));
}

void bottle(Mesh& m, Dice& d) {
  const float r = draw(d, 0.1, 0.3), neck = r * draw(d, 0.25, 0.6), body = draw(d, 0.3, 0.75);
  const float shoulder = body + draw(d, 0.03, 0.25), waist = draw(d, 0.8, 1.05);
  const Outline line =
      smooth({{r * 0.9F, 0}, {r, 0.03F}, {r * waist, body / 2}, {r, body}, {neck, shoulder}, {neck, 1}});
  const Mesh glass = lathe(line);
  append(m, d.chance(0.25) ? scaled(glass, {1, draw(d, 0.5, 0.8), 1}) : glass, 0);
  append(m, moved(cylinder(neck * 1.15F, draw(d, 0.05, 0.2)), {0, 0, 0.97F}), 1);
  if (d.chance(0.3)) append(m, moved(cylinder(r * 1.01F, body * 0.5F), {0, 0, body * 0.2F}), 2);
}

void vase(Mesh& m, Dice& d) {
  Outline line;
  const int n = d.between(3, 6);
  for (int i = 0; i <= n; ++i) line.push_back({draw(d, 0.12, 0.5), fraction(i, n)});
  append(m, lathe(hollow(smooth(line), draw(d, 0.01, 0.05))));
  if (d.chance(0.25)) {
    m = scaled(m, {1, draw(d, 0.5, 0.8), 1});
    m = twisted(m, draw(d, -2, 2));
  }
}

void bowl(Mesh& m, Dice& d) {  // bowls, plates, pans
  const float h = draw(d, 0.08, 0.8), foot = draw(d, 0.2, 0.6), wall = draw(d, 0.01, 0.06);
  append(m, lathe(hollow(smooth({{foot, 0}, {draw(d, 0.6, 1), h * 0.4F}, {1, h}}), wall), 36), 0);
  if (d.chance(0.3)) append(m, beam({0.95F, 0, h * 0.8F}, {draw(d, 1.5, 2.6), 0, h * 0.9F}, 0.16F, 0.07F), 1);
  if (d.chance(0.2)) append(m, moved(blob({0.8F, 0.8F, h * 0.8F}, 0.15F, 4, d), {0, 0, h * 0.6F}), 2);
}

void mug(Mesh& m, Dice& d) {
  const float low = draw(d, 0.25, 0.45), high = draw(d, 0.3, 0.5), h = draw(d, 0.5, 1.1),
              out = draw(d, 0.15, 0.4);
  append(m, lathe(hollow({{low, 0}, {high, h}}, draw(d, 0.02, 0.06))), 0);
  const Path bow{
      {low, 0, 0.2F * h}, {high + out, 0, 0.25F * h}, {high + out, 0, 0.8F * h}, {high, 0, 0.8F * h}};
  const float thick = draw(d, 0.03, 0.07);
  append(m, tube(filleted(bow, draw(d, 0.02, 0.25)), thick), 1);
}

void turned_wood(Mesh& m, Dice& d) {  // goblets, chessmen, balusters, spools
  Outline line;
  const int n = d.between(5, 12);
  for (int i = 0; i <= n; ++i) line.push_back({draw(d, 0.04, 0.22), fraction(i, n)});
  line.front().x = draw(d, 0.15, 0.3);
  append(m, lathe(d.chance(0.6) ? smooth(line, 5) : line), 0);
}

void jar(Mesh& m, Dice& d) {  // and tins; with a lid and perhaps a knob
  const float r = draw(d, 0.15, 0.6), h = draw(d, 0.3, 1), lid = draw(d, 0.03, 0.25);
  append(m, lathe(smooth({{r * 0.95F, 0}, {r, 0.03F}, {r * draw(d, 0.95, 1.2), h / 2}, {r, h}}, 4)), 0);
  append(m, moved(frustum(r * 1.05F, r * draw(d, 0.5, 1.05), lid), {0, 0, h}), 1);
  if (d.chance(0.5))
    append(m, moved(ball({0.2F * r, 0.2F * r, 0.2F * r}, 10), {0, 0, h + lid + 0.1F * r}), 2);
}

void bucket(Mesh& m, Dice& d) {
  const float low = draw(d, 0.25, 0.45), high = draw(d, 0.35, 0.55), h = draw(d, 0.3, 0.9),
              lean = draw(d, -1.4, 1.4);
  append(m, lathe(hollow({{low, 0}, {high, h}}, 0.015F)), 0);
  append(m, moved(torus(high, 0.02F), {0, 0, h}), 0);
  const Vec3 up{0, high * std::sin(lean), high * std::cos(lean)};
  append(m, tube(arc({0, 0, h}, high * kX, 1.1F * up, 0, kPi, 20), draw(d, 0.01, 0.02)), 1);
}

Outline ragged(Dice& d, int n, float least) {
  Outline made;
  for (int i = 0; i < n; ++i) {
    const Vec3 p = polar(draw(d, least, 1), turn_of(i, n));
    made.push_back({p.x, p.y});
  }
  return made;
}

void prism(Mesh& m, Dice& d) {
  const int n = d.between(3, 9);
  const auto h = static_cast<float>(d.log_uniform(0.1, 3));
  const Outline line =
      d.chance(0.4) ? star(n, 1, std::cos(kPi / static_cast<float>(n))) : ragged(d, std::max(n, 4), 0.4F);
  append(m, extrusion(d.chance(0.3) ? rounded(line, 0.3F) : line, h));
}

void letters(Mesh& m, Dice& d) {  // one to three signs of strokes between three by three nodes, on one bar
  const int signs = d.between(1, 3), strokes = d.between(2, 5);
  const float thick = draw(d, 0.12, 0.3), deep = draw(d, 0.1, 0.6), gap = draw(d, 1.2, 1.6);
  for (int s = 0; s < signs; ++s) {
    int at = d.below(3);
    for (int i = 0; i < strokes; ++i) {
      const int to = (at + d.between(1, 8)) % 9;
      const auto node = [&](int k) {
        const int row = k / 3, column = k % 3;
        return Vec3{gap * static_cast<float>(s) + 0.5F * static_cast<float>(column), 0,
                    0.7F * static_cast<float>(row)};
      };
      append(m, beam(node(at), node(to), deep, thick), s);
      at = to;
    }
  }
  if (signs > 1)
    append(m, beam({0, 0, 0}, {gap * static_cast<float>(signs - 1) + 1, 0, 0}, deep * 1.2F, thick), 3);
}

void gear(Mesh& m, Dice& d) {  // gears, stars, cogs on an axle
  const int n = d.between(5, 20);
  const float h = draw(d, 0.1, 0.8), depth = draw(d, 0.45, 0.9), hub = draw(d, 0.1, 0.4);
  append(m, extrusion(star(n, 1, depth), h), 0);
  append(m, moved(cylinder(hub, h * draw(d, 1.1, 3)), {0, 0, -0.1F * h}), 1);
  if (d.chance(0.4)) m = turned(m, kX, kPi / 2);
}

void rounded_solid(Mesh& m, Dice& d) {
  const float vertical = draw(d, 0.15, 2), horizontal = draw(d, 0.15, 2);
  append(m, superquadric({draw(d, 0.3, 1), draw(d, 0.3, 1), draw(d, 0.3, 1)}, vertical, horizontal, 24));
  const int kind = d.below(4);
  if (kind == 0) m = bent(m, draw(d, 0.4, 1.8));
  if (kind == 1) m = twisted(m, draw(d, -2, 2));
  if (kind == 2) m = dented(m, d, d.between(1, 4), 0.1F);
}

void lump(Mesh& m, Dice& d) {
  const int n = d.between(1, 4);
  for (int i = 0; i < n; ++i) {
    const Vec3 at{draw(d, -0.4, 0.4), draw(d, -0.4, 0.4), draw(d, -0.3, 0.4)};
    const Vec3 radii{draw(d, 0.4, 0.9), draw(d, 0.4, 0.9), draw(d, 0.4, 0.8)};
    const float bumps = draw(d, 0, 0.4), frequency = draw(d, 1, 6);
    append(m, moved(blob(radii, bumps, frequency, d), at));
  }
}

void stone(Mesh& m, Dice& d) {  // an ellipsoid cut by planes
  m = blob({draw(d, 0.5, 1), draw(d, 0.5, 1), draw(d, 0.3, 0.8)}, 0.15F, 3, d, 20);
  const int cuts = d.between(4, 12);
  for (int i = 0; i < cuts; ++i) {
    const Vec3 normal = unit({draw(d, -1, 1), draw(d, -1, 1), draw(d, -1, 1)});
    const float far = draw(d, 0.35, 0.7);
    m = warped(m, [&](Vec3 p) { return p - std::max(0.0F, dot(p, normal) - far) * normal; });
  }
}

Mesh one_book(float x, float y, float z) {  // pages between covers and a back
  const float cover = 0.04F * x;
  Mesh made;
  append(made, moved(box({x - cover, y - cover, z - 2 * cover}), {0, 0, cover}), 3);
  append(made, box({x, y, cover}), 0);
  append(made, moved(box({x, y, cover}), {0, 0, z - cover}), 0);
  append(made, moved(box({cover, y, z}), {-x / 2, 0, 0}), 0);
  return made;
}

void book(Mesh& m, Dice& d) {  // shut, standing, or open
  const float x = draw(d, 0.5, 0.9), z = draw(d, 0.06, 0.3), open = draw(d, 0.1, 1.5);
  if (d.chance(0.5)) {
    append(m, one_book(x, 1, z));
    if (d.chance(0.4)) m = turned(m, d.chance(0.5) ? kX : kY, kPi / 2);
    return;
  }
  for (const float side : {-1.0F, 1.0F}) {
    const Mesh half = warped(slab({x, 1, z / 2}, 12, 1), [&](Vec3 p) {
      const float t = p.x / x + 0.5F;
      return Vec3{p.x + x / 2, p.y, p.z * std::min(1.0F, 0.3F + 4 * t) + 0.1F * std::sin(3 * t)};
    });
    append(m, side > 0 ? half : turned(scaled(half, {-1, 1, 1}), kY, d.chance(0.5) ? 0 : open),
           side > 0 ? 3 : 0);
  }
}

void book_stack(Mesh& m, Dice& d) {  // lying on each other, or a row
  const int n = d.between(2, 7);
  const bool row = d.chance(0.4);
  const float lean = draw(d, 0, 0.15);
  float at = 0;
  for (int i = 0; i < n; ++i) {
    const float x = draw(d, 0.5, 0.9), y = draw(d, 0.7, 1.1), z = draw(d, 0.06, 0.25),
                yaw = draw(d, -0.3, 0.3);
    Mesh one = one_book(x, y, z);
    for (auto& part : one.part) part = part == 3 ? 3 : static_cast<std::uint8_t>(i % 3);
    one = row ? turned(moved(one, {-x / 2, 0, 0}), kY, kPi / 2 - lean) : turned(one, kZ, yaw);
    append(m, moved(one, row ? Vec3{at, 0, 0} : Vec3{0, 0, at}));
    at += row ? z / std::cos(lean) : z;
  }
}

void card(Mesh& m, Dice& d) {  // folded once to four times, standing
  const int folds = d.between(1, 4);
  const float h = draw(d, 0.5, 1.5), angle = draw(d, 0.3, 1.2), t = draw(d, 0.004, 0.02);
  Path line{{}};
  for (int i = 0; i <= folds; ++i)
    line.push_back(line.back() + polar(draw(d, 0.3, 0.7), i % 2 == 0 ? angle : -angle));
  append(m, sweep(rectangle(t, h), line), 0);
  if (d.chance(0.4)) m = turned(m, kX, kPi / 2);
}

void paper(Mesh& m, Dice& d) {  // a sheet that curls, waves or is crumpled
  const float curl = draw(d, -1.2, 1.2), rough = d.chance(0.5) ? draw(d, 0.01, 0.08) : 0,
              skew = draw(d, -1, 1);
  const float frequency = draw(d, 4, 20);
  append(m, warped(slab({1, draw(d, 0.5, 1.4), 0.006F}, 24, 24), [&](Vec3 p) {
           const float s = p.x + skew * p.y;
           const float crease =
               std::abs(std::sin(frequency * s)) * std::abs(std::cos(0.7F * frequency * p.y - s));
           return p + Vec3{0, 0, 0.35F * curl * s * s + rough * crease};
         }));
}

void board(Mesh& m, Dice& d) {  // boards, lids, trays, planks
  const float x = draw(d, 0.3, 1), y = draw(d, 0.08, 0.8), z = draw(d, 0.01, 0.08);
  append(m, plate(d, {2 * x, 2 * y, z}), 0);
  const int kind = d.below(4);
  if (kind == 0) append(m, moved(cylinder(0.1F, 0.1F, 14), {0, 0, z}), 1);
  if (kind == 1) append(m, moved(box({0.3F, 0.05F, 0.12F}, 0.02F), {0, 0, z}), 1);
  if (kind == 2) Bars{m, 0.05F, d.chance(0.5), 1}.loop(corners(0.9F * x, 0.9F * y, z + 0.05F));
  if (d.chance(0.5)) m = turned(m, kY, draw(d, 0.9, 1.5));  // leaning, or nearly upright
}

void cushion(Mesh& m, Dice& d) {
  const float thick = draw(d, 0.12, 0.35), pinch = draw(d, 0.05, 0.4);
  m = warped(superquadric({1, draw(d, 0.5, 1), thick}, 1, 0.3F, 22), [&](Vec3 p) {
    const float edge = std::max(std::abs(p.x), std::abs(p.y));
    return Vec3{p.x * (1 - pinch * (1 - edge)), p.y * (1 - pinch * (1 - edge)), p.z * (1 + 0.3F * pinch)};
  });
  m = dented(m, d, d.below(4), 0.06F);
  if (d.chance(0.4)) m = turned(m, kX, draw(d, 0.7, 1.5));
}

void bag(Mesh& m, Dice& d) {  // shopping bag, handbag, rucksack
  const float w = draw(d, 0.2, 0.5), l = draw(d, 0.08, 0.25), h = draw(d, 0.3, 0.9), bow = draw(d, 0.1, 0.5);
  const float top = draw(d, 0.6, 1);
  append(m, tapered(moved(superquadric({w, l, h / 2}, draw(d, 0.15, 0.6), 0.4F), {0, 0, h / 2}), top), 0);
  m = dented(m, d, d.below(4), 0.04F);
  for (const float y : {-0.3F * l, 0.3F * l}) {
    append(m, tube(arc({0, y, 0.9F * h}, 0.5F * w * kX, bow * kZ + y * kY, 0, kPi, 14), 0.018F), 1);
  }
  if (d.chance(0.4))
    append(m, moved(superquadric({0.7F * w, l * 0.5F, h * 0.2F}, 0.3F, 0.3F, 12), {0, -l, h * 0.3F}), 2);
}

void sack(Mesh& m, Dice& d) {  // tied at the top
  const float r = draw(d, 0.25, 0.5), neck = draw(d, 0.06, 0.15), h = draw(d, 0.4, 0.8),
              pleat = draw(d, 0.02, 0.12);
  const Outline line =
      smooth({{r * 0.6F, 0}, {r, 0.2F * h}, {r * 0.8F, 0.7F * h}, {neck, h}, {neck * 2.5F, h + 0.2F}});
  m = warped(lathe(line, 48), [&](Vec3 p) {
    const float fold = 1 + pleat * std::sin(9 * std::atan2(p.y, p.x)) * std::min(1.0F, p.z / h);
    return Vec3{p.x * fold, p.y * fold, p.z};
  });
  m = dented(m, d, d.between(1, 4), 0.05F);
  append(m, moved(torus(neck * 1.1F, 0.03F, 20, 6), {0, 0, h}), 1);
}

void shoe(Mesh& m, Dice& d) {
  const float w = draw(d, 0.14, 0.2), shaft = draw(d, 0.25, 0.9), toe = draw(d, 0.1, 0.18),
              heel = draw(d, 0, 0.15);
  append(m, extrusion(rounded({{-0.4F, -w}, {0.6F, -w}, {0.6F, w}, {-0.4F, w}}, w), 0.06F), 0);
  append(m, moved(superquadric({0.4F, w, toe}, 0.8F, 0.8F, 14), {0.18F, 0, 0.1F}), 1);
  const Path leg{{-0.22F, 0, 0.04F}, {-0.2F, 0, 0.2F}, {-0.25F, 0, shaft}};
  append(m, sweep(circle(w, 16), leg, {1, draw(d, 0.8, 1), draw(d, 0.9, 1.3)}), 1);
  if (heel > 0.07F) append(m, moved(box({0.2F, 1.5F * w, heel}), {-0.28F, 0, -heel}), 0);
  m = turned(m, kY, heel > 0.07F ? 0.8F * heel : 0);
}

void hat(Mesh& m, Dice& d) {
  const float brim = draw(d, 0.6, 1.1), crown = draw(d, 0.35, 0.5), h = draw(d, 0.25, 0.9),
              curl = draw(d, -0.1, 0.3);
  const float top = draw(d, 0.3, 1.1);
  const Outline line{
      {brim, 0.02F}, {brim, 0.05F}, {crown, 0.06F}, {crown * top, h}, {crown * top * 0.6F, h * 1.05F}};
  m = warped(lathe(line, 36), [&](Vec3 p) { return p + Vec3{0, 0, curl * p.y * p.y}; });
  append(m, moved(cylinder(crown * 1.02F, 0.1F), {0, 0, 0.06F}), 1);
}

void lamp(Mesh& m, Dice& d) {  // with a shade, on a straight or a bent stem
  const float h = draw(d, 0.4, 1.4), foot = draw(d, 0.12, 0.3), low = draw(d, 0.12, 0.4),
              high = draw(d, 0.05, 0.3);
  const float base = draw(d, 0.02, 0.1);
  append(m, frustum(foot, foot * draw(d, 0.3, 1), base), 0);
  const bool arm = d.chance(0.4);
  const Vec3 top{arm ? draw(d, 0.1, 0.6) : 0, 0, h};
  const Path stem{{}, {0, 0, h * 0.5F}, {arm ? -0.15F : 0, 0, h * 0.7F}, top};
  const float wire = draw(d, 0.01, 0.03);
  append(m, tube(d.chance(0.5) ? stem : spline(stem, 8), wire), 0);
  const float tall = draw(d, 0.12, 0.4), wall = 0.008F, middle = (low + high) / 2;
  Mesh shade = lathe({{low, 0}, {high, tall}, {high - wall, tall}, {low - wall, 0}}, 28, true);
  append(shade, rod({-middle, 0, tall / 2}, {middle, 0, tall / 2}, wall));
  shade = turned(moved(shade, {0, 0, -tall / 2}), kY, arm ? draw(d, 0, 1) : 0);
  append(m, moved(shade, top), 1);
}

void fan(Mesh& m, Dice& d) {
  const float h = draw(d, 0.3, 1.2), r = draw(d, 0.2, 0.4), depth = draw(d, 0.06, 0.12);
  const int blades = d.between(3, 6), bars = d.between(12, 28);
  append(m, cylinder(r * draw(d, 0.5, 0.8), 0.04F), 0);
  append(m, rod({}, {0, 0, h}, 0.025F), 0);
  Mesh head = moved(cylinder(0.06F, depth), {0, 0, -depth / 2});
  for (int i = 0; i < blades; ++i) {
    const Mesh blade = turned(moved(box({0.75F * r, 0.4F * r, 0.01F}), {0.45F * r, 0, 0}), kX, 0.4F);
    append(head, turned(blade, kZ, turn_of(i, blades)), 1);
  }
  for (int i = 0; i < bars; ++i) {
    const Vec3 out = polar(r, turn_of(i, bars));
    append(head,
           tube({{0, 0, depth},
                 0.7F * out + Vec3{0, 0, depth},
                 out,
                 0.7F * out - Vec3{0, 0, depth},
                 {0, 0, -depth}},
                0.005F, false, 5),
           2);
  }
  append(head, torus(r, 0.012F, 36, 6), 2);
  append(m, moved(turned(head, kY, kPi / 2 - draw(d, -0.1, 0.4)), {0.05F, 0, h}));
}

void clock(Mesh& m, Dice& d) {
  const float r = draw(d, 0.3, 0.6), t = draw(d, 0.1, 0.4);
  Mesh face = d.chance(0.7) ? cylinder(r, t, 32) : box({2 * r, 2 * r, t}, 0.05F);
  append(face, moved(torus(r * 0.93F, 0.05F), {0, 0, t}), 1);
  for (const float l : {0.5F, 0.75F}) {
    append(face, beam({0, 0, t + 0.01F}, polar(l * r, draw(d, 0, 6), t + 0.01F), 0.04F, 0.02F), 2);
  }
  append(m, moved(turned(face, kX, kPi / 2), {0, t / 2, r + 0.05F}));
  for (const float side : {-1.0F, 1.0F}) {
    append(m, limb({0.7F * side * r, 0, 0.03F}, {0.4F * side * r, 0, 0.3F * r}, 0.05F, 0.04F), 1);
    if (t > 0.25F) append(m, moved(ball({0.3F * r, 0.3F * r, 0.2F * r}, 10), {0.5F * side * r, 0, 2 * r}), 1);
  }
}

void tool(
    Mesh& m,
    Dice& d) {  // hammers, brushes, rackets, spatulas, dumb-bells: a rod with a head at one or both ends
  const float r = draw(d, 0.02, 0.06), size = draw(d, 0.08, 0.3);
  append(m, limb({}, {0, 0, 1}, r, r * draw(d, 0.6, 1.2)), 0);
  const int kind = d.below(5);
  Mesh head;
  if (kind == 0) head = moved(box({1.2F * size, size * 0.6F, size * 0.6F}, 0.02F), {0, 0, -size * 0.3F});
  if (kind == 1) head = scaled(turned(torus(size, 0.02F), kX, kPi / 2), {1, 1, draw(d, 1, 1.6)});
  if (kind == 2) head = box({1.5F * size, 0.02F, 2 * size}, 0.005F);
  if (kind == 3) head = ball({size, size * draw(d, 0.1, 1), size});
  if (kind == 4) head = moved(turned(cylinder(size, size), kY, kPi / 2), {-size / 2, 0, 0});
  append(m, moved(head, {0, 0, 1}), 1);
  if (d.chance(0.3)) append(m, head, 1);
  m = turned(m, kY, d.chance(0.8) ? kPi / 2 : 0.1F);
}

/// The first five of the nine kinds are massive and flat enough to be stacked.
Mesh any_part(Dice& d, int kinds) {
  const Vec3 s{draw(d, 0.15, 0.9), draw(d, 0.15, 0.9), draw(d, 0.1, 0.9)};
  const int kind = d.below(kinds);
  const float ratio = draw(d, 0.15, 1), bevel = draw(d, 0, 0.1), r = s.x / 2;
  if (kind == 0) return box(s, bevel);
  if (kind == 1) return cylinder(r, s.z);
  if (kind == 2) return frustum(r, r * ratio, s.z, d.between(4, 20));
  if (kind == 3) return moved(superquadric(0.5F * s, 1.4F * ratio, 1), {0, 0, s.z / 2});
  if (kind == 4) return plate(d, {s.x, s.y, 0.2F * s.z});
  if (kind == 5) return extrusion(ragged(d, 6, 0.2F), s.z);
  if (kind == 6) return moved(torus(r, r * 0.4F * ratio), {0, 0, r * 0.4F * ratio});
  if (kind == 7) return lathe(hollow({{r * ratio, 0}, {r, s.z}}, 0.03F));
  return upright({{0, 0}, {s.x, 0}, {s.x, 0.1F}, {0.1F, 0.1F}, {0.1F, s.z}, {0, s.z}}, s.y);
}

void assembly(Mesh& m, Dice& d) {  // parts at any angle; each touches one of those before it
  const int n = d.between(2, 6);
  for (int i = 0; i < n; ++i) {
    Mesh part = any_part(d, 9);
    const Vec3 axis = unit({draw(d, -1, 1), draw(d, -1, 1), 0.01F});
    if (d.chance(0.5)) part = turned(part, axis, draw(d, 0, kPi));
    const auto some_point = [&](const Mesh& of) {
      return of.points[static_cast<std::size_t>(d.below(static_cast<int>(of.points.size())))];
    };
    const Vec3 to = i == 0 ? Vec3{} : some_point(m);
    append(m, moved(part, to - 0.93F * some_point(part)), i % 4);
  }
}

void stack(Mesh& m, Dice& d) {
  const int n = d.between(2, 6);
  const bool same = d.chance(0.4);
  Mesh one = any_part(d, 5);
  for (int i = 0; i < n; ++i) {
    if (!same) one = any_part(d, 5);
    settle(one);
    const Vec3 at{draw(d, -0.1, 0.1), draw(d, -0.1, 0.1), m.points.empty() ? 0 : bounds(m)[1].z};
    append(m, moved(turned(one, kZ, draw(d, -0.5, 0.5)), at), i % 4);
  }
}

}  // namespace

std::vector<Family> solid_families() {
  return {family<carton, 100, 900, rarely>("carton"),
          family<bottle, 80, 400, rarely>("bottle"),
          family<vase, 80, 700, rarely>("vase"),
          family<bowl, 80, 500>("bowl"),
          family<mug, 70, 250, rarely>("mug"),
          family<turned_wood, 80, 900, rarely>("turned wood"),
          family<jar, 70, 500, rarely>("jar"),
          family<bucket, 120, 500, rarely>("bucket"),
          family<prism, 60, 700, rarely>("prism"),
          family<letters, 80, 600, rarely>("letters"),
          family<gear, 60, 500>("gear"),
          family<rounded_solid, 60, 800, rarely>("rounded solid"),
          family<lump, 60, 800>("lump"),
          family<stone, 60, 900>("stone"),
          family<book, 120, 450>("book"),
          family<book_stack, 150, 600>("book stack"),
          family<card, 80, 350>("card"),
          family<paper, 100, 700>("paper"),
          family<board, 120, 1200>("board"),
          family<cushion, 200, 700>("cushion"),
          family<bag, 150, 700, rarely>("bag"),
          family<sack, 150, 800>("sack"),
          family<shoe, 150, 400, rarely>("shoe"),
          family<hat, 150, 450>("hat"),
          family<lamp, 200, 1500, rarely>("lamp"),
          family<fan, 200, 1200>("fan"),
          family<clock, 80, 400>("clock"),
          family<tool, 120, 1200>("tool"),
          family<assembly, 100, 1100>("assembly"),
          family<stack, 100, 1000>("stack")};
}

}  // namespace cairn::worlds
