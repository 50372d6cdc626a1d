#version 450
// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// The path to the right, the sums of all four, and the winners of both images (step 5): one team for each row.
#extension GL_GOOGLE_include_directive : require
#include "search.glsl"
#include "team.glsl"
#include "path.glsl"

// Sum and candidate in one number: the least is the winner, and of equal sums the smallest disparity.
const uint kNoKey = 0xFFFFFFFFu, kNoSum = 0xFFFFu;
const int kNoMatch = -32768;
uint key_of(uint sum, uint candidate) { return sum << 10 | candidate; }

// Four words of each pixel, and behind all of them one for each right pixel.
void write_found(int at, uint winner, uint beside, uint runner_up, uint total) {
  const int best = winner == kNoKey ? kNoMatch : search.first_d + int(winner & 1023);
  const uint sum = winner == kNoKey ? kNoSum : winner >> 10;
  found[4 * at] = sum << 16 | (uint(best) & 0xFFFFu);
  found[4 * at + 1] = beside;
  found[4 * at + 2] = runner_up;
  found[4 * at + 3] = total;
}

void write_found_right(int at, int best) { found[4 * pixels() + at] = uint(best); }

/// Right pixels of which no candidate is inside the left image.
void write_unmatched(int y) {
  for (int x = int(lane()); x < search.width; x += int(kTeam)) {
    const bool has_any = x + search.first_d < search.width && x + search.first_d + search.count - 1 >= 0;
    if (!has_any) write_found_right(pixel(x, y), kNoMatch);
  }
}

void main() {
  bool writes;
  const int y = path_of_team(search.height, writes), own = int(lane() * kOwn);
  if (writes) write_unmatched(y);
  begin_path();
  // Lane by lane, candidate i of left pixel x is right pixel x - first_d - i: with the next x, what was found for it so
  // far moves on by one candidate.
  uint of_right[kOwn];
  for (uint j = 0; j < kOwn; ++j) of_right[j] = kNoKey;
  uint ahead[kWords] = costs_of(pixel(0, y));
  for (int x = 0; x < search.width; ++x) {
    const uint words[kWords] = ahead;
    const int at = pixel(x, y);
    ahead = costs_of(pixel(min(x + 1, search.width - 1), y));
    const uint steps[kWords] = advance(words, large_penalty(pixel(max(x - 1, 0), y), at));

    uint keys[kOwn];
    uint winner = kNoKey, total = 0;
    for (uint k = 0; k < kWords; ++k) {
      const uint by_column = vertical[word_of(at) + k], by_left = leftward[word_of(at) + k];
      for (uint i = 0; i < 4; ++i) {
        const int candidate = own + int(4 * k + i), right_x = x - search.first_d - candidate;
        const uint sum = 4 * byte_of(words[k], i) + byte_of(steps[k], i) + byte_of(by_left, i) + byte_of(by_column, i);
        const bool exists = candidate < search.count && right_x >= 0 && right_x < search.width;
        keys[4 * k + i] = exists ? key_of(sum, uint(candidate)) : kNoKey;
        total += exists ? sum : 0;
        winner = min(winner, keys[4 * k + i]);
      }
    }
    winner = least_of_team(winner);

    const int best = winner == kNoKey ? -2 : int(winner & 1023);
    uint runner_up = kNoSum, beside = kNoSum << 16 | kNoSum;  // of best - 1, and of best + 1 above it
    for (uint j = 0; j < kOwn; ++j) {
      const uint sum = keys[j] == kNoKey ? kNoSum : keys[j] >> 10;
      const int apart = own + int(j) - best;
      if (abs(apart) > 1) runner_up = min(runner_up, sum);
      if (apart == -1) beside &= sum | kNoSum << 16;
      if (apart == 1) beside &= sum << 16 | kNoSum;
    }
    runner_up = least_of_team(runner_up);
    beside = bits_of_team(beside);
    total = sum_of_team(total);
    if (writes && lane() == 0) write_found(at, winner, beside, runner_up, total);

    const uint arrives = of_lane_before(of_right[kOwn - 1]);
    for (uint j = kOwn - 1; j > 0; --j) of_right[j] = min(of_right[j - 1], keys[j]);
    of_right[0] = min(lane() == 0 ? kNoKey : arrives, keys[0]);
    for (uint j = 0; j < kOwn; ++j) {
      const int candidate = own + int(j), right_x = x - search.first_d - candidate;
      const bool is_last = candidate == search.count - 1 || (x == search.width - 1 && candidate < search.count);
      if (writes && is_last && right_x >= 0 && right_x < search.width) {
        write_found_right(pixel(right_x, y), of_right[j] == kNoKey ? kNoMatch : search.first_d + int(of_right[j] & 1023));
      }
    }
  }
}
