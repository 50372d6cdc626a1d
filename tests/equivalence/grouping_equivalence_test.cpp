// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "reference/grouping.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cairn/core/target.hpp>
#include <cairn/regions/object_hints.hpp>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <utility>

#include "support/grids.hpp"

namespace cairn {
namespace {

constexpr float kNoise = 0.6F;  // grey levels

using grids::numbers;
using grids::random_image;
using reference::Members;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

std::vector<Size> sizes() {
  return {{1, 1}, {1, 23}, {27, 1}, {2, 2}, {3, 3}, {5, 19}, {16, 21}, {33, 25}};
}

/// An image of noisy blocks, disparities in other blocks with holes, and a scene model. Few distinct values
/// make ties.
struct Scene {
  Image<Gray> gray;
  Image<Rgb> colours;
  bool has_colour = false;
  Image<float> disparity_px;
  Image<float> textured_px;
  Ground ground;
  Background background;
  Image<ObjectHint> hints;

  Scene(Size size, std::uint32_t seed) : has_colour(seed % 2 == 0) {
    gray = blocks(size, seed);
    const Image<Gray> r = blocks(size, seed + 100);
    const Image<Gray> b = blocks(size, seed + 200);
    const Image<int> depths = random_image<int>({size.width / 6 + 1, size.height / 5 + 1}, 0, 20, seed + 1);
    const Image<int> chance = random_image<int>(size, 0, 99, seed + 2);
    colours = Image<Rgb>(size);
    disparity_px = Image<float>(size);
    textured_px = Image<float>(size);
    const int holes = static_cast<int>(seed % 4) * 15;
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) {
        colours(x, y) = {r(x, y), gray(x, y), b(x, y)};
        const int n = chance(x, y);
        const float d = 0.9F * static_cast<float>(depths(x / 6, y / 5)) + 0.01F * static_cast<float>(n % 20);
        disparity_px(x, y) = n < holes ? kNaN : d;
        textured_px(x, y) = n < 60 ? kNaN : d;
      }
    }
    if (seed % 5 != 1) hints = random_hints(size, seed);
    if (seed % 3 != 0) ground.plane = GroundPlane{0.01F, 0.4F, -3};
    if (seed % 3 != 1) background = {{{0.0F, 0.4F, -3}, {0.1F, 0, 2}}, true};
  }

  /// With fewer cells than pixels, or more.
  static Image<ObjectHint> random_hints(Size size, std::uint32_t seed) {
    const Size cells{size.width / 2 + 3, size.height / 2 + 2};
    std::mt19937 random(seed);
    const auto from = [&random](int least, int most) {
      return static_cast<std::int16_t>(least +
                                       static_cast<int>(random() % static_cast<unsigned>(most - least + 1)));
    };
    Image<ObjectHint> hints(cells);
    for (int y = 0; y < cells.height; ++y) {
      for (int x = 0; x < cells.width; ++x)
        hints(x, y) = {from(-96, 96), from(-96, 96), from(-60, 60), from(-60, 60), from(0, 160)};
    }
    return hints;
  }

  static Image<Gray> blocks(Size size, std::uint32_t seed) {
    const Image<int> shades = random_image<int>({size.width / 4 + 1, size.height / 3 + 1}, 2, 8, seed);
    const Image<int> noise = random_image<int>(size, 0, seed % 5 == 0 ? 0 : 6, seed + 3);
    Image<Gray> image(size);
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x)
        image(x, y) = static_cast<Gray>(25 * shades(x / 4, y / 3) + noise(x, y));
    }
    return image;
  }

  [[nodiscard]] View<const Rgb> rgb() const { return has_colour ? colours.view() : View<const Rgb>{}; }
  [[nodiscard]] Cues cues() const {
    return {{gray, rgb(), 1.25F}, disparity_px, textured_px, ground, background, hints};
  }
  [[nodiscard]] Superpixels superpixels(int count) const {
    return cut_superpixels(superpixel_edges({gray, rgb(), kNoise}, {}), hints, disparity_px, kNoise, {count},
                           {});
  }
};

// ---- superpixels ----

