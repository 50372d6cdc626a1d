// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "lab/worlds/shapes.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>

namespace cairn::worlds {
namespace {

float cross2(Vec2 a, Vec2 b, Vec2 c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}
Vec3 flat(Vec2 p) {
  return {p.x, p.y, 0};
}

void add_triangle(Mesh& mesh, std::size_t a, std::size_t b, std::size_t c) {
  const Vec3 normal = cross(mesh.points[b] - mesh.points[a], mesh.points[c] - mesh.points[a]);
  if (dot(normal, normal) < 1e-20F) return;  // poles, doubled points of creases
  const auto index = [](std::size_t i) { return static_cast<std::uint32_t>(i); };
  mesh.triangles.push_back({index(a), index(b), index(c)});
  mesh.part.push_back(0);
}

/// A surface of (nu + 1) × (nv + 1) points; `at(i, j)` gives them. It faces where i × j points.
template <class F>
Mesh grid(int nu, int nv, F&& at) {
  Mesh mesh;
  const auto width = static_cast<std::size_t>(nu) + 1, height = static_cast<std::size_t>(nv) + 1;
  for (int j = 0; j <= nv; ++j) {
    for (int i = 0; i <= nu; ++i) mesh.points.push_back(at(i, j));
  }
  // u follows the longest row, v the mean distance between rows: exact for prisms, and no shear at poles.
  std::vector<float> u(width, 0.0F);
  for (std::size_t j = 0; j < height; ++j) {
    std::vector<float> row(width, 0.0F);
    for (std::size_t i = 1; i < width; ++i) {
      row[i] = row[i - 1] + length(mesh.points[j * width + i] - mesh.points[j * width + i - 1]);
    }
    if (row.back() > u.back()) u = std::move(row);
  }
  float v = 0;
  for (std::size_t j = 0; j < height; ++j) {
    float step = 0;
    for (std::size_t i = 0; i < width; ++i) {
      if (j > 0) step += length(mesh.points[j * width + i] - mesh.points[(j - 1) * width + i]);
    }
    v += step / static_cast<float>(width);
    for (std::size_t i = 0; i < width; ++i) mesh.uv.push_back({u[i], v});
  }
  for (std::size_t j = 0; j + 1 < height; ++j) {
    for (std::size_t i = 0; i + 1 < width; ++i) {
      const std::size_t a = j * width + i;
      add_triangle(mesh, a, a + 1, a + width + 1);
      add_triangle(mesh, a, a + width + 1, a + width);
    }
  }
  return mesh;
}

/// Doubles the points at which the line turns sharply, so that shading has an edge there.
Outline creased(const Outline& line, bool closed) {
  Outline made;
  const std::size_t n = line.size();
  for (std::size_t i = 0; i < n; ++i) {
    const bool inner = closed || (i > 0 && i + 1 < n);
    const Vec3 here = flat(line[i]);
    const Vec3 in = unit(here - flat(line[(i + n - 1) % n])), out = unit(flat(line[(i + 1) % n]) - here);
    made.push_back(line[i]);
    if (inner && dot(in, out) < 0.77F) made.push_back(line[i]);
  }
  if (closed) made.push_back(line.front());
  return made;
}

/// Fills a simple polygon by cutting off ears.
void fill(Mesh& mesh, const Outline& outline, const std::vector<std::size_t>& index, bool reversed) {
  std::vector<std::size_t> left(outline.size());
  for (std::size_t i = 0; i < left.size(); ++i) left[i] = i;
  for (std::size_t n = left.size(); n >= 3; --n) {
    std::size_t ear = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t a = left[(i + n - 1) % n], b = left[i], c = left[(i + 1) % n];
      bool free = cross2(outline[a], outline[b], outline[c]) > 0;
      for (std::size_t k = 0; free && k < n; ++k) {
        const std::size_t p = left[k];
        free = p == a || p == b || p == c || cross2(outline[a], outline[b], outline[p]) < 0 ||
               cross2(outline[b], outline[c], outline[p]) < 0 ||
               cross2(outline[c], outline[a], outline[p]) < 0;
      }
      if (free) {
        ear = i;
        break;
      }
    }
    const std::size_t a = index[left[(ear + n - 1) % n]], b = index[left[ear]],
                      c = index[left[(ear + 1) % n]];
    reversed ? add_triangle(mesh, a, c, b) : add_triangle(mesh, a, b, c);
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(ear));
  }
}

