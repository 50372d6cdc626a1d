// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/grouping/facets.hpp>
#include <cairn/image/gradient.hpp>
#include <cairn/image/noise.hpp>
#include <cmath>

#include "support/grids.hpp"
#include "support/noise.hpp"

namespace cairn {
namespace {

using grids::grid;
using grids::numbers;
using support::picture;

constexpr Size kSize{80, 60};

template <class Brightness>
Facets facets_of(Brightness brightness, double noise = 0) {
  const Image<Gray> image = picture(kSize, noise, 3, brightness);
  return segment_facets(image, {}, noise_sigma(image), {}, {});
}

/// 0 for a step to the left of x = 40, its height from there on.
auto step(double height) {
  return [height](int x, int) { return 100.0 + (x < 40 ? 0 : height); };
}

Image<Rgb> colour(Size size, Rgb left, Rgb right) {
  Image<Rgb> image(size);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) image(x, y) = x < size.width / 2 ? left : right;
  }
  return image;
}

TEST(EdgeStrength, IsHalfTheStepInQuarterLevels) {
  const Image<Gray> image = picture({9, 5}, 0, 0, [](int x, int) { return x < 4 ? 50.0 : 70.0; });
  const Image<std::uint16_t> edges = edge_strength(image, {}, 0, {});
  for (int y = 0; y < 5; ++y) {
    for (int x = 0; x < 9; ++x) EXPECT_EQ(edges(x, y), x == 3 || x == 4 ? 40 : 0) << x;
  }
}

TEST(EdgeStrength, IsNotCapped) {
  const Image<Gray> image = picture({4, 4}, 0, 0, [](int x, int y) { return x + y < 3 ? 0.0 : 255.0; });
  EXPECT_EQ(edge_strength(image, {}, 0, {})(1, 1), std::lround(std::hypot(255, 255) * 2));
}

TEST(EdgeStrength, SeesAnEdgeOfColourThatGreyDoesNot) {
  const Image<Gray> grey = picture({8, 4}, 0, 0, [](int, int) { return 90.0; });
  const Image<Rgb> rgb = colour({8, 4}, {150, 90, 20}, {50, 120, 60});
  EXPECT_EQ(edge_strength(grey, {}, 0, {})(3, 1), 0);
  EXPECT_EQ(edge_strength(grey, rgb, 0, {})(3, 1), 200);  // of the three steps, 100, 30 and 40, the largest
}

TEST(EdgeStrength, OfAGreyColourImageIsThatOfTheGreyOne) {
  const Image<Gray> grey = grids::random_image<Gray>({33, 17}, 0, 255, 4);
  Image<Rgb> rgb(grey.size());
  for (int y = 0; y < 17; ++y) {
    for (int x = 0; x < 33; ++x) rgb(x, y) = {grey(x, y), grey(x, y), grey(x, y)};
  }
  EXPECT_EQ(numbers(edge_strength(grey, rgb, 0.7F, {})), numbers(edge_strength(grey, {}, 0.7F, {})));
}

TEST(Facets, OfAPlainSurfaceIsOne) {
  const Facets facets = facets_of([](int, int) { return 90.0; });
  EXPECT_EQ(facets.count, 1);
  EXPECT_TRUE(facets.borders.empty());
}

TEST(Facets, OfAShadedSurfaceIsOne) {
  EXPECT_EQ(facets_of([](int x, int y) { return 40 + 1.5 * x + 0.7 * y; }).count, 1);
  EXPECT_EQ(facets_of([](int x, int y) { return 220 - 0.008 * (x * x + y * y); }).count, 1);
}

TEST(Facets, OfANoisyShadedSurfaceLieBetweenNoStrongBorders) {
  const Facets facets = facets_of([](int x, int) { return 60 + 1.0 * x; }, 2);
  EXPECT_LE(facets.count, 3);
}

TEST(Facets, TakeTheNoiseOfThePictureIntoAccount) {
  const Image<Gray> image = picture(kSize, 6, 3, [](int x, int) { return 60 + 1.0 * x; });
  FacetsConfig deaf;
  deaf.noise_factor = 0;
  EXPECT_LE(segment_facets(image, {}, noise_sigma(image), {}, {}).count, 10);
  EXPECT_GT(segment_facets(image, {}, noise_sigma(image), deaf, {}).count, 40);
}