void expect_equal_to_definition(Size size, std::uint32_t seed, int count) {
  const Scene scene(size, seed);
  const Superpixels expected =
      reference::cut_superpixels(scene.gray, scene.rgb(), scene.hints, scene.disparity_px, kNoise, count);
  for (const Target target : supported_targets()) {
    SCOPED_TRACE(text(size) + " " + std::to_string(seed) + " " + std::to_string(count) + " " +
                 std::string(name(target)));
    const Exec exec = Exec::with_threads(1, target);
    const LeftImage left{scene.gray, scene.rgb(), kNoise};
    const Superpixels found =
        cut_superpixels(superpixel_edges(left, exec), scene.hints, scene.disparity_px, kNoise, {count}, exec);
    EXPECT_EQ(found.count, expected.count);
    EXPECT_EQ(numbers(found.labels), numbers(expected.labels));
    EXPECT_EQ(numbers(found.edges), numbers(expected.edges));
  }
}

TEST(CutSuperpixels, EqualsItsDefinition) {
  for (const Size size : sizes()) {
    for (std::uint32_t seed = 1; seed <= 6; ++seed) {
      for (const int count : {1, 7, 30}) expect_equal_to_definition(size, seed, count);
    }
  }
}

TEST(CutSuperpixels, EqualsItsDefinitionIfCutAtHalfAndQuarterSize) {
  for (std::uint32_t seed = 1; seed <= 4; ++seed) {
    expect_equal_to_definition({64, 33}, seed, 1);
    expect_equal_to_definition({95, 67}, seed, 3);
    expect_equal_to_definition({97, 86}, seed, 1);  // at a quarter
    expect_equal_to_definition({131, 33}, seed, 2);
  }
}

TEST(CutSuperpixels, EqualsItsDefinitionIfMostBordersAreEqual) {
  for (std::uint32_t seed = 1; seed <= 6; ++seed) {
    const Size size{21, 17};
    const Image<Gray> gray = random_image<Gray>(size, 0, 1, seed);
    const Image<float> holes(size, kNaN, {});
    for (const int count : {2, 9}) {
      const Superpixels found = cut_superpixels(LeftImage{gray, {}, kNoise}, holes, {count}, {});
      EXPECT_EQ(numbers(found.labels),
                numbers(reference::cut_superpixels(gray, {}, {}, holes, kNoise, count).labels))
          << seed << ' ' << count;
    }
  }
}

TEST(CutSuperpixels, GivesTheSameOnAnyNumberOfThreads) {
  const Scene scene({67, 53}, 2);
  const Superpixels expected = scene.superpixels(40);
  EXPECT_EQ(expected.count, 40);
  for (const int threads : {2, 3, 8}) {
    const Exec exec = Exec::with_threads(threads);
    const LeftImage left{scene.gray, scene.rgb(), kNoise};
    const Superpixels found =
        cut_superpixels(superpixel_edges(left, exec), scene.hints, scene.disparity_px, kNoise, {40}, exec);
    EXPECT_EQ(numbers(found.labels), numbers(expected.labels));
    EXPECT_EQ(numbers(found.edges), numbers(expected.edges));
  }
}

// ---- cues of regions ----

/// Trees that split on one feature each, at values that occur, with few distinct leaf values.
struct Stumps {
  std::vector<FittedTrees::Node> nodes;
  std::vector<std::int16_t> roots;

  void add(std::size_t feature, float value, float below, float above) {
    const auto root = static_cast<std::int16_t>(nodes.size());
    roots.push_back(root);
    nodes.push_back({static_cast<std::int16_t>(feature), static_cast<std::int16_t>(root + 1), value});
    nodes.push_back({-1, 0, below});
    nodes.push_back({-1, 0, above});
  }
  [[nodiscard]] FittedTrees trees() const { return {0.5F, roots, nodes}; }
};

Stumps random_stumps(const Superpixels& superpixels, const Cues& cues, int count, std::uint32_t seed) {
  std::vector<MergeFeatures> seen;
  const auto tell = [&](std::int32_t, std::int32_t, const MergeFeatures& by) { seen.push_back(by); };
  static_cast<void>(grow_merge_tree(superpixels, cues, FittedTrees{}, {}, tell));
  std::mt19937 random(seed);
  Stumps stumps;
  for (int i = 0; i < count && !seen.empty(); ++i) {
    const std::size_t feature = random() % kMergeFeatures;
    const float value = seen[random() % seen.size()][feature];
    const auto leaf = [&] { return 0.25F * static_cast<float>(static_cast<int>(random() % 9) - 4); };
    const float below = leaf();
    stumps.add(feature, value, below, leaf());
  }
  return stumps;
}

