// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>
#include <cmath>

#include <algorithm>
#include <cairn/image/gradient.hpp>
#include <cairn/image/noise.hpp>
#include <cairn/objects/fuse.hpp>
#include <cairn/objects/locate.hpp>
#include <cairn/objects/measure.hpp>
#include <cairn/regions/segment_disparity.hpp>
#include <cairn/regions/segment_intensity.hpp>
#include <cairn/regions/watershed.hpp>
#include <limits>

#include "support/grids.hpp"

namespace cairn {
namespace {

using grids::numbers;
using grids::random_image;

constexpr Size kSize{97, 71};

/// Slanted wall, three boards, noise and holes, the same for image and disparity.
struct World {
  Image<Gray> left;
  DisparityMap disparity;
};
World world(std::uint32_t seed) {
  World w{random_image<Gray>(kSize, 90, 96, seed),
          {Image<float>(kSize), Image<Reject>(kSize, Reject::none, {})}};
  const Image<int> noise = random_image<int>(kSize, 0, 40, seed + 1);
  const std::array<Rect, 3> boards{Rect{10, 12, 20, 30}, Rect{40, 30, 25, 22}, Rect{70, 8, 15, 40}};
  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 0; x < kSize.width; ++x) {
      float d = 3 + 0.01F * static_cast<float>(y);
      for (std::size_t i = 0; i < boards.size(); ++i) {
        const Rect& r = boards[i];
        if (x < r.x || y < r.y || x >= r.x + r.width || y >= r.y + r.height) continue;
        d = 10 + 7 * static_cast<float>(i);
        w.left(x, y) = static_cast<Gray>(w.left(x, y) + 30 * (static_cast<int>(i) + 1));
      }
      const bool hole = noise(x, y) == 0;
      w.disparity.disparity_px(x, y) =
          hole ? std::numeric_limits<float>::quiet_NaN() : d + static_cast<float>(noise(x, y) % 5) / 16;
      w.disparity.reject(x, y) = hole ? Reject::no_data : Reject::none;
    }
  }
  return w;
}

/// The number of 4-connected components of each label.
std::vector<int> pieces(const Image<RegionId>& labels, std::size_t count) {
  std::vector<int> result(count, 0);
  Image<std::uint8_t> seen(labels.size(), 0, {});
  std::vector<Point> stack;
  for (int y = 0; y < labels.height(); ++y) {
    for (int x = 0; x < labels.width(); ++x) {
      if (seen(x, y) != 0) continue;
      ++result.at(index(labels(x, y)));
      seen(x, y) = 1;
      stack.push_back({x, y});
      while (!stack.empty()) {
        const Point p = stack.back();
        stack.pop_back();
        for (const Point q :
             {Point{p.x, p.y - 1}, Point{p.x - 1, p.y}, Point{p.x + 1, p.y}, Point{p.x, p.y + 1}}) {
          if (!labels.view().contains(q.x, q.y) || seen(q.x, q.y) != 0 || labels(q.x, q.y) != labels(x, y))
            continue;
          seen(q.x, q.y) = 1;
          stack.push_back(q);
        }
      }
    }
  }
  return result;
}

/// Every id from 0 on occurs, in one component, in raster order of the first pixels.
void expect_connected_partition(const Image<RegionId>& labels, std::size_t count) {
  EXPECT_EQ(pieces(labels, count), std::vector<int>(count, 1));
  int next = 0;
  for (int y = 0; y < labels.height(); ++y) {
    for (int x = 0; x < labels.width(); ++x) {
      ASSERT_LE(number(labels(x, y)), next);
      next = std::max(next, number(labels(x, y)) + 1);
    }
  }
}

void expect_sums_match(const Segmentation& s) {
  std::int64_t pixels = 0;
  for (const Region& region : s.regions) pixels += region.pixel_count;
  EXPECT_EQ(pixels, s.labels.size().area());
}

