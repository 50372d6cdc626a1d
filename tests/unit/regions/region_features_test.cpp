// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <algorithm>
#include <cairn/core/target.hpp>
#include <cairn/regions/fitted_trees.hpp>
#include <cairn/regions/merge_tree.hpp>
#include <cmath>
#include <random>
#include <set>
#include <span>
#include <string>

#include "support/region_scene.hpp"

namespace cairn {
namespace {

using grids::grid;
using support::RegionScene;

// ---- planes ----

PlaneMoments of_pixel(std::int64_t x, std::int64_t y, std::int64_t d) {
  return {1, x, y, x * x, x * y, y * y, d, x * d, y * d, d * d};
}

/// d = 20 + a·x + b·y in a rectangle, from the image's centre.
PlaneMoments moments(Rect rect, double a, double b) {
  PlaneMoments m;
  for (int y = rect.y; y < rect.y + rect.height; ++y) {
    for (int x = rect.x; x < rect.x + rect.width; ++x)
      m.add(of_pixel(x, y, std::lround((20 + a * x + b * y) * kDisparitySteps)));
  }
  return m;
}

TEST(FitPlane, FindsTheSlopeOfALargeRegion) {
  const FittedPlane plane = fit_plane(moments({-60, -40, 100, 90}, 0.125, -0.0625), 160);
  ASSERT_TRUE(plane.any);
  EXPECT_NEAR(plane.a, 0.125, 0.003);
  EXPECT_NEAR(plane.b, -0.0625, 0.002);
  EXPECT_NEAR(plane.x, -10.5, 1e-9);
  EXPECT_NEAR(plane.y, 4.5, 1e-9);
  EXPECT_NEAR(plane.d, 20 - 0.125 * 10.5 - 0.0625 * 4.5, 0.01);
  EXPECT_NEAR(plane.at(30, 20), 20 + 0.125 * 30 - 0.0625 * 20, 0.15);
  const auto pixels = 100 * 90;
  EXPECT_LT(std::sqrt(plane.squares / pixels), 0.5) << "its slopes cost something";
}

TEST(FitPlane, MeasuresTheResidual) {
  PlaneMoments m;
  for (int i = 0; i < 400; ++i)
    m.add(of_pixel(i % 20 - 10, i / 20 - 10, (i % 2 == i / 20 % 2 ? 7 : 9) * kDisparitySteps));
  const FittedPlane plane = fit_plane(m, 100);
  EXPECT_NEAR(plane.d, 8, 1e-9);
  EXPECT_NEAR(std::sqrt(plane.squares / 400), 1, 1e-3);
}

TEST(FitPlane, IsLevelForASmallRegion) {
  const FittedPlane plane = fit_plane(moments({10, 10, 3, 3}, 0.5, 0), 640);
  EXPECT_LT(std::abs(plane.a), 0.01);
  EXPECT_EQ(plane.b, 0);
  EXPECT_NEAR(plane.d, 25.5, 0.01);
}

TEST(FitPlane, IsNoneWithoutPixels) {
  const FittedPlane plane = fit_plane({}, 640);
  EXPECT_FALSE(plane.any);
  EXPECT_EQ(plane.at(3, 4), 0);
}

// ---- features ----

std::size_t where(const std::vector<std::string_view>& names, std::string_view name) {
  const auto found = std::find(names.begin(), names.end(), name);
  EXPECT_NE(found, names.end()) << name;
  return static_cast<std::size_t>(found - names.begin());
}

/// Of the first contact, and of a superpixel, by their names.
struct Features {
  MergeFeatures of_contact{};
  std::vector<ObjectFeatures> of_regions;

