// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/regions/object_hints.hpp>
#include <cairn/regions/superpixels.hpp>
#include <limits>
#include <set>

#include "support/grids.hpp"

namespace cairn {
namespace {

using grids::numbers;
using grids::random_image;
using Rows = std::vector<std::vector<std::int64_t>>;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

/// An image of stripes, four columns each.
Image<Gray> stripes(const std::vector<int>& shades, int height = 3) {
  Image<Gray> gray({4 * static_cast<int>(shades.size()), height});
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < gray.width(); ++x) gray(x, y) = static_cast<Gray>(shades[slot(x / 4)]);
  }
  return gray;
}

Superpixels cut(const Image<Gray>& gray, int count, float disparity_px = kNaN) {
  const Image<float> disparity(gray.size(), disparity_px, {});
  return cut_superpixels(LeftImage{gray}, disparity, {count}, {});
}

std::vector<std::int64_t> first_row(const Superpixels& superpixels) {
  return numbers(superpixels.labels).front();
}

TEST(Superpixels, APlainImageIsOneSuperpixel) {
  const Superpixels superpixels = cut(Image<Gray>(Size{9, 7}, Gray{80}, {}), 500);
  EXPECT_EQ(superpixels.count, 1);
  EXPECT_EQ(numbers(superpixels.labels), Rows(7, std::vector<std::int64_t>(9, 0)));
}

TEST(Superpixels, AnEdgeOfBrightnessCuts) {
  const Superpixels superpixels = cut(stripes({50, 200}), 500);
  EXPECT_EQ(superpixels.count, 2);
  EXPECT_EQ(numbers(superpixels.labels), Rows(3, {0, 0, 0, 0, 1, 1, 1, 1}));
}

TEST(Superpixels, AnEdgeOfColourCutsWhereBrightnessIsTheSame) {
  const Image<Gray> gray(Size{8, 3}, Gray{100}, {});
  Image<Rgb> rgb(Size{8, 3}, Rgb{100, 100, 100}, {});
  for (int y = 0; y < 3; ++y) std::fill_n(rgb.row(y) + 4, 4, Rgb{160, 100, 40});
  const Image<float> holes(gray.size(), kNaN, {});
  EXPECT_EQ(first_row(cut_superpixels(LeftImage{gray, rgb}, holes, {}, {})),
            (std::vector<std::int64_t>{0, 0, 0, 0, 1, 1, 1, 1}));
}

TEST(Superpixels, ADisparityStepCutsAPlainImageAndHolesDoNot) {
  const Image<Gray> gray(Size{8, 3}, Gray{100}, {});
  Image<float> disparity(gray.size(), 5.0F, {});
  for (int y = 0; y < 3; ++y) std::fill_n(disparity.row(y) + 4, 4, 9.0F);
  const Superpixels superpixels = cut_superpixels(LeftImage{gray}, disparity, {}, {});
  EXPECT_EQ(first_row(superpixels), (std::vector<std::int64_t>{0, 0, 0, 0, 1, 1, 1, 1}));
  EXPECT_EQ(superpixels.edges(4, 1), 0) << "edges are of the picture alone";
  for (int y = 0; y < 3; ++y) std::fill_n(disparity.row(y) + 4, 4, kNaN);
  EXPECT_EQ(cut_superpixels(LeftImage{gray}, disparity, {}, {}).count, 1);
}

TEST(Superpixels, AnExpectedOutlineCutsAPlainImageAndAnUnlikelyOneDoesNot) {
  const Image<Gray> gray(Size{16, 6}, Gray{100}, {});
  const Image<float> holes(gray.size(), kNaN, {});
  Image<ObjectHint> hints({8, 3}, ObjectHint{.outline = -96}, {});
  const auto cut_by_hints = [&] {
    return cut_superpixels(superpixel_edges(LeftImage{gray}, {}), hints, holes, 0, {}, {});
  };
  EXPECT_EQ(cut_by_hints().count, 1);
  for (int y = 0; y < 3; ++y) hints(4, y).outline = 96;
  const Superpixels superpixels = cut_by_hints();
  EXPECT_EQ(superpixels.count, 2);
  EXPECT_NE(superpixels.labels(4, 2), superpixels.labels(13, 2));
  EXPECT_EQ(superpixels.edges(8, 2), 0) << "edges are of the picture alone";
  for (int y = 0; y < 3; ++y) hints(4, y).outline = -32;
  EXPECT_EQ(cut_by_hints().count, 1);
}

TEST(Superpixels, AreFewerThanCountInASmallImage) {
  EXPECT_EQ(cut(stripes({50, 200, 90}), 500).count, 3);
  EXPECT_EQ(cut(stripes({50}, 1), 500).count, 1);
  EXPECT_EQ(cut(Image<Gray>(Size{1, 1}, Gray{0}, {}), 1).count, 1);
}