/// A flat convex face of a convex body around the origin, with its own points.
void add_face(Mesh& mesh, const std::vector<Vec3>& corners) {
  Vec3 normal = unit(cross(corners[1] - corners[0], corners[2] - corners[0]));
  const bool inward = dot(normal, corners[0]) < 0;
  if (inward) normal = -1.0F * normal;
  const Vec3 u = unit(cross(std::abs(normal.z) < 0.9F ? kZ : kY, normal)), v = cross(normal, u);
  const std::size_t first = mesh.points.size();
  for (const Vec3 corner : corners) {
    mesh.points.push_back(corner);
    mesh.uv.push_back({dot(corner, u), dot(corner, v)});
  }
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    inward ? add_triangle(mesh, first, first + i + 1, first + i)
           : add_triangle(mesh, first, first + i, first + i + 1);
  }
}

float signed_power(float x, float exponent) {
  return std::copysign(std::pow(std::abs(x), exponent), x);
}

}  // namespace

Outline circle(float radius, int n, float stretch) {
  Outline made;
  for (int i = 0; i < n; ++i) {
    made.push_back({radius * std::cos(turn_of(i, n)), radius * stretch * std::sin(turn_of(i, n))});
  }
  return made;
}

Outline rectangle(float width, float height) {
  const float x = width / 2, y = height / 2;
  return {{-x, -y}, {x, -y}, {x, y}, {-x, y}};
}

Outline star(int n, float outer, float inner) {
  Outline made;
  for (int i = 0; i < 2 * n; ++i) {
    const Vec3 p = polar(i % 2 == 0 ? outer : inner, turn_of(i, 2 * n));
    made.push_back({p.x, p.y});
  }
  return made;
}

Outline rounded(const Outline& outline, float radius) {
  Path path;
  for (std::size_t i = 0; i <= outline.size() + 1; ++i) path.push_back(flat(outline[i % outline.size()]));
  const Path smooth = filleted(path, radius);
  Outline made;  // without the open ends, which the first corner repeats
  for (std::size_t i = 1; i + 1 < smooth.size(); ++i) made.push_back({smooth[i].x, smooth[i].y});
  return made;
}

Path spline(const Path& through, int steps, bool closed) {
  Path made;
  const auto n = static_cast<std::ptrdiff_t>(through.size());
  const auto at = [&](std::ptrdiff_t i) {
    return through[static_cast<std::size_t>(closed ? (i + n) % n : std::clamp<std::ptrdiff_t>(i, 0, n - 1))];
  };
  for (std::ptrdiff_t i = 0; i < (closed ? n : n - 1); ++i) {
    const Vec3 a = at(i - 1), b = at(i), c = at(i + 1), d = at(i + 2);
    for (int k = 0; k < steps; ++k) {
      const float t = fraction(k, steps);
      const Vec3 bow = 2.0F * a - 5.0F * b + 4.0F * c - d, cubic = 3.0F * (b - c) + d - a;
      made.push_back(b + 0.5F * t * (c - a + t * (bow + t * cubic)));
    }
  }
  if (!closed) made.push_back(through.back());
  return made;
}

Path filleted(const Path& path, float radius) {
  Path made{path.front()};
  for (std::size_t i = 1; i + 1 < path.size(); ++i) {
    const Vec3 before = path[i - 1] - path[i], after = path[i + 1] - path[i];
    const float cut = std::min({radius, 0.49F * length(before), 0.49F * length(after)});
    const Vec3 from = path[i] + cut * unit(before), to = path[i] + cut * unit(after);
    for (int k = 0; k <= 5; ++k) {
      const float t = fraction(k, 5);
      made.push_back(mix(mix(from, path[i], t), mix(path[i], to, t), t));
    }
  }
  made.push_back(path.back());
  return made;
}

Path arc(Vec3 centre, Vec3 u, Vec3 v, float from, float to, int n) {
  Path made;
  for (int i = 0; i <= n; ++i) {
    const float angle = from + (to - from) * fraction(i, n);
    made.push_back(centre + std::cos(angle) * u + std::sin(angle) * v);
  }
  return made;
}

