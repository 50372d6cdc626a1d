// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>
#include <cairn/core/error.hpp>
#include <cairn/stereo/disparity_map.hpp>

#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>

#include "support/grids.hpp"

namespace cairn {
namespace {

using grids::grid;
using grids::numbers;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

std::string refusal(const Image<float>& map) {
  try {
    external_disparity(map, {});
  } catch (const Error& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Reasons, HaveALineInTheirPage) {
  std::ifstream page(CAIRN_SOURCE_DIR "/docs/why_is_this_pixel_a_hole.md");
  const std::string all(std::istreambuf_iterator<char>(page), {});
  for (const auto& [name, bit] : kRejects) {
    const std::string line =
        "| " + std::to_string(static_cast<int>(bit)) + " | `" + std::string(name) + "` |";
    EXPECT_NE(all.find(line), std::string::npos) << line;
  }
}

TEST(Combine, APixelKeepsAllItsReasons) {
  const auto one = grid<Reject>({{2, 0, 2, 0}});
  const auto two = grid<Reject>({{4, 0, 0, 8}});
  const auto map = combine(grid<float, float>({{5, 6, 7, kNaN}}), {one, two}, {});
  EXPECT_EQ(numbers(map.reject), (std::vector<std::vector<std::int64_t>>{{6, 0, 2, 9}}));
}

TEST(Combine, APixelIsAHoleExactlyWhenItWasRejected) {
  const auto verdict = grid<Reject>({{2, 0, 0}});
  const auto map = combine(grid<float, float>({{5, 6, kNaN}}), {verdict}, {});
  EXPECT_TRUE(std::isnan(map.disparity_px(0, 0)));
  EXPECT_EQ(map.disparity_px(1, 0), 6.0F);
  EXPECT_TRUE(std::isnan(map.disparity_px(2, 0)));
}

TEST(Combine, WithoutChecksOnlyTheBorderIsAHole) {
  const auto map = combine(grid<float, float>({{kNaN, -3.5F}}), {}, {});
  EXPECT_EQ(numbers(map.reject), (std::vector<std::vector<std::int64_t>>{{1, 0}}));
  EXPECT_EQ(map.disparity_px(1, 0), -3.5F);
}

TEST(ExternalDisparity, NonFiniteValuesAreNoData) {
  const auto given = grid<float, float>({{1.5F, kNaN}, {kInfinity, -kInfinity}});
  const auto map = external_disparity(given, {});
  EXPECT_EQ(numbers(map.reject), (std::vector<std::vector<std::int64_t>>{{0, 128}, {128, 128}}));
  EXPECT_EQ(map.disparity_px(0, 0), 1.5F);
  EXPECT_TRUE(std::isnan(map.disparity_px(0, 1)));
}

TEST(ExternalDisparity, RefusesAnImplausibleMapWithAReason) {
  const auto beyond = grid<float, float>({{1, 2, 2048}});
  EXPECT_NE(refusal(beyond).find("2048"), std::string::npos);
  EXPECT_NE(refusal(beyond).find("(2, 0)"), std::string::npos);
  EXPECT_NE(refusal(grid<float, float>({{-2047.5F}})).find("-2047.5"), std::string::npos);
  EXPECT_NE(refusal(grid<float, float>({{kNaN, kInfinity}})).find("2x1"), std::string::npos);
  EXPECT_NE(refusal(Image<float>{}).find("empty"), std::string::npos);
  const auto bound = grid<float, float>({{2047, -2047}});
  EXPECT_EQ(refusal(bound), "accepted");
}

}  // namespace
}  // namespace cairn
