#version 450
// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// The path to the left: one team for each row.
#extension GL_GOOGLE_include_directive : require
#include "search.glsl"
#include "team.glsl"
#include "path.glsl"

void main() {
  bool writes;
  const int y = path_of_team(search.height, writes), last = search.width - 1;
  begin_path();
  uint ahead[kWords] = costs_of(pixel(last, y));
  for (int x = last; x >= 0; --x) {
    const uint words[kWords] = ahead;
    ahead = costs_of(pixel(max(x - 1, 0), y));
    const int at = pixel(x, y);
    const uint steps[kWords] = advance(words, large_penalty(pixel(min(x + 1, last), y), at));
    for (uint k = 0; k < kWords && writes; ++k) leftward[word_of(at) + k] = steps[k];
  }
}