Mesh box(Vec3 size, float bevel) {
  const std::array<float, 3> half{size.x / 2, size.y / 2, size.z / 2};
  const float cut = std::min({bevel, 0.8F * half[0], 0.8F * half[1], 0.8F * half[2]});
  // Each corner is cut into three points, one on each of its faces.
  const auto corner = [&](std::array<int, 3> sign, std::size_t face) {
    std::array<float, 3> p{};
    for (std::size_t k = 0; k < 3; ++k)
      p[k] = static_cast<float>(sign[k]) * (half[k] - (k == face ? 0 : cut));
    return Vec3{p[0], p[1], p[2]};
  };
  Mesh mesh;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::size_t b = (a + 1) % 3, c = (a + 2) % 3;
    for (const int s : {-1, 1}) {
      std::vector<Vec3> face;
      for (const auto& [t, w] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
        std::array<int, 3> sign{};
        sign[a] = s, sign[b] = t, sign[c] = w;
        face.push_back(corner(sign, a));
      }
      add_face(mesh, face);
      for (const int t : {-1, 1}) {
        if (cut <= 0) continue;
        std::array<int, 3> low{}, high{};
        low[a] = high[a] = s, low[b] = high[b] = t, low[c] = -1, high[c] = 1;
        add_face(mesh, {corner(low, a), corner(low, b), corner(high, b), corner(high, a)});
        if (a == 0) add_face(mesh, {corner(low, 0), corner(low, 1), corner(low, 2)});
        if (a == 0) add_face(mesh, {corner(high, 0), corner(high, 1), corner(high, 2)});
      }
    }
  }
  return moved(std::move(mesh), {0, 0, half[2]});
}

Mesh slab(Vec3 size, int nx, int ny, int nz) {
  Mesh mesh;
  const std::array<float, 3> extent{size.x, size.y, size.z};
  const std::array<int, 3> n{nx, ny, nz};
  for (std::size_t a = 0; a < 3; ++a) {
    for (const bool far : {false, true}) {  // the far face looks along +a, where b × c points
      const std::size_t b = far ? (a + 1) % 3 : (a + 2) % 3, c = 3 - a - b;
      append(mesh, grid(n[b], n[c], [&](int i, int j) {
               std::array<float, 3> p{};
               p[a] = far ? extent[a] : 0, p[b] = extent[b] * fraction(i, n[b]);
               p[c] = extent[c] * fraction(j, n[c]);
               return Vec3{p[0] - size.x / 2, p[1] - size.y / 2, p[2]};
             }));
    }
  }
  return mesh;
}

Mesh frustum(float below, float above, float height, int sides) {
  return lathe({{below, 0}, {above, height}}, sides);
}
Mesh cylinder(float radius, float height, int sides) {
  return frustum(radius, radius, height, sides);
}

Mesh lathe(const Outline& profile, int sides, bool closed) {
  Outline whole;
  if (!closed && profile.front().x > 0) whole.push_back({0, profile.front().y});
  whole.insert(whole.end(), profile.begin(), profile.end());
  if (!closed && profile.back().x > 0) whole.push_back({0, profile.back().y});
  const Outline line = creased(whole, closed);
  const bool edges = sides <= 10;  // a prism: doubled points between its faces
  return grid(edges ? 2 * sides - 1 : sides, static_cast<int>(line.size()) - 1, [&](int i, int j) {
    const Vec2 p = line[static_cast<std::size_t>(j)];
    return polar(p.x, turn_of((edges ? (i + 1) / 2 : i) % sides, sides), p.y);
  });
}

Mesh superquadric(Vec3 radii, float vertical, float horizontal, int n) {
  return grid(2 * n, n, [&](int i, int j) {
    const float angle = turn_of(i % (2 * n), 2 * n), rise = kPi * (fraction(j, n) - 0.5F);
    const float across = j % n == 0 ? 0 : signed_power(std::cos(rise), vertical);
    return Vec3{radii.x * across * signed_power(std::cos(angle), horizontal),
                radii.y * across * signed_power(std::sin(angle), horizontal),
                radii.z * signed_power(std::sin(rise), vertical)};
  });
}

Mesh torus(float radius, float thickness, int sides, int section) {
  Outline profile = circle(thickness, section);
  for (Vec2& p : profile) p.x += radius;
  return lathe(profile, sides, true);
}