  explicit Features(const RegionScene& scene) {
    bool first = true;
    const MergeTree tree = grow_merge_tree(scene.superpixels, scene.cues(), {}, {},
                                           [&](std::int32_t, std::int32_t, const MergeFeatures& by) {
                                             if (first) of_contact = by;
                                             first = false;
                                           });
    for (const MergeNode& node : tree.nodes) of_regions.push_back(node.features);
  }
  [[nodiscard]] float contact(std::string_view name) const {
    return of_contact.at(where(merge_feature_names(), name));
  }
  [[nodiscard]] float region(std::size_t i, std::string_view name) const {
    return of_regions.at(i).at(where(object_feature_names(), name));
  }
};

RegionScene box_on_a_wall() {
  Image<RegionId> labels(Size{24, 16}, RegionId{0}, {});
  for (int y = 4; y < 14; ++y) std::fill_n(labels.row(y) + 6, 8, RegionId{1});
  RegionScene scene(std::move(labels));
  scene.paint({60, 110});
  scene.place(
      [](int x, int, std::size_t region) { return region == 0 ? 5 + 0.05F * static_cast<float>(x) : 12; });
  return scene;
}

TEST(FeatureNames, AreUnique) {
  const auto merge = merge_feature_names();
  const auto object = object_feature_names();
  EXPECT_EQ(merge.size(), kMergeFeatures);
  EXPECT_EQ(object.size(), kObjectFeatures);
  EXPECT_EQ(std::set(merge.begin(), merge.end()).size(), merge.size());
  EXPECT_EQ(std::set(object.begin(), object.end()).size(), object.size());
}

TEST(MergeFeatures, DescribeABoxAndItsWall) {
  RegionScene scene = box_on_a_wall();
  scene.for_each_pixel([&](int x, int y, std::size_t) {
    const bool at_outline =
        (x == 5 || x == 6 || x == 13 || x == 14) || (y == 3 || y == 4 || y == 13 || y == 14);
    scene.superpixels.edges(x, y) = at_outline ? 100 : 0;
  });
  const Features features(scene);
  EXPECT_FLOAT_EQ(features.contact("border length over the root of the smaller one's area"),
                  36 / std::sqrt(80.0F));
  EXPECT_EQ(features.contact("border length, share of the smaller one's outline"), 1);
  EXPECT_EQ(features.contact("mean edge, grey levels"), 25);
  EXPECT_EQ(features.contact("share of the border without an edge"), 0);
  EXPECT_EQ(features.contact("difference of brightness, grey levels"), 50);
  EXPECT_FLOAT_EQ(features.contact("distance of the colours' histograms"), 2);
  EXPECT_NEAR(features.contact("step right at the border, px"), 6.5, 0.1);
  EXPECT_NEAR(features.contact("step 3 px away from it, with its sign, px"), 6.5, 0.1)
      << "the smaller is nearer";
  EXPECT_NEAR(features.contact("step of the planes at the border, px"), 6.5, 0.1);
  EXPECT_NEAR(features.contact("evidence: step of the planes at the border, px"), 6.5, 0.1);
  EXPECT_EQ(features.contact("share of level disparities there"), 0);
  EXPECT_EQ(features.contact("disparities, share of the smaller one"), 1);
  EXPECT_EQ(features.contact("fill of the union's box"), 1);
}

TEST(MergeFeatures, AreSymmetric) {
  RegionScene scene = box_on_a_wall();
  const Features features(scene);
  scene.for_each_pixel([&](int x, int y, std::size_t region) {
    scene.superpixels.labels(x, y) = RegionId{region == 0 ? 1 : 0};
  });
  const Features turned(scene);
  EXPECT_EQ(turned.of_contact, features.of_contact);
}

TEST(ObjectFeatures, DescribeARegion) {
  RegionScene scene = box_on_a_wall();
  scene.ground.plane = GroundPlane{0, 0.5F, 2};
  scene.background.planes = {{0.05F, 0, 5}};
  const Features features(scene);
  EXPECT_FLOAT_EQ(features.region(1, "area, share of the image"), 80.0F / (24 * 16));
  EXPECT_EQ(features.region(1, "fill of its box"), 1);
  EXPECT_EQ(features.region(1, "number of borders of the image that it touches"), 0);
  EXPECT_EQ(features.region(0, "number of borders of the image that it touches"), 4);
  EXPECT_EQ(features.region(1, "neighbours"), 1);
  EXPECT_NEAR(features.region(1, "step down around it, 3 px away, px"), 6.5, 0.1);
  EXPECT_EQ(features.region(1, "share of disparities there where it is nearer"), 1);
  EXPECT_EQ(features.region(0, "share of disparities there where it is farther"), 1);
  EXPECT_NEAR(features.region(1, "height above the ground, px"), 12 - 0.5 * 8.5 - 2, 0.01);
  EXPECT_NEAR(features.region(1, "in front of the background, px"), 12 - 5 - 0.05 * 9.5, 0.02);
  EXPECT_EQ(features.region(0, "share in the background"), 1);
  EXPECT_EQ(features.region(1, "ground known"), 1);
  EXPECT_EQ(features.region(1, "disparity, share of the nearest"), 1);
  EXPECT_EQ(features.region(1, "same-object score of its parts"), 20) << "a superpixel";
  EXPECT_EQ(features.region(0, "distance of its colours from the background's"), 0) << "it is all of that";
  EXPECT_FLOAT_EQ(features.region(1, "distance of its colours from the background's"), 2);
  EXPECT_EQ(features.contact("distance of the smaller one's colours from the background's"), 2);
  EXPECT_EQ(features.contact("distance of the larger one's colours from the background's"), 0);
  EXPECT_EQ(features.region(1, "distance of its colours from the floor's"), kUnknown)
      << "nothing lies on the floor";
}

TEST(Features, AreUnknownWithoutData) {
  RegionScene scene(grid<RegionId>({{0, 0, 1, 1}, {0, 0, 1, 1}}));
  const Features features(scene);
  for (const char* name :
       {"difference of colour, grey levels", "step right at the border, px", "step 3 px away from it, px",
        "step 3 px away from it, with its sign, px", "share of level disparities there",
        "step of the planes at the border, px", "evidence: step of the means, relative",
        "height of the smaller one above the ground, px", "share of the larger one on the ground",
        "smaller one in front of the background, px", "disparity of the smaller one, share of the nearest"})
    EXPECT_EQ(features.contact(name), kUnknown) << name;
  for (const char* name :
       {"spread of colour, grey levels", "step down around it, 3 px away, px", "step at its foot, px",
        "distance from its plane, px", "evidence: slope down, relative", "height above the ground, px",
        "height above the ground, relative", "share on the ground", "share in the background",
        "least step of the planes around, px", "evidence: height above the ground over its error",
        "neighbours on the ground, share", "distance of its colours from the floor's",
        "distance of its colours from the background's"})
    EXPECT_EQ(features.region(0, name), kUnknown) << name;
  EXPECT_EQ(features.contact("disparities, share of the smaller one"), 0);
  EXPECT_EQ(features.region(0, "ground known"), 0);
}

TEST(Features, OfTheWholeImageAreUnknownWithoutSurroundings) {
  const Features features(RegionScene(Image<RegionId>(Size{3, 2}, RegionId{0}, {})));
  for (const char* name : {"mean edge around it, grey levels", "same-object score, highest of the neighbours",
                           "same-object score, mean over the outline", "its share of its parent",
                           "same-object score, rest of its parent"})
    EXPECT_EQ(features.region(0, name), kUnknown) << name;
  for (const float value : features.of_regions[0]) EXPECT_TRUE(std::isfinite(value));
  EXPECT_EQ(features.region(0, "area, share of the image"), 1);
  EXPECT_EQ(features.region(0, "neighbours"), 0);
}

TEST(TellEnd, FillsInTheLastTwo) {
  ObjectFeatures features{};
  report_end(features, 0.25F, -1.5F);
  const auto names = object_feature_names();
  EXPECT_EQ(features.at(where(names, "its share of its parent")), 0.25F);
  EXPECT_EQ(features.at(where(names, "same-object score, rest of its parent")), -1.5F);
  EXPECT_EQ(std::count(features.begin(), features.end(), 0.0F), std::ptrdiff_t{kObjectFeatures} - 2);
}

/// The scene at double resolution, with doubled disparities.
RegionScene doubled(const RegionScene& scene) {
  const Size size{2 * scene.gray.width(), 2 * scene.gray.height()};
  const auto twice = [&](const auto& image) {
    std::remove_cvref_t<decltype(image)> result(size);
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) result(x, y) = image(x / 2, y / 2);
    }
    return result;
  };
  RegionScene result(twice(scene.superpixels.labels));
  result.superpixels.edges = twice(scene.superpixels.edges);
  result.gray = twice(scene.gray);
  result.disparity_px = twice(scene.disparity_px);
  result.textured_px = twice(scene.textured_px);
  for (Image<float>* image : {&result.disparity_px, &result.textured_px}) {
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) (*image)(x, y) *= 2;
    }
  }
  return result;
}

