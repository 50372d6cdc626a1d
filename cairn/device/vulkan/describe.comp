#version 450
// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// Steps 1 and 4: census of both images, and the smoothed left one; one invocation for each pixel.
#extension GL_GOOGLE_include_directive : require
#include "search.glsl"

int byte_at(int x, int y) {
  return clamp(y, 0, search.height - 1) * 4 * search.row_words + clamp(x, 0, search.width - 1);
}
uint left_at(int x, int y) { const int i = byte_at(x, y); return byte_of(given[i / 4], i % 4); }
uint right_at(int x, int y) { const int i = byte_at(x, y); return byte_of(given[image_words() + i / 4], i % 4); }

void describe(int at) {
  const int x = at % search.width, y = at / search.width;
  const uint weights[5] = uint[5](6, 58, 128, 58, 6);
  const uint left_centre = left_at(x, y), right_centre = right_at(x, y);
  uint left_bits = 0, right_bits = 0, sum = 0;
  for (int v = -2; v <= 2; ++v) {
    for (int u = -2; u <= 2; ++u) {
      const uint grey = left_at(x + u, y + v);
      sum += weights[v + 2] * weights[u + 2] * grey;
      if (u == 0 && v == 0) continue;
      left_bits = left_bits << 1 | uint(grey < left_centre);
      right_bits = right_bits << 1 | uint(right_at(x + u, y + v) < right_centre);
    }
  }
  described[at] = left_bits;
  described[pixels() + at] = right_bits;
  described[2 * pixels() + at] = (sum + 32768) >> 16;
}

void main() {
  // Devices may limit the number of groups to 65,535.
  const int step = int(gl_NumWorkGroups.x * kGroup);
  for (int at = int(gl_GlobalInvocationID.x); at < pixels(); at += step) describe(at);
}