Mesh sweep(const Outline& section, const Path& path, const std::vector<float>& scales, bool closed) {
  const Outline line = creased(section, true);
  const std::size_t n = path.size();
  std::vector<Vec3> normal(n), tangent(n);
  for (std::size_t j = 0; j < n; ++j) {
    const Vec3 before = path[closed || j > 0 ? (j + n - 1) % n : 0];
    const Vec3 after = path[closed || j + 1 < n ? (j + 1) % n : n - 1];
    tangent[j] = unit(unit(path[j] - before) + unit(after - path[j]));
    const Vec3 start = std::abs(tangent[j].x) < 0.9F ? kX : kY;
    const Vec3 carried = j == 0 ? start : normal[j - 1];  // the frame turns no more than the path does
    normal[j] = unit(carried - dot(carried, tangent[j]) * tangent[j]);
  }
  // A closed path returns with a turned frame: spread the turn over it.
  float turn = 0;
  if (closed) {
    const Vec3 back = normal[n - 1] - dot(normal[n - 1], tangent[0]) * tangent[0];
    turn = std::atan2(dot(cross(back, normal[0]), tangent[0]), dot(back, normal[0]));
  }
  const auto placed = [&](Vec2 p, std::size_t j, float share) {
    const float scale = scales.empty() ? 1 : scales[j], cos = std::cos(turn * share),
                sin = std::sin(turn * share);
    const Vec3 up = cross(tangent[j], normal[j]);
    return path[j] + scale * ((cos * p.x - sin * p.y) * normal[j] + (sin * p.x + cos * p.y) * up);
  };
  const int rows = static_cast<int>(closed ? n : n - 1);
  Mesh mesh = grid(static_cast<int>(line.size()) - 1, rows, [&](int i, int j) {
    const std::size_t at = static_cast<std::size_t>(j) % n;
    return placed(line[static_cast<std::size_t>(i)], at, j == rows ? 0 : fraction(j, rows));
  });
  for (const bool last : {false, true}) {
    const std::size_t j = last ? n - 1 : 0;
    if (closed || (!scales.empty() && scales[j] <= 0)) continue;
    std::vector<std::size_t> index;
    for (const Vec2 p : section) {
      index.push_back(mesh.points.size());
      mesh.points.push_back(placed(p, j, 0));
      mesh.uv.push_back(p);
    }
    fill(mesh, section, index, !last);
  }
  return mesh;
}

Mesh tube(const Path& path, float radius, bool closed, int sides) {
  return sweep(circle(radius, sides), path, {}, closed);
}
Mesh rod(Vec3 from, Vec3 to, float radius, int sides) {
  return tube({from, to}, radius, false, sides);
}
Mesh beam(Vec3 from, Vec3 to, float width, float height) {
  return sweep(rectangle(width, height), {from, to});
}

Mesh limb(Vec3 from, Vec3 to, float radius_from, float radius_to, int sides) {
  const Vec3 along = unit(to - from);
  Path path;
  std::vector<float> scales;
  constexpr int kSteps = 4;
  for (int k = 0; k <= 2 * kSteps + 1; ++k) {
    const bool start = k <= kSteps;
    const float angle = kPi / 2 * fraction(start ? k - kSteps : k - kSteps - 1, kSteps);
    path.push_back((start ? from : to) + (start ? radius_from : radius_to) * std::sin(angle) * along);
    const bool pole = k == 0 || k == 2 * kSteps + 1;
    scales.push_back(pole ? 0 : (start ? radius_from : radius_to) * std::cos(angle));
  }
  return sweep(circle(1, sides), path, scales);
}

Mesh extrusion(const Outline& outline, float height) {
  return sweep(outline, {{0, 0, 0}, {0, 0, height}});
}

Mesh blob(Vec3 radii, float bumps, float frequency, Dice& dice, int n) {
  struct Wave {
    Vec3 direction;
    float phase = 0;
  };
  std::array<Wave, 6> waves;
  for (Wave& wave : waves) {
    const Vec3 direction{draw(dice, -1, 1), draw(dice, -1, 1), draw(dice, -1, 1)};
    wave = {frequency * draw(dice, 0.6, 1.4) * unit(direction), draw(dice, 0, 2 * kPi)};
  }
  return warped(ball({1, 1, 1}, n), [&](Vec3 p) {
    float swell = 0;
    for (const Wave& wave : waves) swell += std::sin(dot(wave.direction, p) + wave.phase);
    const float scale = 1 + bumps * swell / 3;
    return Vec3{radii.x * scale * p.x, radii.y * scale * p.y, radii.z * scale * p.z};
  });
}

