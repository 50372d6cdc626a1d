// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// What the kernels of match_semi_global() share; cairn/stereo/semi_global.hpp defines the steps. Integers of 32 bits
// only, so every device gets the same bits.
layout(local_size_x_id = 0) in;
layout(constant_id = 0) const uint kGroup = 64;  // invocations of a group
layout(constant_id = 1) const uint kTeam = 8;    // lanes that follow one path together: a power of two

// Candidates of a lane: four in a word. A macro, because a specialization constant may not size all arrays.
const uint kWords = CAIRN_WORDS;
const uint kOwn = 4 * kWords;

layout(push_constant) uniform Search {
  int width;
  int height;
  int first_d;
  int count;      // candidates; their lanes are rounded up to kTeam * kOwn
  int row_words;  // of an image, four pixels in a word
} search;

// Six buffers: some drivers have no more than eight. vulkan_engine.cpp fills the first and reads the last one.
layout(std430, binding = 0) readonly buffer Input { uint given[]; };
layout(std430, binding = 1) buffer Described { uint described[]; };
// One byte for each candidate of a pixel: C; L - C of the path down plus that of the path up; L - C of the path left.
layout(std430, binding = 2) buffer Costs { uint costs[]; };
layout(std430, binding = 3) buffer Vertical { uint vertical[]; };
layout(std430, binding = 4) buffer Leftward { uint leftward[]; };
layout(std430, binding = 5) buffer Found { uint found[]; };

int pixel(int x, int y) { return y * search.width + x; }
int pixels() { return search.width * search.height; }

// The input: left image, right image, penalty of a small step, penalties of a large step by the step of intensity.
int image_words() { return search.row_words * search.height; }
uint small_penalty() { return given[2 * image_words()]; }
uint large_penalty_of(int step) { return given[2 * image_words() + 1 + step]; }

// What describe.comp leaves of each pixel: left census, right census, smoothed left image.
uint left_census(int at) { return described[at]; }
uint right_census(int at) { return described[pixels() + at]; }
int smooth_left(int at) { return int(described[2 * pixels() + at]); }

uint byte_of(uint word, uint i) { return bitfieldExtract(word, int(8 * i), 8); }