/// Features in px scale with the disparities; the others are unchanged, up to pixel quantisation.
template <class Values>
void expect_same_but_px(const Values& large, const Values& small,
                        const std::vector<std::string_view>& names) {
  for (std::size_t i = 0; i < names.size(); ++i) {
    const float factor = names[i].ends_with(", px") && small[i] != kUnknown ? 2.0F : 1.0F;
    EXPECT_NEAR(large[i], factor * small[i], 0.03F + 0.04F * std::abs(factor * small[i])) << names[i];
  }
}

TEST(Features, AreInvariantToDoublingTheResolution) {
  RegionScene scene = box_on_a_wall();
  scene.for_each_pixel([&](int x, int y, std::size_t) {
    scene.superpixels.edges(x, y) = static_cast<std::uint16_t>(10 * ((3 * x + 5 * y) % 7));
  });
  const Features small(scene);
  const Features large(doubled(scene));
  expect_same_but_px(large.of_contact, small.of_contact, merge_feature_names());
  for (const std::size_t region : {0U, 1U, 2U})
    expect_same_but_px(large.of_regions[region], small.of_regions[region], object_feature_names());
}

// ---- trees ----

TEST(FittedTrees, BranchByTheThreshold) {
  const std::vector<FittedTrees::Node> nodes{{1, 1, 2.5F}, {-1, 0, 10}, {0, 3, -1}, {-1, 0, 20}, {-1, 0, 30}};
  const std::vector<std::int16_t> roots{0};
  const FittedTrees trees{0.5F, roots, nodes};
  const auto score = [&](float first, float second) { return trees(std::array{first, second}); };
  EXPECT_EQ(score(0, std::nextafter(2.5F, 0.0F)), 10.5F);
  EXPECT_EQ(score(0, 2.5F), 30.5F);
  EXPECT_EQ(score(-1, 3), 30.5F);
  EXPECT_EQ(score(-1.5F, 3), 20.5F);
  EXPECT_EQ(score(kUnknown, 3), 20.5F);
}

