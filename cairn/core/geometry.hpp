// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>

namespace cairn {

struct Size {
  int width = 0;
  int height = 0;
  friend constexpr bool operator==(Size, Size) = default;
  [[nodiscard]] constexpr std::int64_t area() const { return std::int64_t{width} * height; }
};

/// "640x480", the form used in messages.
inline std::string text(Size size) {
  return std::to_string(size.width) + "x" + std::to_string(size.height);
}

struct Point {
  int x = 0;
  int y = 0;
  friend constexpr bool operator==(Point, Point) = default;
};

/// Half-open: covers x … x+width-1 and y … y+height-1.
struct Rect {
  int x = 0;
  int y = 0;
  int width = 0;
  int height = 0;
  friend constexpr bool operator==(Rect, Rect) = default;
};

/// The smallest rectangle that covers both; an empty one (width 0) covers nothing.
constexpr Rect united(Rect a, Rect b) {
  if (a.width == 0) return b;
  if (b.width == 0) return a;
  const int x = std::min(a.x, b.x);
  const int y = std::min(a.y, b.y);
  return {x, y, std::max(a.x + a.width, b.x + b.width) - x, std::max(a.y + a.height, b.y + b.height) - y};
}

/// The number of columns and rows between two rectangles; 0 if they touch or overlap along that axis.
constexpr Size gap_between(Rect a, Rect b) {
  return {std::max({a.x - b.x - b.width, b.x - a.x - a.width, 0}),
          std::max({a.y - b.y - b.height, b.y - a.y - a.height, 0})};
}

/// A vector or position; the name of the variable states unit and frame (position_in_camera_m).
struct Vec3 {
  float x = 0;
  float y = 0;
  float z = 0;
  friend constexpr bool operator==(Vec3, Vec3) = default;
};

}  // namespace cairn
