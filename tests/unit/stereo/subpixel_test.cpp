// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/stereo/subpixel.hpp>
#include <cmath>

namespace {

using namespace cairn;

template <class T>
Image<T> one(T value) {
  return Image<T>({1, 1}, value, Pool{});
}

/// One pixel with disparity 7 and these costs at 6, 7 and 8.
Matches pixel(float before, float least, float after, std::int16_t best = 7) {
  Matches matches;
  matches.best = one(best);
  matches.cost = one(least);
  matches.cost_before = one(before);
  matches.cost_after = one(after);
  return matches;
}

float refined(const Matches& matches, SubpixelMethod method = SubpixelMethod::parabola) {
  return refine_subpixel(matches, {.method = method}, {})(0, 0);
}

TEST(Subpixel, FindsTheVertexOfAnExactParabola) {
  // (d − 7.25)² · 16 + 3 at d = 6, 7, 8
  EXPECT_EQ(refined(pixel(28, 4, 12)), 7.25F);
  EXPECT_EQ(refined(pixel(12, 4, 28)), 6.75F);
  EXPECT_EQ(refined(pixel(9, 1, 9)), 7.0F);
}

float refined_by_lines(const Matches& matches) {
  return refine_subpixel(matches, {.method = SubpixelMethod::equiangular}, {})(0, 0);
}

TEST(Subpixel, FindsTheTipOfTwoLinesOfOppositeSlope) {
  // |d − 7.25| · 8 + 3 at d = 6, 7, 8
  EXPECT_EQ(refined_by_lines(pixel(13, 5, 9)), 7.25F);
  EXPECT_EQ(refined_by_lines(pixel(9, 5, 13)), 6.75F);
  EXPECT_EQ(refined_by_lines(pixel(9, 1, 1)), 7.5F);
  EXPECT_EQ(refined_by_lines(pixel(1, 1, 9)), 6.5F);
}

TEST(Subpixel, KeepsTheIntegerDisparityIfNoLinesFit) {
  EXPECT_EQ(refined_by_lines(pixel(5, 5, 5)), 7.0F);
  EXPECT_EQ(refined_by_lines(pixel(kNoCost, 1, 9)), 7.0F);
  EXPECT_EQ(refined_by_lines(pixel(9, 1, kNoCost)), 7.0F);
}

TEST(Subpixel, NeverLeavesTheHalfPixelAroundTheWinner) {
  EXPECT_EQ(refined(pixel(9, 1, 1)), 7.5F);
  EXPECT_EQ(refined(pixel(1, 1, 9)), 6.5F);
}

TEST(Subpixel, KeepsTheWholePixelWithoutANeighbour) {
  EXPECT_EQ(refined(pixel(kNoCost, 1, 9)), 7.0F);
  EXPECT_EQ(refined(pixel(9, 1, kNoCost)), 7.0F);
  EXPECT_EQ(refined(pixel(kNoCost, 1, kNoCost)), 7.0F);
}

TEST(Subpixel, KeepsTheWholePixelWhereTheCostsAreFlat) {
  EXPECT_EQ(refined(pixel(5, 5, 5)), 7.0F);
}

TEST(Subpixel, KeepsTheWholePixelWhenSwitchedOffOrWithoutEvidence) {
  EXPECT_EQ(refined(pixel(28, 4, 12), SubpixelMethod::none), 7.0F);
  Matches winner_only;
  winner_only.best = one<std::int16_t>(7);
  winner_only.cost = one(4.0F);
  EXPECT_EQ(refined(winner_only), 7.0F);
}

TEST(Subpixel, LeavesNaNWhereNothingMatched) {
  EXPECT_TRUE(std::isnan(refined(pixel(kNoCost, kNoCost, kNoCost, kNoMatch))));
}

}  // namespace
