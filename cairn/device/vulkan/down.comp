#version 450
// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// Steps 2 and 3, and the path down: one team for each column.
#extension GL_GOOGLE_include_directive : require
#include "search.glsl"
#include "team.glsl"
#include "path.glsl"

const uint kOutside = 1u << 31;
uint right_or_outside(int x, int y) { return x >= 0 && x < search.width ? right_census(pixel(x, y)) : kOutside; }
uint distance_of(uint left, uint right) { return right == kOutside ? 12 : bitCount(left ^ right); }

/// Of three pixels side by side, for the candidates of this lane.
uint[kOwn] sums_of_row(int x, int row) {
  const int y = clamp(row, 0, search.height - 1), first_d = search.first_d + int(lane() * kOwn);
  const bool has_before = x > 0, has_after = x < search.width - 1;
  const uint before = left_census(pixel(x - int(has_before), y)), here = left_census(pixel(x, y)),
             after = left_census(pixel(x + int(has_after), y));
  // From one candidate to the next, all three move one pixel to the left.
  uint right_after = right_or_outside(x + 1 - first_d, y), right_here = right_or_outside(x - first_d, y);
  uint sums[kOwn];
  for (uint j = 0; j < kOwn; ++j) {
    const uint right_before = right_or_outside(x - 1 - first_d - int(j), y);
    const uint middle = distance_of(here, right_here);
    sums[j] = middle + (has_before ? distance_of(before, right_before) : middle) +
              (has_after ? distance_of(after, right_after) : middle);
    right_after = right_here;
    right_here = right_before;
  }
  return sums;
}

void main() {
  bool writes;
  const int x = path_of_team(search.width, writes);
  uint above[kOwn] = sums_of_row(x, 0), here[kOwn] = above;
  begin_path();
  for (int y = 0; y < search.height; ++y) {
    const uint below[kOwn] = sums_of_row(x, y + 1);
    uint words[kWords];
    for (uint k = 0; k < kWords; ++k) words[k] = 0;
    for (uint j = 0; j < kOwn; ++j) {
      const uint cost = lane() * kOwn + j < search.count ? (above[j] + here[j] + below[j] + 2) / 4 : 255;
      words[j / 4] |= cost << (8 * (j % 4));
    }
    const int at = pixel(x, y);
    const uint steps[kWords] = advance(words, large_penalty(pixel(x, max(y - 1, 0)), at));
    for (uint k = 0; k < kWords && writes; ++k) {
      costs[word_of(at) + k] = words[k];
      vertical[word_of(at) + k] = steps[k];
    }
    above = here;
    here = below;
  }
}