TEST(RegionsProperties, BasinsPartitionTheImageAndAreConnected) {
  for (std::uint32_t seed = 1; seed <= 8; ++seed) {
    const Image<std::uint16_t> gradient = random_image<std::uint16_t>(kSize, 0, 1 << seed, seed);
    const Basins basins = watershed(gradient, {});
    expect_connected_partition(basins.labels, static_cast<std::size_t>(basins.count));
  }
}

TEST(RegionsProperties, BasinsDependOnTheOrderOfHeightsOnly) {
  const Image<std::uint16_t> gradient = random_image<std::uint16_t>(kSize, 0, 40, 3);
  Image<std::uint16_t> stretched(kSize);
  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 0; x < kSize.width; ++x) {
      stretched(x, y) = static_cast<std::uint16_t>(gradient(x, y) * gradient(x, y) + 7);
    }
  }
  EXPECT_EQ(numbers(watershed(stretched, {}).labels), numbers(watershed(gradient, {}).labels));
}

TEST(RegionsProperties, SegmentationsPartitionTheImageAndAreConnected) {
  for (std::uint32_t seed = 1; seed <= 4; ++seed) {
    const World w = world(seed);
    const Segmentation by_intensity = segment_intensity(w.left, {}, {});
    expect_connected_partition(by_intensity.labels, by_intensity.regions.size());
    expect_sums_match(by_intensity);
    const Segmentation by_disparity = segment_disparity(w.disparity, {}, {}, {});
    expect_connected_partition(by_disparity.labels, by_disparity.regions.size());
    expect_sums_match(by_disparity);
  }
}

TEST(RegionsProperties, OnlyTheFloorMayBeInPieces) {
  const World w = world(5);
  const Image<std::uint8_t> speckled = random_image<std::uint8_t>(kSize, 0, 1, 6);
  const Segmentation s = segment_disparity(w.disparity, speckled, {.min_region_area = 0}, {});
  const std::vector<int> in_pieces = pieces(s.labels, s.regions.size());
  int floors = 0;
  for (std::size_t i = 0; i < s.regions.size(); ++i) {
    floors += s.regions[i].is_floor ? 1 : 0;
    EXPECT_TRUE(s.regions[i].is_floor || in_pieces[i] == 1) << i;
  }
  EXPECT_EQ(floors, 1);
  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 0; x < kSize.width; ++x) {
      if (std::isnan(w.disparity.disparity_px(x, y))) continue;  // holes join their surroundings
      ASSERT_EQ(s.regions[index(s.labels(x, y))].is_floor, speckled(x, y) != 0);
    }
  }
}

TEST(RegionsProperties, BrighteningTheImageChangesNoIntensityRegion) {
  World w = world(7);
  const Segmentation before = segment_intensity(w.left, {}, {});
  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 0; x < kSize.width; ++x) w.left(x, y) = static_cast<Gray>(w.left(x, y) + 25);
  }
  EXPECT_EQ(numbers(segment_intensity(w.left, {}, {}).labels), numbers(before.labels));
}

TEST(RegionsProperties, AddingAWholeDisparityChangesNoDisparityRegion) {
  World w = world(8);
  const Segmentation before = segment_disparity(w.disparity, {}, {}, {});
  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 0; x < kSize.width; ++x) w.disparity.disparity_px(x, y) += 16;
  }
  const Segmentation after = segment_disparity(w.disparity, {}, {}, {});
  EXPECT_EQ(numbers(after.labels), numbers(before.labels));
  EXPECT_NEAR(after.regions[0].mean, before.regions[0].mean + 16, 1e-9);
}

TEST(RegionsProperties, RelabellingTheInputsDoesNotChangeFusion) {
  const World w = world(9);
  const Segmentation by_intensity = segment_intensity(w.left, {.smoothing_sigma = 0.7F}, {});
  const Segmentation by_disparity = segment_disparity(w.disparity, {}, {}, {});
  Segmentation renamed{by_intensity.labels.clone(), by_intensity.regions};
  const auto last = static_cast<std::int32_t>(renamed.regions.size()) - 1;
  std::reverse(renamed.regions.begin(), renamed.regions.end());
  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 0; x < kSize.width; ++x)
      renamed.labels(x, y) = RegionId{last - number(renamed.labels(x, y))};
  }
  ASSERT_GT(last, 3);
  const Fusion fusion = fuse(by_intensity, by_disparity, {});
  const Fusion again = fuse(renamed, by_disparity, {});
  EXPECT_EQ(numbers(again.labels), numbers(fusion.labels));
  EXPECT_EQ(again.disparity_region, fusion.disparity_region);
}