TEST(FittedTrees, AddUp) {
  const std::vector<FittedTrees::Node> nodes{{0, 1, 0}, {-1, 0, 1},  {-1, 0, 2},
                                             {0, 4, 5}, {-1, 0, 10}, {-1, 0, 20}};
  const std::vector<std::int16_t> roots{0, 3, 0};
  const FittedTrees trees{-1, roots, nodes};
  EXPECT_EQ(trees(std::array{-1.0F}), -1 + 1 + 10 + 1);
  EXPECT_EQ(trees(std::array{1.0F}), -1 + 2 + 10 + 2);
  EXPECT_EQ(trees(std::array{6.0F}), -1 + 2 + 20 + 2);
  EXPECT_EQ(FittedTrees{}(std::array{1.0F}), 0);
}

/// By definition: from the root down, one tree after the other.
float one_by_one(float base, const std::vector<std::int16_t>& roots,
                 const std::vector<FittedTrees::Node>& nodes, std::span<const float> features) {
  float sum = base;
  for (const std::int16_t root : roots) {
    std::size_t at = slot(root);
    while (nodes[at].feature >= 0) {
      const FittedTrees::Node& node = nodes[at];
      at = slot(node.below) + (features[slot(node.feature)] < node.value ? 0 : 1);
    }
    sum += nodes[at].value;
  }
  return sum;
}