std::vector<Members> members_of(const MergeTree& tree) {
  std::vector<Members> all;
  for (const MergeNode& node : tree.nodes) {
    Members members;
    if (node.part_a < 0) members.insert(static_cast<std::int32_t>(all.size()));
    for (const std::int32_t part : {node.part_a, node.part_b}) {
      if (part >= 0) members.insert(all[slot(part)].begin(), all[slot(part)].end());
    }
    all.push_back(members);
  }
  return all;
}

using Contacts =
    std::map<std::pair<std::int32_t, std::int32_t>, ContactCues>;  // of the first over the second

/// The combined cues of two contacts with a third region.
void fuse_contacts(Contacts& contacts, std::int32_t part_a, std::int32_t part_b, std::int32_t whole) {
  contacts.erase(std::minmax(part_a, part_b));
  Contacts fused;
  for (const auto& [ends, contact] : contacts) {
    const auto is_part = [&](std::int32_t end) { return end == part_a || end == part_b; };
    if (!is_part(ends.first) && !is_part(ends.second)) {
      fused[ends].add(contact, false);
    } else {
      const bool turned = is_part(ends.first);
      fused[{turned ? ends.second : ends.first, whole}].add(contact, turned);
    }
  }
  contacts = std::move(fused);
}

TEST(RegionCues, OfEveryNodeOfATreeEqualThoseOfItsPixels) {
  int nodes = 0;
  int compared = 0;
  for (const Size size : sizes()) {
    for (std::uint32_t seed = 1; seed <= 4; ++seed) {
      const Scene scene(size, seed);
      const Cues cues = scene.cues();
      const Superpixels superpixels = scene.superpixels(24);
      const Stumps stumps = random_stumps(superpixels, cues, 10, seed);
      const MergeTree tree = grow_merge_tree(superpixels, cues, stumps.trees(), {});
      const std::vector<Members> members = members_of(tree);
      const RegionGraphCues graph = gather_cues(superpixels, cues, {});
      std::vector<RegionCues> regions = graph.regions;
      Contacts contacts;
      for (const ContactCues& contact : graph.contacts) {
        ASSERT_LT(contact.a, contact.b);
        ContactCues& nameless = contacts[{contact.a, contact.b}] = contact;
        nameless.a = nameless.b = 0;
      }
      for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
        const auto node = static_cast<std::int32_t>(i);
        if (const MergeNode& of = tree.nodes[i]; of.part_a >= 0) {
          const std::int64_t common = contacts.at(std::minmax(of.part_a, of.part_b)).length;
          regions.push_back(regions[slot(of.part_a)]);
          regions.back().add(regions[slot(of.part_b)], common);
          fuse_contacts(contacts, of.part_a, of.part_b, node);
        }
        EXPECT_TRUE(regions[i] == reference::cues_of(members[i], superpixels, cues))
            << text(size) << ' ' << seed << ' ' << i;
        ++nodes;
        if (i + 1 < slot(tree.superpixels)) continue;  // contacts are complete only with the last superpixel
        for (const auto& [ends, contact] : contacts) {
          EXPECT_TRUE(contact == reference::contact_of(members[slot(ends.first)], members[slot(ends.second)],
                                                       superpixels, cues))
              << text(size) << ' ' << seed << ' ' << ends.first << ' ' << ends.second;
          ++compared;
        }
      }
      EXPECT_TRUE(contacts.empty());
    }
  }
  EXPECT_GT(nodes, 500);
  EXPECT_GT(compared, 2000);
}

