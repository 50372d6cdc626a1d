// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace cairn::worlds {

struct Vec2 {
  float x = 0;
  float y = 0;
};

/// Metres.
struct Vec3 {
  float x = 0;
  float y = 0;
  float z = 0;
};
inline Vec3 operator+(Vec3 a, Vec3 b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline Vec3 operator-(Vec3 a, Vec3 b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Vec3 operator*(float s, Vec3 a) {
  return {s * a.x, s * a.y, s * a.z};
}
inline float dot(Vec3 a, Vec3 b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline Vec3 cross(Vec3 a, Vec3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// Triangles of one thing. z is up; the thing stands on z = 0 around x = y = 0 (lying families lie there).
struct Mesh {
  std::vector<Vec3> points;
  std::vector<Vec2> uv;  // of each point: metres along the surface, so that patterns keep their size
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::uint8_t> part;  // of each triangle, 0 … 3: parts may have different looks (legs and seat)
};

}  // namespace cairn::worlds