Objects objects_of(const World& w, float baseline_m) {
  const Segmentation by_intensity = segment_intensity(w.left, {}, {});
  const Segmentation by_disparity = segment_disparity(w.disparity, {}, {}, {});
  const StereoRig rig{.focal_px = 80, .cx_px = 48, .cy_px = 35, .baseline_m = baseline_m};
  const Fusion fusion = fuse(by_intensity, by_disparity, {});
  return locate(
      measure(fusion.labels, fusion.is_floor, w.disparity, {w.left, {}, noise_sigma(w.left)}, {}, {}),
      w.disparity, {}, rig, {});
}

TEST(RegionsProperties, DoublingTheBaselineDoublesDepthAndExtent) {
  const World w = world(10);
  const Objects once = objects_of(w, 0.1F);
  const Objects twice = objects_of(w, 0.2F);
  ASSERT_EQ(once.list.size(), 3U);
  ASSERT_EQ(twice.list.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_FLOAT_EQ(twice.list[i].position_in_camera_m->z, 2 * once.list[i].position_in_camera_m->z);
    EXPECT_FLOAT_EQ(twice.list[i].position_in_camera_m->x, 2 * once.list[i].position_in_camera_m->x);
    EXPECT_FLOAT_EQ(twice.list[i].extent_in_camera_m->y, 2 * once.list[i].extent_in_camera_m->y);
  }
}

TEST(RegionsProperties, ObjectsAreThoseOfTheSceneNearestFirst) {
  for (std::uint32_t seed = 20; seed < 24; ++seed) {
    const Objects objects = objects_of(world(seed), 0.1F);
    ASSERT_EQ(objects.list.size(), 3U) << "seed " << seed;
    EXPECT_NEAR(objects.list[0].disparity_px, 24, 0.3);
    EXPECT_NEAR(objects.list[1].disparity_px, 17, 0.3);
    EXPECT_NEAR(objects.list[2].disparity_px, 10, 0.3);
  }
}

TEST(RegionsProperties, MeasureAndLocateDoNotDependOnThreads) {
  const World w = world(30);
  const Segmentation by_intensity = segment_intensity(w.left, {}, {});
  const Segmentation by_disparity = segment_disparity(w.disparity, {}, {}, {});
  const Fusion fusion = fuse(by_intensity, by_disparity, {});
  const StereoRig rig{.focal_px = 80, .cx_px = 48, .cy_px = 35, .baseline_m = 0.1F};
  const auto found = [&](const Exec& exec) {
    return locate(
        measure(fusion.labels, fusion.is_floor, w.disparity, {w.left, {}, noise_sigma(w.left)}, {}, exec),
        w.disparity, {GroundPlane{0, 0.1F, 2}, 1, 0, Refusal::none}, rig, exec);
  };
  const Objects one = found({});
  const Objects three = found(Exec::with_threads(3));
  EXPECT_EQ(numbers(three.labels), numbers(one.labels));
  ASSERT_EQ(three.list.size(), one.list.size());
  for (std::size_t i = 0; i < one.list.size(); ++i) {
    EXPECT_EQ(three.list[i].position_in_camera_m, one.list[i].position_in_camera_m);
    EXPECT_EQ(three.list[i].disparity_sigma_px, one.list[i].disparity_sigma_px);
    ASSERT_TRUE(one.list[i].box_on_floor);
    EXPECT_EQ(three.list[i].box_on_floor->centre_in_floor_m, one.list[i].box_on_floor->centre_in_floor_m);
    EXPECT_EQ(three.list[i].box_on_floor->size_m, one.list[i].box_on_floor->size_m);
    EXPECT_EQ(three.list[i].disparity_px, one.list[i].disparity_px);
  }
}

}  // namespace
}  // namespace cairn