TEST(GatherCues, IsTheSameForEveryTarget) {
  for (const Size size : sizes()) {
    for (std::uint32_t seed = 1; seed <= 6; ++seed) {
      Scene scene(size, seed);
      scene.ground.plane = GroundPlane{-100, 20, 1500};  // from below 0 to above the largest disparity
      scene.background = {{{-90, 300, -5}, {0.1F, 0, 2}}, false};
      for (int x = 0; x < size.width; ++x) {
        scene.disparity_px(x, 0) = 0.37F - static_cast<float>(x);
        if (!std::isnan(scene.textured_px(x, 0))) scene.textured_px(x, 0) = scene.disparity_px(x, 0);
      }
      const Cues cues = scene.cues();
      const Superpixels superpixels = scene.superpixels(9);
      const RegionGraphCues expected = gather_cues(superpixels, cues, Exec::with_threads(1, Target::scalar));
      for (const Target target : supported_targets()) {
        const RegionGraphCues found = gather_cues(superpixels, cues, Exec::with_threads(1, target));
        EXPECT_TRUE(found.regions == expected.regions && found.contacts == expected.contacts)
            << text(size) << ' ' << seed << ' ' << name(target);
      }
      // The slow twin, over whole superpixels.
      for (std::int32_t i = 0; i < superpixels.count; ++i) {
        EXPECT_TRUE(expected.regions[slot(i)] == reference::cues_of({i}, superpixels, cues))
            << text(size) << ' ' << seed << ' ' << i;
      }
    }
  }
}

TEST(GatherCues, IsTheSameForAnyNumberOfThreads) {
  for (const Size size : {Size{70, 97}, {33, 32}, {300, 31}}) {
    const Scene scene(size, 5);
    for (const int count : {2, 40, 300}) {
      const Superpixels superpixels = scene.superpixels(count);
      const RegionGraphCues expected = gather_cues(superpixels, scene.cues(), {});
      for (const int threads : {2, 3, 8}) {
        const RegionGraphCues found = gather_cues(superpixels, scene.cues(), Exec::with_threads(threads));
        EXPECT_TRUE(found.regions == expected.regions && found.contacts == expected.contacts)
            << text(size) << ' ' << count << ' ' << threads;
      }
    }
  }
}

TEST(GatherCues, ListsContactsInRasterOrder) {
  Superpixels superpixels{grids::grid<RegionId>({{0, 0, 1}, {2, 1, 1}, {2, 3, 3}}), 4, {}};
  superpixels.edges = Image<std::uint16_t>(Size{3, 3}, std::uint16_t{0}, {});
  const Scene scene({3, 3}, 1);
  std::vector<std::pair<int, int>> ends;
  for (const ContactCues& c : gather_cues(superpixels, scene.cues(), {}).contacts)
    ends.emplace_back(c.a, c.b);
  EXPECT_EQ(ends, (std::vector<std::pair<int, int>>{{0, 2}, {0, 1}, {1, 2}, {1, 3}, {2, 3}}));
}

// ---- the tree ----

void expect_like(const ObjectFeatures& found, const ObjectFeatures& expected) {
  static const std::vector<std::string_view> kNames = object_feature_names();
  for (std::size_t i = 0; i < expected.size(); ++i) {
    // Sums of fractions over the neighbours, which both implementations add in their own order.
    EXPECT_NEAR(found.at(i), expected.at(i), 1e-4F * (1 + std::abs(expected.at(i)))) << kNames[i];
  }
}

void expect_equal(const MergeTree& found, const MergeTree& expected) {
  EXPECT_EQ(found.superpixels, expected.superpixels);
  ASSERT_EQ(found.nodes.size(), expected.nodes.size());
  for (std::size_t i = 0; i < expected.nodes.size(); ++i) {
    SCOPED_TRACE("node " + std::to_string(i));
    const MergeNode& f = found.nodes[i];
    const MergeNode& e = expected.nodes[i];
    ASSERT_EQ(std::pair(f.part_a, f.part_b), std::pair(e.part_a, e.part_b));
    EXPECT_EQ(f.whole, e.whole);
    EXPECT_EQ(f.area, e.area);
    EXPECT_EQ(f.origin.same_thing, e.origin.same_thing);
    EXPECT_EQ(f.origin.least_same_thing, e.origin.least_same_thing);
    EXPECT_EQ(f.origin.larger_part, e.origin.larger_part);
    expect_like(f.features, e.features);
  }
}

