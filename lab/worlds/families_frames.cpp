// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>

#include "lab/worlds/families_parts.hpp"

/// Families that are no solids: frames, furniture, rings, rods and cables.
namespace cairn::worlds {
namespace {

void wire_box(Mesh& m, Dice& d) {
  const float x = draw(d, 0.3, 1), y = draw(d, 0.3, 1), z = draw(d, 0.3, 1.5);
  const Bars bar{m, draw(d, 0.02, 0.09), d.chance(0.5)};
  const Path low = corners(x, y, 0), high = corners(x, y, z);
  bar.loop(low), bar.loop(high);
  const int rungs = d.below(7), sides = d.between(1, 4);
  for (std::size_t i = 0; i < 4; ++i) {
    bar(low[i], high[i]);
    for (int k = 1; k <= rungs && static_cast<int>(i) < sides; ++k) {
      const float t = fraction(k, rungs + 1);
      bar(mix(low[i], low[(i + 1) % 4], t), mix(high[i], high[(i + 1) % 4], t));
    }
  }
  if (d.chance(0.4)) bar(low[0], high[1]);
}

void lattice_panel(Mesh& m, Dice& d) {
  const float w = draw(d, 0.4, 1.6), h = draw(d, 0.4, 1.6);
  const Bars bar{m, draw(d, 0.015, 0.06), d.chance(0.5)}, foot{m, 1.5F * bar.thickness, false, 1};
  const int columns = d.between(2, 9), rows = d.between(1, 9);
  const float slant = d.chance(0.3) ? draw(d, -0.5, 0.5) : 0;
  bar.loop({{0, 0, 0.1F}, {w, 0, 0.1F}, {w, 0, h}, {0, 0, h}});
  for (int i = 1; i <= columns; ++i) {
    const float t = fraction(i, columns + 1);
    bar({w * t, 0, 0.1F}, {w * std::clamp(t + slant, 0.0F, 1.0F), 0, h});
  }
  for (int i = 1; i <= rows; ++i) {
    const float z = 0.1F + (h - 0.1F) * fraction(i, rows + 1);
    bar({0, bar.thickness * 0.7F, z}, {w, bar.thickness * 0.7F, z});
  }
  for (const float x : {0.0F, w}) foot({x, -0.2F, 0.05F}, {x, 0.2F, 0.05F}), bar({x, 0, 0.05F}, {x, 0, 0.1F});
}

void rack(Mesh& m, Dice& d) {
  const float x = draw(d, 0.2, 0.7), y = draw(d, 0.1, 0.4), h = draw(d, 0.5, 1.8);
  const Bars post{m, draw(d, 0.02, 0.07), d.chance(0.5)}, wire{m, 0.5F * post.thickness, true, 1};
  for (const Vec3 foot : corners(x, y, 0)) post(foot, foot + Vec3{0, 0, h});
  const int shelves = d.between(1, 5), wires = d.chance(0.5) ? d.between(3, 12) : 0;
  for (int i = 0; i < shelves; ++i) {
    const float z = h * (shelves == 1 ? 0.6F : 0.08F + 0.9F * fraction(i, shelves - 1));
    wire.loop(corners(x, y, z));
    for (int k = 1; k < wires; ++k) {
      wire({-x + 2 * x * fraction(k, wires), -y, z}, {-x + 2 * x * fraction(k, wires), y, z});
    }
    if (wires == 0) append(m, moved(box({2 * x, 2 * y, 0.02F}), {0, 0, z}), 1);
  }
}

void airer(Mesh& m, Dice& d) {
  const float w = draw(d, 0.6, 1.2), half = draw(d, 0.2, 0.4), h = draw(d, 0.5, 1.1),
              wing = draw(d, 0.2, 0.6);
  const Bars bar{m, draw(d, 0.012, 0.035)};
  const float rise = draw(d, -0.3, 0.4);
  for (const float y : {0.0F, w}) {
    bar({-half, y, 0}, {half, y, h}), bar({half, y, 0}, {-half, y, h});
    bar({-half, y, h}, {-half - wing, y, h + rise}), bar({half, y, h}, {half + wing, y, h + rise});
  }
  const int rods = d.between(2, 6);
  for (int i = 0; i <= rods; ++i) {
    const float t = fraction(i, rods), x = half + wing * t;
    for (const float side : {-1.0F, 1.0F}) bar({side * x, 0, h + rise * t}, {side * x, w, h + rise * t});
  }
}

void cart(Mesh& m, Dice& d) {
  const float x = draw(d, 0.3, 0.6), y = draw(d, 0.2, 0.35), h = draw(d, 0.3, 0.9), r = draw(d, 0.04, 0.14);
  const Bars bar{m, draw(d, 0.02, 0.05)};
  const int trays = d.between(1, 3), spokes = d.chance(0.5) ? 0 : d.between(4, 9);
  const float low = r * 1.6F, top = trays == 1 ? low + 0.15F : h;
  for (int i = 0; i < trays; ++i) {
    const float z = trays == 1 ? low : low + (h - low) * fraction(i, trays - 1);
    append(m, moved(box({2 * x, 2 * y, 0.02F}), {0, 0, z}), 1);
    if (trays == 1 || d.chance(0.6)) bar.loop(corners(x, y, z + draw(d, 0.05, 0.15)));
  }
  for (const Vec3 c : corners(x, y, low)) {
    append(m, moved(wheel(r, r * 0.5F, spokes), {c.x * 0.9F, c.y * 1.1F, 0}), 2);
    bar({c.x * 0.9F, c.y * 1.1F, r}, c), bar(c, {c.x, c.y, top + 0.15F});
  }
  const Vec3 grip{-x - draw(d, 0.05, 0.25), 0, h + draw(d, 0.05, 0.4)}, left{0, -y, 0}, right{0, y, 0};
  append(m,
         tube(filleted({{-x, -y, low}, grip + left, grip + right, {-x, y, low}}, 0.1F), bar.thickness / 2));
}

void stool(Mesh& m, Dice& d) {
  const float h = draw(d, 0.25, 0.85), w = draw(d, 0.25, 0.5), thick = draw(d, 0.02, 0.08);
  const float depth = d.chance(0.5) ? w : w * draw(d, 0.5, 1);
  append(m, plate(d, {w, depth, thick}, h), 1);
  const int legs = d.between(3, 5);
  add_legs(m, d, legs == 4 ? corners(w * 0.32F, depth * 0.32F, h) : ring(legs, depth * 0.36F, h, 0.4F), 0);
}

void tube_chair(Mesh& m, Dice& d) {  // bent tubes: sled or cantilever
  const float w = draw(d, 0.2, 0.3), h = draw(d, 0.4, 0.5), back = draw(d, 0.1, 0.6), l = draw(d, 0.4, 0.55);
  const float lean = draw(d, 0, 0.2), r = draw(d, 0.01, 0.025), round = draw(d, 0.04, 0.15);
  const bool sled = d.chance(0.5);
  for (const float y : {-w, w}) {
    Path path{{l, y, h}, {l, y, 0}, {0, y, 0}, {sled ? 0.0F : 0.06F, y, sled ? h : 0.01F}};
    if (!sled) path = {{0.02F, y, 0}, {l, y, 0}, {l, y, h}, {0, y, h}, {-lean, y, h + back}};
    append(m, tube(filleted(path, round), r), 0);
    if (sled) append(m, rod({0, y, h}, {-lean, y, h + back}, r), 0);
  }
  append(m, rod({0.02F, -w, 0}, {0.02F, w, 0}, r), 0);
  append(m, moved(box({l, 2 * w, 0.03F}, 0.01F), {l / 2, 0, h}), 1);
  append(m, beam({-lean, -w, h + back * 0.75F}, {-lean, w, h + back * 0.75F}, 0.03F, back * 0.5F), 1);
}

void pedestal(Mesh& m, Dice& d) {  // stool or table on one column
  const float h = draw(d, 0.3, 1.1), foot = draw(d, 0.12, 0.3), column = draw(d, 0.015, 0.06);
  append(m, lathe(smooth({{foot, 0}, {foot * 0.9F, 0.03F}, {column, draw(d, 0.05, 0.15)}, {column, h}})), 0);
  const float w = draw(d, 0.3, 0.9);
  append(m, plate(d, {w, w * draw(d, 0.7, 1), draw(d, 0.015, 0.1)}, h), 1);
  if (d.chance(0.3)) {  // a footrest
    const float z = h * draw(d, 0.25, 0.5);
    append(m, moved(torus(foot * 0.8F, 0.01F), {0, 0, z}), 0);
    append(m, rod({-0.8F * foot, 0, z}, {0.8F * foot, 0, z}, 0.01F), 0);
  }
}

void chair(Mesh& m, Dice& d) {
  const float w = draw(d, 0.18, 0.28), l = draw(d, 0.18, 0.27), h = draw(d, 0.35, 0.6),
              back = draw(d, 0.2, 0.7);
  append(m, plate(d, {2 * l, 2 * w, draw(d, 0.02, 0.08)}, h), 1);
  add_legs(m, d, corners(l * 0.85F, w * 0.85F, h), 0);
  const Bars bar{m, draw(d, 0.015, 0.045), d.chance(0.5)};
  const float lean = draw(d, 0, 0.2) * back;
  const auto at = [&](float y, float t) { return Vec3{-l * 0.9F - lean * t, y * w * 0.9F, h + back * t}; };
  bar(at(-1, 0), at(-1, 1)), bar(at(1, 0), at(1, 1)), bar(at(-1, 1), at(1, 1));
  const int slats = d.below(7), kind = d.below(3);
  for (int i = 1; i <= slats && kind < 2; ++i) {
    const float t = fraction(i, slats + 1);
    kind == 0 ? bar(at(-1, t), at(1, t)) : bar(at(2 * t - 1, 0), at(2 * t - 1, 1));
  }
  if (kind == 2) append(m, beam(at(0, 0.3F), at(0, 0.95F), 0.03F, 1.7F * w), 1);
  const float arm = draw(d, 0.15, 0.28);
  for (const float side : {-1.0F, 1.0F}) {
    if (slats % 2 == 0) continue;
    append(m, tube(filleted({{l * 0.8F, side * w, h}, {l * 0.8F, side * w, h + arm}, {-l, side * w, h + arm}},
                            0.08F),
                   bar.thickness / 2));
  }
}

void table(Mesh& m, Dice& d) {
  const float x = draw(d, 0.25, 0.9), y = draw(d, 0.25, 0.5), h = draw(d, 0.3, 1);
  append(m, plate(d, {2 * x, 2 * y, draw(d, 0.015, 0.07)}, h), 1);
  add_legs(m, d, corners(x * 0.68F, y * 0.68F, h), 0);
  if (d.chance(0.3)) append(m, moved(box({1.85F * x, 1.85F * y, 0.02F}), {0, 0, h * draw(d, 0.15, 0.5)}), 1);
}

void trestle(Mesh& m, Dice& d) {
  const float w = draw(d, 0.3, 0.7), h = draw(d, 0.4, 0.9), spread = draw(d, 0.15, 0.35);
  const Bars bar{m, draw(d, 0.03, 0.07), d.chance(0.3)};
  append(m, beam({0, -w * 1.2F, h}, {0, w * 1.2F, h}, draw(d, 0.05, 0.15), 0.08F), 1);
  for (const float y : {-w, w}) {
    bar({-spread, y * 1.1F, 0}, {-0.02F, y, h}), bar({spread, y * 1.1F, 0}, {0.02F, y, h});
    bar({-spread * 0.6F, y * 1.06F, h * 0.4F}, {spread * 0.6F, y * 1.06F, h * 0.4F});
  }
}

void shelf_unit(Mesh& m, Dice& d) {
  const float w = draw(d, 0.3, 1.2), l = draw(d, 0.15, 0.4), h = draw(d, 0.3, 1.6), t = draw(d, 0.012, 0.04);
  const int boards = d.between(2, 5), columns = d.between(1, 3);
  for (int i = 0; i < boards; ++i) {
    append(m, moved(box({w, l, t}), {0, 0, (h - t) * fraction(i, boards - 1)}), i % 2);
  }
  for (int i = 0; i <= columns; ++i) {
    const float x = (w - t) * (fraction(i, columns) - 0.5F);
    if (i > 0 && i < columns && d.chance(0.3)) continue;
    append(m, moved(box({t, l, h}), {x, 0, 0}), 0);
  }
  if (d.chance(0.4)) append(m, moved(box({w, t / 2, h}), {0, l / 2, 0}), 2);
}

void open_case(Mesh& m, Dice& d) {  // a box without one or two of its sides; U- and L-shaped if lying
  const float x = draw(d, 0.2, 0.6), y = draw(d, 0.15, 0.5), z = draw(d, 0.1, 0.5), t = draw(d, 0.008, 0.05);
  append(m, box({2 * x, 2 * y, t}), 0);
  const int missing = d.below(6);
  for (int i = 0; i < 4; ++i) {
    if (i == missing || (missing == 5 && i % 2 == 0)) continue;
    const float side = i < 2 ? -1.0F : 1.0F;
    append(m,
           i % 2 == 0 ? moved(box({t, 2 * y, z}), {side * (x - t / 2), 0, 0})
                      : moved(box({2 * x, t, z}), {0, side * (y - t / 2), 0}),
           d.chance(0.8) ? 0 : 1);
  }
  if (d.chance(0.3)) append(m, moved(box({t, 2 * y, z * 0.8F}), {x * draw(d, -0.5, 0.5), 0, 0}), 1);
}

void steps(Mesh& m, Dice& d) {  // solid, or treads between two cheeks
  const int n = d.between(2, 5);
  const float run = draw(d, 0.2, 0.35), rise = draw(d, 0.1, 0.22), w = draw(d, 0.3, 0.9);
  const bool open = d.chance(0.5);
  for (int i = 0; i < n; ++i) {
    const float z = rise * static_cast<float>(i + 1), x = run * static_cast<float>(i);
    append(m, open ? moved(box({run, w, 0.03F}), {x, 0, z - 0.03F}) : moved(box({run, w, z}), {x, 0, 0}), 0);
  }
  const float far = run * (static_cast<float>(n) - 0.5F), top = rise * static_cast<float>(n);
  for (const float y : {-w / 2, w / 2}) {
    if (open)
      append(m, moved(upright({{-run / 2, 0}, {far, 0}, {far, top}, {-run / 2, rise}}, 0.03F), {0, y, 0}), 1);
  }
}

void arches(Mesh& m, Dice& d) {
  const int n = d.between(1, 4);
  const float r = draw(d, 0.3, 0.6), leg = draw(d, 0, 0.6), gap = draw(d, 0.15, 0.5),
              thick = draw(d, 0.02, 0.12);
  const Outline section = d.chance(0.5) ? circle(thick, 10) : rectangle(thick * 2, thick * draw(d, 0.5, 3));
  for (int i = 0; i < n; ++i) {
    Path path = arc({0, gap * static_cast<float>(i), leg}, kX, kZ, 0, kPi, 18);
    for (Vec3& p : path) p.x *= r;
    if (leg > 0.1F) path.insert(path.begin(), {r, path[0].y, 0}), path.push_back({-r, path[0].y, 0});
    append(m, sweep(section, path), i % 2);
  }
  const float far = gap * static_cast<float>(n - 1);
  if (n > 1) append(m, beam({0, 0, leg + 1}, {0, far, leg + 1}, thick, thick), 2);
  if (n == 1) append(m, moved(box({2.4F * r, thick * 5, thick}), {}), 1);
}

void hoop(Mesh& m, Dice& d) {
  const float r = draw(d, 0.2, 0.5), thick = r * draw(d, 0.03, 0.2), flat = draw(d, 0.15, 2);
  const Outline section = d.chance(0.5) ? circle(thick, 12) : rectangle(thick, thick * flat);
  Path path = ring(40, r);
  const float oval = draw(d, 0.6, 1), wave = d.chance(0.3) ? draw(d, 0, 0.15) : 0;
  for (int i = 0; i < 40; ++i) path[static_cast<std::size_t>(i)].z += r * wave * std::sin(2 * turn_of(i, 40));
  append(m, scaled(sweep(section, path, {}, true), {1, oval, 1}));
}

void chain(Mesh& m, Dice& d) {
  const int n = d.between(2, 9);
  const float thick = draw(d, 0.1, 0.22), stretch = draw(d, 1, 1.9);
  Vec3 at;
  float heading = 0;
  for (int i = 0; i < n; ++i) {
    heading += draw(d, -0.6, 0.6);
    const Mesh link =
        turned(scaled(torus(1, thick, 28, 8), {stretch, 1, 1}), kX, i % 2 == 0 ? 0.2F : kPi / 2.3F);
    append(m, moved(turned(link, kZ, heading), at), i % 2);
    at = at + polar(2 * stretch - 2.2F * thick, heading);
  }
}

void handle(Mesh& m, Dice& d) {  // bows on a plate
  const float w = draw(d, 0.1, 0.4), h = draw(d, 0.08, 0.4), r = draw(d, 0.01, 0.04);
  append(m, plate(d, {2.4F * w, draw(d, 0.1, 0.4), draw(d, 0.01, 0.1)}), 0);
  const int n = d.between(1, 3);
  for (int i = 0; i < n; ++i) {
    const float y = 0.12F * (fraction(i, n) - 0.3F), lean = draw(d, -0.2, 0.2);
    append(
        m,
        tube(filleted({{-w, y, 0}, {-w, y + lean, h}, {w, y + lean, h}, {w, y, 0}}, draw(d, 0.02, 0.3)), r),
        1);
  }
}

void pipes(Mesh& m, Dice& d) {
  const float r = draw(d, 0.03, 0.12);
  Path path{{}};
  int axis = 2;
  const int n = d.between(2, 6);
  for (int i = 0; i < n; ++i) {
    const bool back = axis != 2 && d.chance(0.5);
    const float l = (back ? -1.0F : 1.0F) * draw(d, 0.25, 0.8);
    path.push_back(path.back() + l * (axis == 0 ? kX : axis == 1 ? kY : kZ));
    append(m, moved(ball({1.25F * r, 1.25F * r, 1.25F * r}, 10), path.back()), 1);
    axis = (axis + d.between(1, 2)) % 3;
  }
  append(m, tube(filleted(path, 2 * r), r, false, 14), 0);
  append(m, cylinder(1.8F * r, 0.4F * r), 1);
}

void bracket(Mesh& m, Dice& d) {  // L, T, U, Z and H profiles
  const float a = draw(d, 0.1, 0.35), w = draw(d, 0.5, 1), h = draw(d, 0.5, 1.2), l = draw(d, 0.1, 1.5);
  const float t = draw(d, 0.2, 0.8) * (w - a);
  const std::array<Outline, 5> shapes{
      Outline{{0, 0}, {w, 0}, {w, a}, {a, a}, {a, h}, {0, h}},
      Outline{{0, 0}, {w, 0}, {w, a}, {t + a, a}, {t + a, h}, {t, h}, {t, a}, {0, a}},
      Outline{{0, 0}, {w + a, 0}, {w + a, h}, {w, h}, {w, a}, {a, a}, {a, h}, {0, h}},
      Outline{{0, 0}, {w, 0}, {w, h}, {w + t, h}, {w + t, h + a}, {w - a, h + a}, {w - a, a}, {0, a}},
      Outline{{0, 0},
              {a, 0},
              {a, t},
              {w, t},
              {w, 0},
              {w + a, 0},
              {w + a, h + t},
              {w, h + t},
              {w, t + a},
              {a, t + a},
              {a, h + t},
              {0, h + t}}};
  const Outline& shape = d.pick(shapes);
  append(m, upright(d.chance(0.3) ? rounded(shape, a * 0.4F) : shape, l));
}

void picture_frame(Mesh& m, Dice& d) {  // leans on a strut
  const float w = draw(d, 0.3, 1), t = draw(d, 0.03, 0.2), deep = draw(d, 0.02, 0.15),
              lean = draw(d, 0.05, 0.35);
  const int n = d.chance(0.6) ? 4 : d.between(3, 9);
  Mesh frame = lathe({{w - t, 0}, {w, 0}, {w, deep}, {w - t, deep}}, n, true);
  if (d.chance(0.5)) append(frame, moved(cylinder(w - t / 2, 0.01F, n), {0, 0, deep * 0.3F}), 1);
  frame = turned(frame, kZ, kPi / static_cast<float>(n) - kPi / 2);
  append(m, turned(scaled(frame, {1, draw(d, 0.6, 1.5), 1}), kX, kPi / 2 - lean));
  settle(m);
  const Vec3 top = bounds(m)[1] - Vec3{0, deep / 2, deep / 2};
  if (lean > 0.2F) append(m, beam({0, top.y, top.z}, {0, top.y + top.z * 0.3F, 0}, t * 0.5F, t * 0.3F), 0);
}

void tripod(Mesh& m, Dice& d) {
  const float h = draw(d, 0.5, 1.6), spread = draw(d, 0.25, 0.7), r = draw(d, 0.01, 0.035),
              up = draw(d, 0, 0.5);
  const int legs = d.chance(0.8) ? 3 : 4;
  const float phase = draw(d, 0, 2);
  for (const Vec3 foot : ring(legs, spread, 0, phase)) append(m, rod(foot, {0, 0, h}, r), 0);
  if (d.chance(0.5)) Bars{m, r}.loop(ring(legs, spread * 0.6F, h * 0.4F, phase));
  append(m, rod({0, 0, h * 0.8F}, {0, 0, h + up}, r * 1.2F), 0);
  const float head = draw(d, 0.06, 0.3);
  const int kind = d.below(3);
  const Mesh top = kind == 0   ? box({head, head * 1.3F, head}, 0.02F)
                   : kind == 1 ? frustum(head * 0.3F, head, head)
                               : ball({head, head, head});
  append(m, moved(turned(top, kY, kind == 1 ? draw(d, 0, 2) : 0), {0, 0, h + up}), 1);
}

void basket(Mesh& m, Dice& d) {
  const int ribs = d.between(9, 28), hoops = d.between(2, 7);
  const float low = draw(d, 0.2, 0.4), high = draw(d, 0.3, 0.5), h = draw(d, 0.2, 0.8),
              t = draw(d, 0.008, 0.025);
  const float belly = draw(d, 0, 0.12), oval = draw(d, 0.6, 1);
  const auto radius = [&](float f) { return low + (high - low) * f + belly * std::sin(kPi * f); };
  for (int i = 0; i < ribs; ++i) {
    Path rib;
    for (int k = 0; k <= 6; ++k)
      rib.push_back(polar(radius(fraction(k, 6)), turn_of(i, ribs), h * fraction(k, 6)));
    append(m, tube(rib, t, false, 6), 0);
  }
  for (int k = 0; k <= hoops; ++k) {
    append(m,
           moved(torus(radius(fraction(k, hoops)), t * (k == hoops ? 1.8F : 1.0F), 36, 6),
                 {0, 0, h * fraction(k, hoops)}),
           0);
  }
  append(m, cylinder(low, 0.015F), 1);
  if (d.chance(0.4))
    append(m, tube(arc({0, 0, h}, radius(1) * kX, draw(d, 0.2, 0.6) * kZ, 0, kPi, 16), 1.5F * t), 1);
  m = scaled(m, {1, oval, 1});
}

void cage(Mesh& m, Dice& d) {
  const int bars = d.between(8, 24);
  const float r = draw(d, 0.25, 0.5), h = draw(d, 0.3, 1.2), dome = d.chance(0.6) ? draw(d, 0.1, 0.6) : 0,
              t = draw(d, 0.006, 0.02);
  for (int i = 0; i < bars; ++i) {
    const Vec3 foot = polar(r, turn_of(i, bars));
    Path path{foot};
    for (const Vec3 p : arc({0, 0, h}, foot, dome * kZ, 0, kPi / 2, dome > 0 ? 6 : 1)) path.push_back(p);
    append(m, tube(path, t, false, 6), 0);
  }
  append(m, cylinder(r * 1.05F, 0.04F), 1);
  for (const float z : {h * 0.5F, h}) append(m, moved(torus(r, t * 1.3F, 36, 6), {0, 0, z}), 0);
  append(m, moved(turned(torus(0.06F, 0.015F, 16, 6), kX, kPi / 2), {0, 0, h + dome + 0.05F}), 1);
}

void wheel_stand(Mesh& m, Dice& d) {
  const float r = draw(d, 0.2, 0.5), h = r * draw(d, 1.1, 1.8), w = draw(d, 0.06, 0.2);
  const int spokes = d.between(3, 16);
  append(m, moved(wheel(r, w * 0.6F, spokes, draw(d, 0.04, 0.14)), {0, 0, h - r}), 0);
  for (const float y : {-w, w}) {
    append(m, beam({-r * 0.6F, y, 0}, {0, y, h}, 0.03F, 0.03F), 1);
    append(m, beam({r * 0.6F, y, 0}, {0, y, h}, 0.03F, 0.03F), 1);
  }
  append(m, rod({0, -w, h}, {0, w, h}, 0.02F), 1);
}

/// A cloth over a rail along y at height `z`.
Mesh hung(Dice& d, float y, float z, float width) {
  const float front = z * draw(d, 0.2, 0.9), back = z * draw(d, 0.1, 0.9), fold = draw(d, 0, 0.05),
              waves = draw(d, 2, 6);
  const Path line = filleted({{-0.05F, 0, z - front}, {0, 0, z + 0.03F}, {0.05F, 0, z - back}}, 0.05F);
  const Mesh cloth = slab({width, 1, 0.01F}, 16, 24);
  const auto last = static_cast<float>(line.size() - 1);
  return warped(cloth, [&](Vec3 p) {
    const float t = (0.5F - p.y) * last;
    const auto i = static_cast<std::size_t>(std::clamp(t, 0.0F, last - 1));
    const Vec3 at = mix(line[i], line[i + 1], t - static_cast<float>(i));
    const float swing = fold * std::sin(waves * p.x / width * 6) * (z - at.z) / z;
    return Vec3{at.x + swing + (at.x < 0 ? -p.z : p.z), y + p.x, at.z + 0.5F * p.z};
  });
}

void clothes_rail(Mesh& m, Dice& d) {
  const float w = draw(d, 0.3, 0.8), h = draw(d, 0.5, 1.5);
  const Bars bar{m, draw(d, 0.02, 0.05)};
  bar({0, -w, h}, {0, w, h});
  for (const float y : {-w, w}) bar({0, y, 0}, {0, y, h}), bar({-0.25F, y, 0}, {0.25F, y, 0});
  const int cloths = d.between(0, 4);
  for (int i = 0; i < cloths; ++i) {
    const float y = w * (2 * fraction(i, cloths) - 0.8F);
    append(m, hung(d, y, h, 1.5F * w / static_cast<float>(cloths)), 1 + i % 3);
  }
}

void screen(Mesh& m, Dice& d) {  // folding panels
  const int n = d.between(2, 6);
  const float w = draw(d, 0.2, 0.6), h = draw(d, 0.5, 1.6), t = draw(d, 0.01, 0.05),
              angle = draw(d, 0.15, 1.1);
  const bool open = d.chance(0.3);
  Vec3 at;
  for (int i = 0; i < n; ++i) {
    const Vec3 next = at + polar(w, i % 2 == 0 ? angle : -angle);
    const Vec3 up{0, 0, h};
    if (open) Bars{m, 2 * t, false}.loop({at, next, next + up, at + up});
    if (!open) {
      append(m, moved(turned(moved(box({w, t, h}), {w / 2, 0, 0}), kZ, i % 2 == 0 ? angle : -angle), at),
             i % 2);
    }
    at = next;
  }
}

void dish_rack(Mesh& m, Dice& d) {
  const float x = draw(d, 0.2, 0.5), y = draw(d, 0.12, 0.3), h = draw(d, 0.08, 0.35),
              r = draw(d, 0.005, 0.014);
  const int n = d.between(4, 14);
  for (int i = 0; i <= n; ++i) {
    const float at = x * (2 * fraction(i, n) - 1), lean = 0.3F * h;
    append(
        m,
        tube(filleted({{at + lean, -y, h}, {at, -y, 0}, {at, y, 0}, {at + lean, y, h}}, 0.06F), r, false, 6),
        0);
  }
  Bars{m, 2.5F * r, true, 1}.loop(corners(x, y, 0));
  if (d.chance(0.5)) Bars{m, 2.5F * r, true, 1}.loop(corners(x, y, h));
}

void bead_frame(Mesh& m, Dice& d) {
  const int rows = d.between(2, 8);
  const float w = draw(d, 0.4, 1), h = draw(d, 0.4, 1), r = 0.35F * h / static_cast<float>(rows + 1),
              flat = draw(d, 0.5, 1);
  Bars{m, draw(d, 0.04, 0.09), false}.loop({{-w, 0, 0}, {w, 0, 0}, {w, 0, h}, {-w, 0, h}});
  for (int i = 1; i <= rows; ++i) {
    const float z = h * fraction(i, rows + 1);
    append(m, rod({-w, 0, z}, {w, 0, z}, 0.008F, 6), 0);
    float at = -w + r;
    for (int k = d.below(12); k > 0 && at < w - 2 * r; --k) {
      at += 2 * r * flat * (d.chance(0.15) ? 4.0F : 1.0F);
      if (at < w - r) append(m, moved(ball({r * flat, r, r}, 8), {at, 0, z}), 1 + i % 3);
    }
  }
  for (const float x : {-w, w}) append(m, beam({x, -0.15F, 0}, {x, 0.15F, 0}, 0.06F, 0.06F), 0);
}

void space_frame(Mesh& m, Dice& d) {  // nodes and rods, as molecules
  const float node = draw(d, 0.03, 0.16), thick = node * draw(d, 0.3, 0.8);
  Path nodes;
  const int n = d.between(4, 11);
  for (int i = 0; i < n; ++i) {
    const Vec3 from = nodes.empty() ? Vec3{} : nodes[static_cast<std::size_t>(d.below(i))];
    const Vec3 step{draw(d, -1, 1), draw(d, -1, 1), draw(d, -0.4, 1)};
    nodes.push_back(from + 0.5F * unit(step));
    append(m, moved(ball({node, node, node}, 10), nodes.back()), i % 2);
    if (i > 0) append(m, rod(from, nodes.back(), thick / 2), 2);
  }
  if (n > 6) append(m, rod(nodes[0], nodes[5], thick / 2), 2);
}

void wire_loop(Mesh& m, Dice& d) {  // a closed line through space
  Path path;
  const int n = d.between(4, 10);
  for (int i = 0; i < n; ++i) {
    const Vec3 out = polar(draw(d, 0.3, 1), turn_of(i, n) * (n > 7 ? 2.0F : 1.0F));
    path.push_back(out + Vec3{0, 0, draw(d, 0, 0.9)});
  }
  append(m, tube(spline(path, 12, true), draw(d, 0.015, 0.1), true, 10));
}

void cable(Mesh& m, Dice& d) {  // lies on the floor; some with a plug
  const float r = draw(d, 0.015, 0.05);
  const int n = d.between(4, 14);
  const Path path = scribble(d, n, draw(d, 0.4, 1), 2 * r);
  append(m, tube(path, r), 0);
  if (d.chance(0.6)) {
    append(
        m,
        limb(path.back(), path.back() + 6 * r * unit(path.back() - path[path.size() - 2]), 2.4F * r, 2 * r),
        1);
  }
}

void rope_pile(Mesh& m, Dice& d) {  // untidy loops on each other
  const int turns = d.between(2, 6);
  const float r = draw(d, 0.02, 0.06);
  Path path;
  for (int i = 0; i <= 7 * turns; ++i) {
    const float out = draw(d, 0.3, 0.55), lift = draw(d, 0, 0.5);
    path.push_back(polar(out, turn_of(i, 7), r * (1 + 0.25F * static_cast<float>(i) + lift)));
  }
  path.push_back(polar(1, draw(d, 0, 6), r));
  append(m, tube(spline(path, 4), r));
}

void hung_cable(Mesh& m, Dice& d) {  // over the edges of a box
  const Vec3 size{draw(d, 0.3, 0.8), draw(d, 0.3, 0.8), draw(d, 0.2, 0.9)};
  append(m, box(size, 0.02F), 0);
  const int n = d.between(1, 3);
  for (int i = 0; i < n; ++i) {
    const float r = draw(d, 0.01, 0.035), y = size.y * draw(d, -0.4, 0.4), x = size.x / 2 + r,
                top = size.z + r;
    const Vec3 left{-x, y, size.z * draw(d, 0, 0.6)}, right{x, y + draw(d, -0.1, 0.1), r};
    const Vec3 end = right + Vec3{draw(d, 0.1, 0.5), draw(d, -0.4, 0.4), 0};
    append(m, tube(filleted({left, {-x, y, top}, {x, y, top}, right, end}, 0.06F), r), 1 + i % 2);
  }
}

void bundle(Mesh& m, Dice& d) {  // rods held by a strap or a mug
  const int n = d.between(4, 22);
  const float r = draw(d, 0.01, 0.03), spread = draw(d, 0, 0.35),
              neck = r * 1.2F * std::sqrt(static_cast<float>(n));
  const float strap = draw(d, 0.3, 0.6);
  for (int i = 0; i < n; ++i) {
    const float out = neck * std::sqrt(fraction(i, n)), angle = 2.4F * static_cast<float>(i),
                top = draw(d, 0.7, 1.1);
    const Vec3 low = polar(out * (1 - spread), angle),
               high = polar(out + spread * draw(d, 0.3, 1), angle, top);
    append(m, d.chance(0.5) ? rod(low, high, r, 6) : rod(low, mix(low, high, 0.95F), r * 0.7F), i % 3);
  }
  d.chance(0.5)
      ? append(m, moved(torus(neck + r + 0.4F * spread * strap, r, 24, 6), {0, 0, strap}), 3)
      : append(m, lathe(hollow({{neck * 1.3F, -0.02F}, {neck * 1.3F + 0.3F * spread, strap}}, 0.01F)), 3);
}

}  // namespace

std::vector<Family> frame_families() {
  return {family<wire_box, 150, 1200>("wire box"),
          family<lattice_panel, 250, 1500>("lattice panel"),
          family<rack, 250, 1600, rarely>("rack"),
          family<airer, 400, 1400>("airer"),
          family<cart, 250, 1200>("cart"),
          family<stool, 200, 850, rarely>("stool"),
          family<tube_chair, 300, 1000>("tube chair"),
          family<pedestal, 200, 1100, rarely>("pedestal"),
          family<chair, 300, 1100, rarely>("chair"),
          family<table, 250, 1600, rarely>("table"),
          family<trestle, 300, 1200>("trestle"),
          family<shelf_unit, 250, 1600, rarely>("shelf unit"),
          family<open_case, 120, 800, often>("open case"),
          family<steps, 200, 1200>("steps"),
          family<arches, 150, 1500, rarely>("arches"),
          family<hoop, 80, 900, often>("hoop"),
          family<chain, 120, 900>("chain"),
          family<handle, 80, 500, rarely>("handle"),
          family<pipes, 150, 1200>("pipes"),
          family<bracket, 80, 900, often>("bracket"),
          family<picture_frame, 150, 900>("picture frame"),
          family<tripod, 250, 1700, rarely>("tripod"),
          family<basket, 150, 700, rarely>("basket"),
          family<cage, 200, 900>("cage"),
          family<wheel_stand, 200, 1000>("wheel stand"),
          family<clothes_rail, 400, 1700>("clothes rail"),
          family<screen, 250, 1700>("screen"),
          family<dish_rack, 200, 600>("dish rack"),
          family<bead_frame, 150, 800>("bead frame"),
          family<space_frame, 120, 900>("space frame"),
          family<wire_loop, 120, 900>("wire loop"),
          family<cable, 200, 1500>("cable"),
          family<rope_pile, 150, 800>("rope pile"),
          family<hung_cable, 200, 900>("hung cable"),
          family<bundle, 120, 900, often>("bundle")};
}

}  // namespace cairn::worlds
