// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/regions/object_hints.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cairn/core/error.hpp>
#include <cairn/regions/merge_tree.hpp>
#include <cmath>
#include <limits>
#include <vector>

#include "support/region_scene.hpp"

namespace cairn {
namespace {

using grids::random_image;
using support::RegionScene;

TEST(HintCells, HaveTheImagesProportionsWhateverItsSize) {
  EXPECT_EQ(hint_cells({320, 240}), (Size{160, 120}));
  EXPECT_EQ(hint_cells({160, 120}), (Size{160, 120}));
  EXPECT_EQ(hint_cells({424, 240}), (Size{216, 120}));
  EXPECT_EQ(hint_cells({640, 480}), (Size{240, 184}));
  EXPECT_EQ(hint_cells({1280, 960}), (Size{240, 184}));
  EXPECT_EQ(hint_cells({1242, 375}), (Size{376, 112}));
  EXPECT_EQ(hint_cells({1, 1}), (Size{136, 136}));
  EXPECT_EQ(hint_cells({30000, 1}), (Size{1024, 8}));
  EXPECT_EQ(hint_cells({1, 30000}), (Size{8, 1024}));
}

TEST(HintNetwork, RefusesMoreOutputsThanTheKernelsCompute) {
  const std::vector<HintLayer> layers(kHintLayers, {8, 120});
  const std::vector<std::int8_t> weights(kHintLayers * layers.front().weights());
  const std::vector<std::int32_t> bias(kHintLayers * 120);
  const std::vector<float> scale(bias.size(), 1.0F);
  EXPECT_THROW(HintNetwork(layers, weights, bias, scale), Error);
}

/// A plane at 10 px left, and a nearer one at 20 px right, without a floor or walls.
RegionScene two_depths() {
  RegionScene scene(Image<RegionId>({320, 240}, RegionId{0}, {}));
  scene.gray = random_image<Gray>({320, 240}, 90, 110, 1);
  scene.place([](int x, int, std::size_t) { return x < 160 ? 10.0F : 20.0F; });
  return scene;
}

int channel(const Image<std::int16_t>& input, int x, int y, int which) {
  return input((x + 1) * kHintChannels + which, y + 1);
}

TEST(HintInput, MeasuresEachCell) {
  RegionScene scene = two_depths();
  scene.ground.plane = GroundPlane{0, 0, 8};
  scene.rgb = Image<Rgb>({320, 240}, Rgb{100, 100, 132}, {});
  const Image<std::int16_t> input = hint_input(scene.superpixels.edges, scene.cues(), {});
  ASSERT_EQ(input.size(), (Size{162 * kHintChannels, 122}));
  EXPECT_EQ(channel(input, 10, 60, 0), 0) << "plain";
  EXPECT_EQ(channel(input, 10, 60, 1), 64) << "32 levels of blue − green";
  EXPECT_EQ(channel(input, 10, 60, 2), 0);
  EXPECT_EQ(channel(input, 10, 60, 3), 32) << "half as near as what is nearest";
  EXPECT_EQ(channel(input, 150, 60, 3), 64);
  EXPECT_EQ(channel(input, 10, 60, 4), 64) << "matched everywhere";
  EXPECT_EQ(channel(input, 10, 60, 5), 32) << "2 px above the ground, in 4 px";
  EXPECT_EQ(channel(input, 150, 60, 5), 192);
  EXPECT_EQ(channel(input, 10, 60, 6), 0) << "no background";
  EXPECT_EQ(channel(input, 10, 60, 7), 26) << "8 of 20 px";
  EXPECT_EQ(channel(input, 10, 60, 8), 0) << "no edges";
  EXPECT_EQ(channel(input, 10, 0, 10), -64);
  EXPECT_EQ(channel(input, 10, 60, 10), 0);
  EXPECT_EQ(channel(input, 10, 60, 11), 64);
  for (const int c : {12, 13, 14, 15}) EXPECT_EQ(channel(input, 10, 60, c), 0) << "like its surroundings";
  for (int c = 0; c < kHintChannels; ++c) {
    EXPECT_EQ(channel(input, -1, 60, c), 0);
    EXPECT_EQ(channel(input, 160, 60, c), 0);
    EXPECT_EQ(channel(input, 80, -1, c), 0);
    EXPECT_EQ(channel(input, 80, 120, c), 0);
  }
}

TEST(HintInput, ComparesEachCellWithItsSurroundings) {
  RegionScene scene = two_depths();
  scene.gray = Image<Gray>({320, 240}, Gray{20}, {});
  // A faint thing in the dark, and a bright window far from it.
  for (int y = 100; y < 140; ++y) {
    for (int x = 40; x < 56; ++x) scene.gray(x, y) = Gray{24};
    for (int x = 250; x < 290; ++x) scene.gray(x, y) = Gray{255};
  }
  const Image<std::int16_t> input = hint_input(scene.superpixels.edges, scene.cues(), {});
  EXPECT_EQ(channel(input, 24, 60, 0), -1) << "hardly brighter, seen from the whole image";
  EXPECT_EQ(channel(input, 34, 60, 0), -8);
  EXPECT_EQ(channel(input, 24, 60, 12), 28);
  EXPECT_EQ(channel(input, 34, 60, 12), -7);
  EXPECT_EQ(channel(input, 71, 60, 15), 0) << "nothing else is around";
  EXPECT_LT(channel(input, 72, 60, 15), 0) << "something nearer is, 8 cells away";
  EXPECT_EQ(channel(input, 79, 60, 15), -120);
  EXPECT_EQ(channel(input, 80, 60, 15), 120);
}

TEST(HintInput, OfGreyImagesHasNoColour) {
  const RegionScene scene = two_depths();
  const Image<std::int16_t> input = hint_input(scene.superpixels.edges, scene.cues(), {});
  for (const int c : {1, 2, 11, 13, 14}) EXPECT_EQ(channel(input, 80, 60, c), 0);
}

TEST(HintInput, IsTheSameOnAnyNumberOfThreads) {
  const RegionScene scene = two_depths();
  const Image<std::int16_t> one = hint_input(scene.superpixels.edges, scene.cues(), {});
  for (const int threads : {2, 3, 8}) {
    const Image<std::int16_t> more =
        hint_input(scene.superpixels.edges, scene.cues(), Exec::with_threads(threads));
    EXPECT_EQ(grids::numbers(more), grids::numbers(one));
  }
}

TEST(HintObjects, AcceptAnImageOfAnySize) {
  for (const Size size : {Size{1, 1}, {3, 200}, {200, 3}, {97, 61}}) {
    const RegionScene scene(Image<RegionId>(size, RegionId{0}, {}));
    const Image<ObjectHint> hints = hint_objects(scene.superpixels.edges, scene.cues(), {});
    EXPECT_EQ(hints.size(), hint_cells(size));
  }
}

/// Two adjacent regions, and hints for each.
struct HintedScene {
  RegionScene scene;
  Image<ObjectHint> hints{{80, 60}};