TEST(GrowMergeTree, EqualsItsDefinition) {
  for (const Size size : sizes()) {
    for (std::uint32_t seed = 1; seed <= 12; ++seed) {
      const Scene scene(size, seed);
      const Cues cues = scene.cues();
      const Superpixels superpixels = scene.superpixels(seed % 2 == 0 ? 30 : 14);
      // No tree nodes: all pairs are equally similar. One or two: many are.
      const Stumps stumps = random_stumps(superpixels, cues, static_cast<int>(seed * seed % 13), seed);
      SCOPED_TRACE(text(size) + ", seed " + std::to_string(seed));
      expect_equal(grow_merge_tree(superpixels, cues, stumps.trees(), {}),
                   reference::grow_merge_tree(superpixels, cues, stumps.trees()));
    }
  }
}

TEST(GrowMergeTree, EqualsItsDefinitionNextToALargeBackground) {
  // Much smaller regions merge with the surrounding frame, whose other contacts stay queued.
  for (std::uint32_t seed = 1; seed <= 8; ++seed) {
    const Size size{31, 27};
    const Scene scene(size, seed);
    Superpixels superpixels{Image<RegionId>(size, RegionId{0}, {}), 1, {}};
    superpixels.edges = random_image<std::uint16_t>(size, 0, 60, seed);
    for (int y = 1; y + 4 < size.height; y += 5) {
      for (int x = 1; x + 4 < size.width; x += 6, ++superpixels.count) {
        for (int i = 0; i < 16; ++i) superpixels.labels(x + i % 4, y + i / 4) = RegionId{superpixels.count};
      }
    }
    const Cues cues = scene.cues();
    const Stumps stumps = random_stumps(superpixels, cues, 12, seed);
    SCOPED_TRACE(seed);
    expect_equal(grow_merge_tree(superpixels, cues, stumps.trees(), {}),
                 reference::grow_merge_tree(superpixels, cues, stumps.trees()));
  }
}

// ---- choosing objects ----

/// A tree of random merges, with random values of the first feature.
MergeTree random_tree(int superpixels, std::mt19937& random) {
  MergeTree tree;
  tree.superpixels = superpixels;
  std::vector<std::int32_t> left;
  const auto add = [&](std::int32_t a, std::int32_t b, std::int64_t area) {
    left.push_back(static_cast<std::int32_t>(tree.nodes.size()));
    MergeNode& node = tree.nodes.emplace_back();
    node.part_a = a;
    node.part_b = b;
    node.area = area;
    node.features[0] = static_cast<float>(random() % 8);
  };
  for (int i = 0; i < superpixels; ++i) add(-1, -1, 1 + static_cast<std::int64_t>(random() % 9));
  while (left.size() > 1) {
    std::array<std::int32_t, 2> parts{};
    for (std::int32_t& part : parts) {
      const auto which = left.begin() + static_cast<std::ptrdiff_t>(random() % left.size());
      part = *which;
      left.erase(which);
      tree.nodes[slot(part)].whole = static_cast<std::int32_t>(tree.nodes.size());
    }
    add(parts[0], parts[1], tree.nodes[slot(parts[0])].area + tree.nodes[slot(parts[1])].area);
  }
  return tree;
}

TEST(ChooseObjects, HasTheHighestGainOfAllChoices) {
  Stumps stumps;
  for (int i = 1; i < 8; ++i) stumps.add(0, static_cast<float>(i), -0.4F, 0.4F);
  int objects = 0;
  int wholes = 0;
  for (std::uint32_t seed = 1; seed <= 300; ++seed) {
    std::mt19937 random(seed);
    const MergeTree tree = random_tree(1 + static_cast<int>(seed % 6), random);
    const ChoiceLimits limits{0.125F * static_cast<float>(seed % 7), static_cast<std::int64_t>(seed % 5)};
    const ChosenObjects found = choose_objects(tree, stumps.trees(), limits);
    const ChosenObjects expected = reference::choose_objects(tree, stumps.trees(), limits);
    EXPECT_EQ(found.object_of, expected.object_of) << seed;
    EXPECT_EQ(found.scores, expected.scores) << seed;
    EXPECT_EQ(found.likeliest, expected.likeliest) << seed;
    objects += static_cast<int>(found.scores.size()) - 1;
    wholes += found.scores.size() == 2 && tree.superpixels > 1 ? 1 : 0;
  }
  EXPECT_GT(objects, 300);
  EXPECT_GT(wholes, 30);
}

}  // namespace
}  // namespace cairn
