#version 450
// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// The path up, added to that down: one team for each column. Both together are at most 254, so whole words are added.
#extension GL_GOOGLE_include_directive : require
#include "search.glsl"
#include "team.glsl"
#include "path.glsl"

void main() {
  bool writes;
  const int x = path_of_team(search.width, writes), last = search.height - 1;
  begin_path();
  // Costs are read one pixel ahead, also below.
  uint ahead[kWords] = costs_of(pixel(x, last));
  for (int y = last; y >= 0; --y) {
    const uint words[kWords] = ahead;
    ahead = costs_of(pixel(x, max(y - 1, 0)));
    const int at = pixel(x, y);
    const uint steps[kWords] = advance(words, large_penalty(pixel(x, min(y + 1, last)), at));
    for (uint k = 0; k < kWords && writes; ++k) vertical[word_of(at) + k] += steps[k];
  }
}
