// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>
#include <cairn/core/error.hpp>
#include <cairn/scene/ground_plane.hpp>
#include <cairn/scene/homography.hpp>

#include <limits>
#include <string>

namespace cairn {
namespace {

constexpr std::array<double, 9> kFloor{1.01, -0.12, 8, 0, 1, 0, 0, 0, 1};  // d = −0.01·x + 0.12·y − 8

PointPair pair_at(const std::array<double, 9>& h, double x, double y) {
  const auto [u, v] = map_to_right({h}, x, y);
  return {static_cast<float>(x), static_cast<float>(y), static_cast<float>(u), static_cast<float>(v)};
}

std::vector<PointPair> pairs(const std::array<double, 9>& h, int count) {
  constexpr std::array<std::array<double, 2>, 12> kSpots{{{20, 130},
                                                          {300, 120},
                                                          {40, 230},
                                                          {280, 235},
                                                          {160, 180},
                                                          {90, 150},
                                                          {220, 210},
                                                          {130, 225},
                                                          {250, 140},
                                                          {60, 190},
                                                          {200, 160},
                                                          {310, 200}}};
  std::vector<PointPair> list;
  for (int i = 0; i < count; ++i) {
    const auto& spot = kSpots[static_cast<std::size_t>(i)];
    list.push_back(pair_at(h, spot[0], spot[1]));
  }
  return list;
}

std::string complaint(const std::vector<PointPair>& points) {
  try {
    ground_from_points(points);
  } catch (const Error& error) {
    return error.what();
  }
  return "accepted";
}

void expect_maps_like(const Homography& found, const std::array<double, 9>& truth, double tolerance) {
  for (const auto [x, y] : {Point{0, 120}, Point{319, 120}, Point{0, 239}, Point{319, 239}}) {
    const auto is = map_to_right(found, x, y);
    const auto should = map_to_right({truth}, x, y);
    EXPECT_NEAR(is[0], should[0], tolerance);
    EXPECT_NEAR(is[1], should[1], tolerance);
  }
}

TEST(Homography, FourPairsDetermineIt) {
  const std::array<double, 9> general{0.9, 0.05, 12, -0.03, 1.1, 7, 0.0002, -0.0001, 1};
  const auto found = fit_homography(pairs(general, 4));
  ASSERT_TRUE(found);
  expect_maps_like(*found, general, 1e-3);
}

TEST(Homography, ManyPairsAverageTheirErrors) {
  auto list = pairs(kFloor, 12);
  for (std::size_t i = 0; i < list.size(); ++i) list[i].x_right += i % 2 == 0 ? 0.3F : -0.3F;
  const auto found = fit_homography(list);
  ASSERT_TRUE(found);
  expect_maps_like(*found, kFloor, 1.5);
}

TEST(Homography, NoneFromThreePairsOrFromALine) {
  EXPECT_FALSE(fit_homography(pairs(kFloor, 3)));
  std::vector<PointPair> line;
  line.reserve(6);
  for (int i = 0; i < 6; ++i) line.push_back(pair_at(kFloor, 10 + 40 * i, 100 + 20 * i));
  EXPECT_FALSE(fit_homography(line));
  line.push_back(pair_at(kFloor, 30, 230));
  EXPECT_FALSE(fit_homography(line)) << "one point off the line is not enough";
}

TEST(Homography, WrongPairsAreLeftOut) {
  for (const int count : {6, 8, 12}) {
    auto list = pairs(kFloor, count);
    list[1].x_right += 40;
    list[3].x_right -= 25;
    const auto found = fit_homography_robustly(list);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->inliers.size(), static_cast<std::size_t>(count - 2));
    expect_maps_like(found->homography, kFloor, 1e-2);
  }
}

TEST(Homography, OfFivePairsTheOneThatLiesOnNoCommonPlaneIsLeftOut) {
  for (std::size_t wrong = 0; wrong < 5; ++wrong) {
    auto list = pairs(kFloor, 5);
    list[wrong].x_right += 15;
    const auto found = fit_homography_robustly(list);
    ASSERT_TRUE(found);
    ASSERT_EQ(found->inliers.size(), 4U);
    for (const auto& inlier : found->inliers) EXPECT_FALSE(inlier == list[wrong]);
  }
}

TEST(GroundFromPoints, ExactPairsGiveThePlane) {
  for (const int count : {4, 5, 12}) {
    const Ground ground = ground_from_points(pairs(kFloor, count));
    ASSERT_TRUE(ground.plane);
    EXPECT_NEAR(ground.plane->a, -0.01, 1e-5);
    EXPECT_NEAR(ground.plane->b, 0.12, 1e-5);
    EXPECT_NEAR(ground.plane->c, -8, 2e-3);
    EXPECT_NEAR(ground.residual_px, 0, 1e-3);
    EXPECT_EQ(ground.support, 1.0F);
    EXPECT_EQ(ground.refusal, Refusal::none);
  }
}

TEST(GroundFromPoints, TheResidualTellsHowWellThePairsAgree) {
  auto list = pairs(kFloor, 12);
  for (std::size_t i = 0; i < list.size(); ++i) list[i].x_right += i % 3 == 0 ? 0.6F : -0.3F;
  const Ground ground = ground_from_points(list);
  EXPECT_GT(ground.residual_px, 0.2F);
  EXPECT_LT(ground.residual_px, 0.7F);
}

TEST(GroundFromPoints, RefusesWhatDeterminesNoPlaneAndSaysWhy) {
  EXPECT_NE(complaint(pairs(kFloor, 3)).find("found 3"), std::string::npos);
  EXPECT_NE(complaint({}).find("ground_points"), std::string::npos);

  std::vector<PointPair> line;
  line.reserve(6);
  for (int i = 0; i < 5; ++i) line.push_back(pair_at(kFloor, 10 + 40 * i, 100 + 20 * i));
  EXPECT_NE(complaint(line).find("line"), std::string::npos);
  EXPECT_NE(complaint(std::vector<PointPair>(6, pair_at(kFloor, 50, 200))).find("ground_points"),
            std::string::npos);

  auto broken = pairs(kFloor, 5);
  broken[2].y_left = std::numeric_limits<float>::infinity();
  EXPECT_NE(complaint(broken).find("pair 3"), std::string::npos);
}

}  // namespace
}  // namespace cairn