TEST(Facets, StopAtAFaintOutline) {
  const Facets facets = facets_of(step(8));
  EXPECT_EQ(facets.count, 2);
  EXPECT_NE(facets.labels(10, 30), facets.labels(70, 30));
  // The same in front of shading that is stronger over the whole width than the step is.
  const Facets shaded = facets_of([](int x, int y) { return 80 + 0.5 * x + step(10)(x, y) - 100; });
  EXPECT_EQ(shaded.count, 2);
  EXPECT_NE(shaded.labels(38, 30), shaded.labels(42, 30));
}

TEST(Facets, IgnoreAStepBelowEdgeMin) {
  EXPECT_EQ(facets_of(step(2)).count, 1);
}

TEST(Facets, StopAtAThinLineAroundAnArea) {
  const auto line = [](int x, int y) {
    const bool on_frame =
        x >= 20 && x <= 60 && y >= 15 && y <= 45 && (x == 20 || x == 60 || y == 15 || y == 45);
    return on_frame ? 70.0 : 100.0;
  };
  const Facets facets = facets_of(line);
  EXPECT_NE(facets.labels(40, 30), facets.labels(5, 5));
}

TEST(Facets, StopAtAnEdgeOfColourAlone) {
  const Image<Gray> grey(kSize, Gray{90}, {});
  const Image<Rgb> rgb = colour(kSize, {150, 80, 20}, {50, 110, 60});
  EXPECT_EQ(segment_facets(grey, {}, noise_sigma(grey), {}, {}).count, 1);
  EXPECT_EQ(segment_facets(grey, rgb, noise_sigma(grey), {}, {}).count, 2);
}

TEST(Facets, AreNumberedByTheirFirstPixelAndTellTheirBorders) {
  const Image<Gray> image =
      picture(kSize, 4, 5, [](int x, int y) { return (x / 16 + y / 12) % 2 * 80 + 60.0; });
  const Facets facets = segment_facets(image, {}, noise_sigma(image), {}, {});
  ASSERT_GT(facets.count, 10);
  int next = 0;
  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 0; x < kSize.width; ++x) {
      ASSERT_LE(number(facets.labels(x, y)), next);
      next += number(facets.labels(x, y)) == next ? 1 : 0;
    }
  }
  EXPECT_EQ(next, facets.count);
  const Image<std::uint16_t> edges = edge_strength(image, {}, FacetsConfig{}.smoothing_sigma, {});
  const std::vector<Border> borders = borders_of(facets.labels, edges);
  ASSERT_EQ(borders.size(), facets.borders.size());
  for (std::size_t i = 0; i < borders.size(); ++i) {
    EXPECT_EQ(borders[i].a, facets.borders[i].a);
    EXPECT_EQ(borders[i].b, facets.borders[i].b);
    EXPECT_EQ(borders[i].length, facets.borders[i].length);
    EXPECT_EQ(borders[i].edge_sum, facets.borders[i].edge_sum);
  }
}

TEST(BordersOf, CountsPairsOfNeighboursWithTheirStrongerEdgeAndTheirMiddle) {
  const auto labels = grid<RegionId>({{0, 0, 1}, {0, 2, 1}});
  const auto edges = grid<std::uint16_t>({{1, 5, 9}, {2, 40, 3}});
  const std::vector<Border> borders = borders_of(labels, edges);
  ASSERT_EQ(borders.size(), 3U);
  EXPECT_EQ(borders[0].a, 0);  // 0 and 1 meet once: (1, 0) and (2, 0)
  EXPECT_EQ(borders[0].b, 1);
  EXPECT_EQ(borders[0].length, 1);
  EXPECT_EQ(borders[0].mean_edge(), 9);
  EXPECT_EQ(borders[0].x(), 1.5);
  EXPECT_EQ(borders[0].y(), 0);
  EXPECT_EQ(borders[1].b, 2);  // 0 and 2 meet at (1, 0)–(1, 1) and (0, 1)–(1, 1)
  EXPECT_EQ(borders[1].length, 2);
  EXPECT_EQ(borders[1].mean_edge(), 40);
  EXPECT_EQ(borders[1].x(), 0.75);
  EXPECT_EQ(borders[1].y(), 0.75);
  EXPECT_EQ(borders[2].a, 1);
  EXPECT_EQ(borders[2].b, 2);
}

TEST(BesideBorder, IsWhatHasAnotherRegionAmongTheEightPixelsAround) {
  const Image<RegionId> labels = grid<RegionId>({{1, 0, 0, 0, 0},  //
                                                 {0, 0, 0, 0, 0},
                                                 {0, 0, 0, 0, 0},
                                                 {0, 0, 0, 2, 2}});
  const Image<int> expected = grid<int>({{1, 1, 0, 0, 0},  //
                                         {1, 1, 0, 0, 0},
                                         {0, 0, 1, 1, 1},
                                         {0, 0, 1, 1, 1}});
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 5; ++x) EXPECT_EQ(beside_border(labels, x, y), expected(x, y) != 0) << x << ' ' << y;
  }
}

