// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// One path, pixel by pixel (semi_global.hpp, step 4). Lanes beyond `count` have C = 255: L of a candidate is at most
// 54 + 127, so they never win, and in 32 bits they need no saturation.
const uint kNever = 1u << 20;

uint along[kOwn];  // L of the pixel before
uint least_along;
uint small_step;

void begin_path() {
  small_step = small_penalty();
  for (uint j = 0; j < kOwn; ++j) along[j] = 0;
  least_along = 0;
}

/// From the pixel before to one with these costs; returns L - C, as bytes.
uint[kWords] advance(uint words[kWords], uint large) {
  const uint from_before = of_lane_before(along[kOwn - 1]), from_after = of_lane_after(along[0]);
  uint before = lane() == 0 ? kNever : from_before;
  const uint after = lane() == kTeam - 1 ? kNever : from_after;
  uint steps[kWords];
  for (uint k = 0; k < kWords; ++k) steps[k] = 0;
  uint least = kNever;
  for (uint j = 0; j < kOwn; ++j) {
    const uint here = along[j];
    const uint beside = min(before, j + 1 < kOwn ? along[j + 1] : after);
    const uint raise = min(min(here, beside + small_step) - least_along, large);
    before = here;
    steps[j / 4] |= raise << (8 * (j % 4));
    along[j] = byte_of(words[j / 4], j % 4) + raise;
    least = min(least, along[j]);
  }
  least_along = least_of_team(least);
  return steps;
}

uint large_penalty(int from, int to) { return large_penalty_of(abs(smooth_left(to) - smooth_left(from))); }

/// The first word of this lane, of a pixel.
uint word_of(int at) { return uint(at) * kTeam * kWords + lane() * kWords; }

uint[kWords] costs_of(int at) {
  uint words[kWords];
  for (uint k = 0; k < kWords; ++k) words[k] = costs[word_of(at) + k];
  return words;
}