  HintedScene() : scene(labels()) {
    for (int y = 0; y < 60; ++y) {
      for (int x = 0; x < 80; ++x) {
        // Each cell votes for the centre of its half; the outline follows the border.
        const int middle = x < 40 ? 20 : 60;
        hints(x, y) = {32, static_cast<std::int16_t>(x == 39 || x == 40 ? 48 : -48),
                       static_cast<std::int16_t>(8 * (middle - x)), static_cast<std::int16_t>(8 * (30 - y)),
                       180};
      }
    }
  }
  static Image<RegionId> labels() {
    Image<RegionId> labels({160, 120});
    for (int y = 0; y < 120; ++y) {
      for (int x = 0; x < 160; ++x) labels(x, y) = RegionId{x < 80 ? 0 : 1};
    }
    return labels;
  }
  [[nodiscard]] Cues cues() const {
    Cues cues = scene.cues();
    cues.hints = hints;
    return cues;
  }
};

template <class Features>
float named(const std::vector<std::string_view>& names, const Features& features, std::string_view name) {
  const auto at = std::find(names.begin(), names.end(), name);
  EXPECT_NE(at, names.end()) << name;
  return features.at(static_cast<std::size_t>(at - names.begin()));
}

TEST(HintFeatures, IndicateThatTwoObjectsTouch) {
  const HintedScene scene;
  MergeFeatures pair{};
  const MergeTree tree =
      grow_merge_tree(scene.scene.superpixels, scene.cues(), {}, {},
                      [&](std::int32_t, std::int32_t, const MergeFeatures& by) { pair = by; });
  const auto of_pair = [&](std::string_view name) { return named(merge_feature_names(), pair, name); };
  EXPECT_EQ(of_pair("hints: outline along the border"), 3);
  EXPECT_EQ(of_pair("hints: object, smaller one"), 2);
  EXPECT_EQ(of_pair("hints: distance of the centroids, share of the width"), 0.5);
  EXPECT_EQ(of_pair("hints: difference of the sizes"), 0);
  EXPECT_NEAR(of_pair("hints: spread of the votes, relative"), 20 / std::sqrt(4801.0F), 1e-4);
  const auto of_region = [&](std::string_view name) {
    return named(object_feature_names(), tree.nodes[0].features, name);
  };
  EXPECT_EQ(of_region("hints: object"), 2);
  EXPECT_EQ(of_region("hints: spread of the votes, relative"), 0);
  EXPECT_NEAR(of_region("hints: its centroid from that of its votes, relative"), 0, 0.02);
  EXPECT_NEAR(of_region("hints: area over the voted size"), std::log2(2401.0) - 180 / 16.0, 1e-4);
  EXPECT_NEAR(of_region("hints: nearest centroid around it, relative"), 40 / std::sqrt(2401.0), 1e-4);
}

TEST(HintFeatures, AreUnknownWithoutHints) {
  const HintedScene scene;
  const MergeTree tree = grow_merge_tree(scene.scene.superpixels, scene.scene.cues(), {}, {});
  for (const std::string_view name : object_feature_names()) {
    if (!name.starts_with("hints:")) continue;
    EXPECT_EQ(named(object_feature_names(), tree.nodes[0].features, name), kUnknown) << name;
  }
}

}  // namespace
}  // namespace cairn