TEST(BesideBorder, IsNoPixelOfASingleRegion) {
  for (const Size size : {Size{1, 1}, Size{1, 3}, Size{3, 1}}) {
    const Image<RegionId> labels(size, RegionId{4}, {});
    for (int i = 0; i < size.width * size.height; ++i) {
      EXPECT_FALSE(beside_border(labels, i % size.width, i / size.width));
    }
  }
}

TEST(AsSegmentation, GivesEachFacetItsGreyStatistics) {
  const auto labels = grid<RegionId>({{0, 0, 1}, {0, 1, 1}});
  const auto grey = grid<Gray>({{10, 20, 100}, {30, 100, 160}});
  const Segmentation result = as_segmentation({labels.clone(), 2, {}}, grey, {});
  EXPECT_EQ(numbers(result.labels), numbers(labels));
  ASSERT_EQ(result.regions.size(), 2U);
  EXPECT_EQ(result.regions[0].pixel_count, 3);
  EXPECT_EQ(result.regions[0].valid_count, 3);
  EXPECT_DOUBLE_EQ(result.regions[0].mean, 20);
  EXPECT_NEAR(result.regions[0].variance, 200.0 / 3, 1e-9);
  EXPECT_EQ(result.regions[0].box, (Rect{0, 0, 2, 2}));
  EXPECT_DOUBLE_EQ(result.regions[1].mean, 120);
  EXPECT_EQ(result.regions[1].box, (Rect{1, 0, 2, 2}));
}

Border between(std::int32_t a, std::int32_t b, std::int64_t edge) {
  return {a, b, 1, edge, 0, 0};
}

using Labels = std::vector<std::int32_t>;

TEST(Flooded, LeavesWhatIsDecided) {
  EXPECT_EQ(flooded({0, 1, 0}, {between(0, 1, 1), between(1, 2, 1)}, 7), (Labels{0, 1, 0}));
}

TEST(Flooded, FollowsTheWeakestBorder) {
  EXPECT_EQ(flooded({0, -1, 1}, {between(0, 1, 5), between(1, 2, 9)}, 7), (Labels{0, 0, 1}));
  EXPECT_EQ(flooded({0, -1, 1}, {between(0, 1, 9), between(1, 2, 5)}, 7), (Labels{0, 1, 1}));
}

TEST(Flooded, GoesThroughOtherUndecidedFacets) {
  // 0 ─5─ 1 ─2─ 2 ─3─ 3: facets 1 and 2 belong together first, then to facet 3.
  EXPECT_EQ(flooded({0, -1, -1, 1}, {between(0, 1, 5), between(1, 2, 2), between(2, 3, 3)}, 7),
            (Labels{0, 1, 1, 1}));
}

TEST(Flooded, WeighsTheMeanNotTheSum) {
  Border wide = between(0, 1, 30);
  wide.length = 10;
  EXPECT_EQ(flooded({0, -1, 1}, {wide, between(1, 2, 4)}, 7), (Labels{0, 0, 1}));
}

TEST(Flooded, TellsTheOtherwiseWhereNothingIsDecidedWithinReach) {
  EXPECT_EQ(flooded({-1, -1, 4}, {between(0, 1, 1)}, 7), (Labels{7, 7, 4}));
  EXPECT_EQ(flooded({}, {}, 7), (Labels{}));
}

TEST(Facets, KeepFaintBordersOnlyAmongFaintOnes) {
  const auto one_piece = [](bool strong_edges_elsewhere) {
    Image<Gray> picture(Size{100, 60}, 100, {});
    for (int y = 0; y < 60; ++y) {
      for (int x = 50; x < 100; ++x) picture(x, y) = 110;
      for (int x = 0; x < 100; ++x) {
        if (strong_edges_elsewhere && y > 40 && x / 5 % 2 == 0) picture(x, y) = 250;
      }
    }
    FacetsConfig config;
    config.contrast_share = 14;
    const Facets facets = segment_facets(picture, {}, noise_sigma(picture), config, {});
    return facets.labels(20, 10) == facets.labels(80, 10);
  };
  EXPECT_FALSE(one_piece(false));
  EXPECT_TRUE(one_piece(true));
}

}  // namespace
}  // namespace cairn