TEST(FittedTrees, MayBeDeepAndOneSided) {
  for (const int depth : {1, 5, 6, 7, 9}) {
    // From each split, one side ends: the first ones at leaf 0, 1, 2 …
    std::vector<FittedTrees::Node> nodes;
    for (int i = 0; i < depth; ++i) {
      nodes.push_back({0, static_cast<std::int16_t>(2 * i + 1), static_cast<float>(i)});
      nodes.push_back({-1, 0, static_cast<float>(i)});
    }
    nodes.push_back({-1, 0, static_cast<float>(depth)});
    const std::vector<std::int16_t> roots{0};
    const FittedTrees trees{0, roots, nodes};
    std::vector<std::array<float, 1>> samples;
    std::vector<float> expected;
    for (int i = 0; i <= 40; ++i) {
      samples.push_back({i == 40 ? kUnknown : 0.25F * static_cast<float>(i) - 0.5F});
      expected.push_back(one_by_one(0, roots, nodes, samples.back()));
      EXPECT_EQ(trees(samples.back()), expected.back()) << depth;
    }
    EXPECT_EQ(std::set<float>(expected.begin(), expected.end()).size(), slot(depth) + 1);
    const std::vector<std::span<const float>> all(samples.begin(), samples.end());
    for (const Target target : supported_targets())
      EXPECT_EQ(trees(all, Exec::with_threads(1, target)), expected) << depth << ' ' << name(target);
  }
}

TEST(FittedTrees, EqualTheSumOfSingleTrees) {
  std::mt19937 random(7);
  const auto value = [&] { return static_cast<float>(static_cast<int>(random() % 2000) - 1000) / 300; };
  std::set<float> sums;
  for (const int count : {1, 2, 7, 8, 9, 16, 21}) {
    std::vector<FittedTrees::Node> nodes;
    std::vector<std::int16_t> roots;
    for (int tree = 0; tree < count; ++tree) {
      const std::size_t root = nodes.size();
      roots.push_back(static_cast<std::int16_t>(root));
      nodes.push_back({-1, 0, value()});
      const std::size_t most = root + 1 + 2 * (random() % 15);
      for (std::size_t i = root; nodes.size() < most; ++i) {  // the leaf becomes an inner node
        nodes[i] = {static_cast<std::int16_t>(random() % 3), static_cast<std::int16_t>(nodes.size()),
                    value()};
        nodes.push_back({-1, 0, value()});
        nodes.push_back({-1, 0, value()});
      }
    }
    const FittedTrees trees{0.25F, roots, nodes};
    std::vector<std::array<float, 3>> samples(50);
    std::vector<float> expected;
    for (std::array<float, 3>& features : samples) {
      features = {value(), value(), value()};
      expected.push_back(one_by_one(0.25F, roots, nodes, features));
      EXPECT_EQ(trees(features), expected.back()) << count;
    }
    sums.insert(expected.begin(), expected.end());
    const std::vector<std::span<const float>> all(samples.begin(), samples.end());
    for (const Target target : supported_targets())
      EXPECT_EQ(trees(all, Exec::with_threads(1, target)), expected) << count << ' ' << name(target);
  }
  EXPECT_GT(sums.size(), 100U);
}

}  // namespace
}  // namespace cairn
