// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <array>
#include <cairn/regions/runs.hpp>
#include <vector>

namespace cairn {
namespace {

TEST(Runs, EndWithTheLabelAndWithTheRow) {
  Image<RegionId> labels(Size{4, 2}, RegionId{1}, {});
  labels(0, 0) = RegionId{0};
  std::vector<Rect> boxes;
  std::vector<int> numbers;
  for_each_run(labels, {}, [&](const cairn::Run& run) {
    boxes.push_back(run.box());
    numbers.push_back(number(run.label));
  });
  EXPECT_EQ(boxes, (std::vector<Rect>{{0, 0, 1, 1}, {1, 0, 3, 1}, {0, 1, 4, 1}}));
  EXPECT_EQ(numbers, (std::vector<int>{0, 1, 1}));
}

TEST(Runs, HaveTheExtentOfTheirUnion) {
  Extent extent;
  EXPECT_EQ(extent.box(), Rect{});
  extent.add({RegionId{3}, 2, 5, 9});
  EXPECT_EQ(extent.box(), (Rect{5, 2, 4, 1}));
  extent.add({RegionId{3}, 2, 20, 21});
  extent.add({RegionId{3}, 4, 3, 4});
  EXPECT_EQ(extent.box(), (Rect{3, 2, 18, 3}));
}

TEST(Runs, SumTheirOwnPixelsColours) {
  Image<Gray> gray(Size{4, 2}, 200, {});
  Image<Rgb> rgb(gray.size(), {100, 150, 250}, {});
  gray(2, 1) = 100;
  rgb(2, 1) = {1, 2, 3};
  const cairn::Run run{RegionId{0}, 1, 1, 3};
  EXPECT_EQ(ColourSums(gray, rgb).of(run), (std::array{101, 152, 253}));
  EXPECT_EQ(ColourSums(gray, {}).of(run), (std::array{300, 300, 300}));
}

}  // namespace
}  // namespace cairn