void append(Mesh& mesh, const Mesh& other, int part) {
  const auto first = static_cast<std::uint32_t>(mesh.points.size());
  mesh.points.insert(mesh.points.end(), other.points.begin(), other.points.end());
  mesh.uv.insert(mesh.uv.end(), other.uv.begin(), other.uv.end());
  for (std::size_t i = 0; i < other.triangles.size(); ++i) {
    const auto [a, b, c] = other.triangles[i];
    mesh.triangles.push_back({first + a, first + b, first + c});
    mesh.part.push_back(part < 0 ? other.part[i] : static_cast<std::uint8_t>(part));
  }
}

Mesh moved(Mesh mesh, Vec3 by) {
  return warped(std::move(mesh), [by](Vec3 p) { return p + by; });
}

Mesh turned(Mesh mesh, Vec3 axis, float angle) {
  const Vec3 a = unit(axis);
  const float cos = std::cos(angle), sin = std::sin(angle);
  return warped(std::move(mesh),
                [&](Vec3 p) { return cos * p + sin * cross(a, p) + (1 - cos) * dot(a, p) * a; });
}

Mesh scaled(Mesh mesh, Vec3 factors) {
  if (factors.x * factors.y * factors.z < 0) {  // mirrored: turn the triangles
    for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  }
  const float mean = std::cbrt(std::abs(factors.x * factors.y * factors.z));
  for (Vec2& uv : mesh.uv) uv = {mean * uv.x, mean * uv.y};
  return warped(std::move(mesh), [&](Vec3 p) {
    return Vec3{factors.x * p.x, factors.y * p.y, factors.z * p.z};
  });
}

Mesh bent(Mesh mesh, float angle) {
  const auto [low, high] = bounds(mesh);
  if (std::abs(angle) < 1e-3F) return mesh;
  const float radius = (high.z - low.z) / angle;
  return warped(std::move(mesh), [&, low = low](Vec3 p) {
    const float a = (p.z - low.z) / radius;
    return Vec3{radius - (radius - p.x) * std::cos(a), p.y, low.z + (radius - p.x) * std::sin(a)};
  });
}

Mesh twisted(Mesh mesh, float angle) {
  const auto [low, high] = bounds(mesh);
  return warped(std::move(mesh), [&, low = low, high = high](Vec3 p) {
    const float a = angle * (p.z - low.z) / (high.z - low.z);
    return Vec3{p.x * std::cos(a) - p.y * std::sin(a), p.x * std::sin(a) + p.y * std::cos(a), p.z};
  });
}

Mesh tapered(Mesh mesh, float top) {
  const auto [low, high] = bounds(mesh);
  return warped(std::move(mesh), [&, low = low, high = high](Vec3 p) {
    const float scale = 1 + (top - 1) * (p.z - low.z) / (high.z - low.z);
    return Vec3{p.x * scale, p.y * scale, p.z};
  });
}

Mesh dented(Mesh mesh, Dice& dice, int dents, float depth) {
  const auto [low, high] = bounds(mesh);
  const Vec3 centre = mix(low, high, 0.5F);
  for (int i = 0; i < dents; ++i) {
    const Vec3 at = mesh.points[static_cast<std::size_t>(dice.below(static_cast<int>(mesh.points.size())))];
    const float radius = length(high - low) * draw(dice, 0.08, 0.2);
    const Vec3 push = depth * length(high - low) * unit(centre - at);
    mesh = warped(std::move(mesh), [&](Vec3 p) {
      const float distance = length(p - at) / radius;
      return p + std::exp(-distance * distance) * push;
    });
  }
  return mesh;
}

std::array<Vec3, 2> bounds(const Mesh& mesh) {
  constexpr float kFar = std::numeric_limits<float>::max();
  Vec3 low{kFar, kFar, kFar}, high{-kFar, -kFar, -kFar};
  for (const Vec3 p : mesh.points) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  return {low, high};
}

void resize(Mesh& mesh, float longest) {
  const auto [low, high] = bounds(mesh);
  const Vec3 size = high - low;
  const float factor = longest / std::max({size.x, size.y, size.z});
  mesh = scaled(std::move(mesh), {factor, factor, factor});
}

void settle(Mesh& mesh) {
  const auto [low, high] = bounds(mesh);
  mesh = moved(std::move(mesh), {-(low.x + high.x) / 2, -(low.y + high.y) / 2, -low.z});
}

}  // namespace cairn::worlds