TEST(Superpixels, TheMostSimilarFuseFirst) {
  const Image<Gray> gray = stripes({50, 60, 200, 120});
  EXPECT_EQ(first_row(cut(gray, 4)),
            (std::vector<std::int64_t>{0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3}));
  EXPECT_EQ(first_row(cut(gray, 3)),
            (std::vector<std::int64_t>{0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2}));
  EXPECT_EQ(first_row(cut(gray, 2)),
            (std::vector<std::int64_t>{0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1}));
  EXPECT_EQ(cut(gray, 1).count, 1);
}

TEST(Superpixels, OfEqualBordersTheFirstFuses) {
  // All equally similar and of equal size: the border that comes first in raster order.
  EXPECT_EQ(first_row(cut(stripes({50, 90, 50, 90}), 3)),
            (std::vector<std::int64_t>{0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2}));
}

/// Fails where a label's pixels are not 4-connected, or a label has none.
void expect_connected(const Superpixels& superpixels) {
  const Image<RegionId>& labels = superpixels.labels;
  std::vector<std::set<std::pair<int, int>>> pixels(slot(superpixels.count));
  for (int y = 0; y < labels.height(); ++y)
    for (int x = 0; x < labels.width(); ++x) pixels.at(index(labels(x, y))).insert({x, y});
  for (std::set<std::pair<int, int>>& left : pixels) {
    ASSERT_FALSE(left.empty());
    std::vector<std::pair<int, int>> at{*left.begin()};
    left.erase(left.begin());
    while (!at.empty()) {
      const auto [x, y] = at.back();
      at.pop_back();
      for (const auto& to : {std::pair{x + 1, y}, {x - 1, y}, {x, y + 1}, {x, y - 1}}) {
        if (left.erase(to) > 0) at.push_back(to);
      }
    }
    EXPECT_TRUE(left.empty());
  }
}

TEST(Superpixels, AreMoreInLargerImages) {
  EXPECT_EQ(most_superpixels({320, 240}, {150}), 150);
  EXPECT_EQ(most_superpixels({400, 300}, {150}), 234);
  EXPECT_EQ(most_superpixels({640, 480}, {150}), 337);
  EXPECT_EQ(most_superpixels({3840, 2160}, {100000}), 225000);
  EXPECT_EQ(most_superpixels({1, 1}, {1}), 1);
  const Superpixels many = cut(random_image<Gray>({640, 480}, 0, 255, 3), 10);
  EXPECT_EQ(many.count, 22);
  expect_connected(many);
}

TEST(Superpixels, AreConnectedAndNumberedInRasterOrder) {
  const Image<Gray> gray = random_image<Gray>({40, 30}, 0, 255, 3);
  const Superpixels superpixels = cut(gray, 25, 7.0F);
  ASSERT_EQ(superpixels.count, 25);
  std::int32_t next = 0;
  for (int y = 0; y < 30; ++y) {
    for (int x = 0; x < 40; ++x) {
      const std::int32_t label = number(superpixels.labels(x, y));
      ASSERT_LE(label, next);
      next = std::max(next, label + 1);
    }
  }
  EXPECT_EQ(next, 25);
  expect_connected(superpixels);
}

TEST(Superpixels, StayConnectedWhereOutlinesAreRefined) {
  for (std::uint32_t seed = 1; seed <= 10; ++seed) {
    const Superpixels superpixels = cut(random_image<Gray>({190, 170}, 0, 255, seed), 7, 7.0F);
    EXPECT_EQ(superpixels.count, 7);
    expect_connected(superpixels);
  }
}

TEST(Superpixels, OfALargeImageFollowAnEdgeToThePixel) {
  Image<Gray> gray(Size{101, 77}, Gray{40}, {});
  const auto is_bright = [](int x, int y) { return 3 * (x - 50) > y - 30; };
  for (int y = 0; y < gray.height(); ++y)
    for (int x = 0; x < gray.width(); ++x)
      if (is_bright(x, y)) gray(x, y) = 220;
  const Superpixels superpixels = cut(gray, 2, 7.0F);  // 3,888 pixels each: cut at a quarter of the size
  ASSERT_EQ(superpixels.count, 2);
  int wrong = 0;
  for (int y = 0; y < gray.height(); ++y)
    for (int x = 0; x < gray.width(); ++x)
      wrong += (number(superpixels.labels(x, y)) == 1) != is_bright(x, y) ? 1 : 0;
  EXPECT_LE(wrong, gray.height());  // half a pixel on average: the crest is two pixels wide
}

TEST(Superpixels, AsASegmentationHaveMeanGreyLevels) {
  const Image<Gray> gray = stripes({50, 200});
  const Segmentation segmentation = superpixel_regions(cut(gray, 500), gray, {});
  ASSERT_EQ(segmentation.regions.size(), 2U);
  EXPECT_EQ(segmentation.regions[0].mean, 50);
  EXPECT_EQ(segmentation.regions[1].mean, 200);
  EXPECT_EQ(segmentation.regions[1].variance, 0);
  EXPECT_EQ(segmentation.regions[1].pixel_count, 12);
  EXPECT_EQ(segmentation.regions[1].box, (Rect{4, 0, 4, 3}));
}

}  // namespace
}  // namespace cairn
