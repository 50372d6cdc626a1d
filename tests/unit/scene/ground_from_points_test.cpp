// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>
#include <cairn/core/error.hpp>
#include <cairn/scene/ground_plane.hpp>

#include <limits>
#include <string>

namespace cairn {
namespace {

PointPair pair_at(double x, double y) {
  const double disparity = -0.01 * x + 0.12 * y - 8;
  return {static_cast<float>(x), static_cast<float>(y), static_cast<float>(x - disparity),
          static_cast<float>(y)};
}

std::vector<PointPair> pairs(int count) {
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
    list.push_back(pair_at(spot[0], spot[1]));
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

void expect_floor(const Ground& ground, double tolerance) {
  ASSERT_TRUE(ground.plane);
  EXPECT_NEAR(ground.plane->a, -0.01, tolerance);
  EXPECT_NEAR(ground.plane->b, 0.12, tolerance);
  EXPECT_NEAR(ground.plane->c, -8, 200 * tolerance);
}

TEST(GroundFromPoints, ManyPairsAverageTheirErrors) {
  auto list = pairs(12);
  for (std::size_t i = 0; i < list.size(); ++i) list[i].x_right += i % 2 == 0 ? 0.3F : -0.3F;
  expect_floor(ground_from_points(list), 4e-3);
}

TEST(GroundFromPoints, WrongPairsAreRejected) {
  for (const int count : {6, 8, 12}) {
    auto list = pairs(count);
    list[1].x_right += 40;
    list[3].x_right -= 25;
    expect_floor(ground_from_points(list), 1e-5);
  }
}

TEST(GroundFromPoints, WrongPairsOfManyAreRejected) {
  std::vector<PointPair> list;
  for (int i = 0; i < 40; ++i) list.push_back(pair_at(20 + 37 * i % 280, 120 + 53 * i % 110));
  for (std::size_t i = 0; i < list.size(); i += 3) list[i].x_right += i % 2 == 0 ? 30.0F : -20.0F;
  expect_floor(ground_from_points(list), 1e-5);
}

TEST(GroundFromPoints, OfFivePairsTheOutlierIsRejected) {
  for (std::size_t wrong = 0; wrong < 5; ++wrong) {
    auto list = pairs(5);
    list[wrong].x_right += 15;
    expect_floor(ground_from_points(list), 1e-5);
  }
}

TEST(GroundFromPoints, APairNotInOneRowIsRejected) {
  auto list = pairs(8);
  list[2].y_right += 5;
  list[2].x_right += 1;
  expect_floor(ground_from_points(list), 1e-5);
}

TEST(GroundFromPoints, ExactPairsGiveThePlane) {
  for (const int count : {4, 5, 12}) {
    const Ground ground = ground_from_points(pairs(count));
    ASSERT_TRUE(ground.plane);
    EXPECT_NEAR(ground.plane->a, -0.01, 1e-5);
    EXPECT_NEAR(ground.plane->b, 0.12, 1e-5);
    EXPECT_NEAR(ground.plane->c, -8, 2e-3);
    EXPECT_NEAR(ground.residual_px, 0, 1e-3);
    EXPECT_EQ(ground.support, 1.0F);
    EXPECT_EQ(ground.refusal, Refusal::none);
  }
}

TEST(GroundFromPoints, TheResidualMeasuresTheAgreementOfThePairs) {
  auto list = pairs(12);
  for (std::size_t i = 0; i < list.size(); ++i) list[i].x_right += i % 3 == 0 ? 0.6F : -0.3F;
  const Ground ground = ground_from_points(list);
  EXPECT_GT(ground.residual_px, 0.2F);
  EXPECT_LT(ground.residual_px, 0.7F);
}

TEST(GroundFromPoints, RefusesDegeneratePointsWithAReason) {
  EXPECT_NE(complaint(pairs(3)).find("found 3"), std::string::npos);
  EXPECT_NE(complaint({}).find("ground_points"), std::string::npos);

  std::vector<PointPair> line;
  line.reserve(6);
  for (int i = 0; i < 5; ++i) line.push_back(pair_at(10 + 40 * i, 100 + 20 * i));
  EXPECT_NE(complaint(line).find("line"), std::string::npos);
  EXPECT_NE(complaint(std::vector<PointPair>(6, pair_at(50, 200))).find("ground_points"), std::string::npos);

  auto broken = pairs(5);
  broken[2].y_left = std::numeric_limits<float>::infinity();
  EXPECT_NE(complaint(broken).find("pair 3"), std::string::npos);
}

}  // namespace
}  // namespace cairn
