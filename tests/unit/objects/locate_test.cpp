// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/core/error.hpp>
#include <cairn/objects/locate.hpp>
#include <cairn/scene/floor_frame.hpp>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <queue>
#include <random>
#include <set>
#include <utility>
#include <vector>

namespace cairn {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr StereoRig kRig{.focal_px = 100, .cx_px = 20, .cy_px = 10, .baseline_m = 0.1F, .doffs_px = 0};

/// Rectangles as objects 1, 2, …, each with one disparity.
struct Scene {
  Objects objects;
  DisparityMap disparity;

  Scene(Size size, const std::vector<std::pair<Rect, float>>& boards)
      : objects{Image<ObjectId>(size, ObjectId::none, {}), {}},
        disparity{Image<float>(size, 2.0F, {}), Image<Reject>(size, Reject::none, {})} {
    for (const auto& [rect, d] : boards) {
      Object object;
      object.id = ObjectId{static_cast<std::int32_t>(objects.list.size()) + 1};
      object.box_px = rect;
      object.disparity_px = d;
      object.valid_share = 1;
      objects.list.push_back(object);
      for (int y = rect.y; y < rect.y + rect.height; ++y) {
        for (int x = rect.x; x < rect.x + rect.width; ++x) {
          objects.labels(x, y) = object.id;
          disparity.disparity_px(x, y) = d;
        }
      }
    }
  }
  [[nodiscard]] Objects located(const std::optional<StereoRig>& rig, const Ground& ground = {},
                                int threads = 1) const {
    return locate({objects.labels.clone(), objects.list}, disparity, ground, rig,
                  Exec::with_threads(threads));
  }
};

TEST(Locate, PositionsAnObjectInMetresIfARigIsKnown) {
  // Z = 100 · 0.1 / 5 = 2 m; a pixel is 2 cm wide there. The board's middle is at (24.5, 9.5).
  const Scene scene({60, 20}, {{{20, 5, 10, 10}, 5}});
  EXPECT_FALSE(scene.located({}).list[0].position_in_camera_m);
  EXPECT_FALSE(scene.located({}).list[0].depth_interval_m);
  const Object object = scene.located(kRig).list[0];
  ASSERT_TRUE(object.position_in_camera_m);
  EXPECT_NEAR(object.position_in_camera_m->x, 4.5 * 0.02, 1e-5);
  EXPECT_NEAR(object.position_in_camera_m->y, -0.5 * 0.02, 1e-5);
  EXPECT_NEAR(object.position_in_camera_m->z, 2, 1e-5);
  // Between the middles of the outermost pixels, enlarged by the removed tails.
  EXPECT_NEAR(object.extent_in_camera_m->x, 9 * 0.02 * 100 / 98, 1e-5);
  EXPECT_NEAR(object.extent_in_camera_m->y, 9 * 0.02 * 100 / 98, 1e-5);
  EXPECT_NEAR(object.extent_in_camera_m->z, 0, 1e-5);
  EXPECT_FALSE(object.box_on_floor);  // no ground
}

TEST(ObjectPoints, AreThoseOfItsPixelsInRasterOrder) {
  // Z = 2 m: a pixel is 2 cm wide there.
  Scene scene({60, 20}, {{{20, 5, 2, 2}, 5}, {{22, 5, 8, 2}, 4}});
  scene.disparity.disparity_px(21, 5) = kNan;
  scene.disparity.disparity_px(20, 6) = 0;
  const std::vector<Vec3> points =
      object_points(scene.objects, ObjectId{1}, scene.disparity.disparity_px, kRig);
  ASSERT_EQ(points.size(), 2U);
  EXPECT_FLOAT_EQ(points[0].x, 0);
  EXPECT_FLOAT_EQ(points[0].y, -0.1F);
  EXPECT_FLOAT_EQ(points[0].z, 2);
  EXPECT_FLOAT_EQ(points[1].x, 0.02F);
  EXPECT_FLOAT_EQ(points[1].y, -0.08F);
  for (const int id : {-1, 0, 3}) {
    EXPECT_THROW((void)object_points(scene.objects, ObjectId{id}, scene.disparity.disparity_px, kRig), Error);
  }
}

TEST(Locate, FarMismatchesDoNotPullTheDistance) {
  Scene scene({60, 20}, {{{20, 5, 10, 10}, 5}});
  for (int x = 20; x < 24; ++x) {  // a tenth of them at 10 m or more
    for (int y = 5; y < 8; ++y) scene.disparity.disparity_px(x, y) = 1.0F - 0.1F * static_cast<float>(y - 5);
  }
  const Object object = scene.located(kRig).list[0];
  EXPECT_NEAR(object.position_in_camera_m->z, 2, 1e-5);
  EXPECT_NEAR(object.extent_in_camera_m->z, 0, 1e-5);
}

TEST(Locate, AFewOutliersOfOneSurfaceDoNotStretchTheExtent) {
  Scene scene({60, 20}, {{{20, 5, 10, 10}, 5}});
  scene.disparity.disparity_px(22, 7) = 4.5F;  // 2.22 m, connected to the rest
  EXPECT_NEAR(scene.located(kRig).list[0].extent_in_camera_m->z, 0, 1e-5);
  for (int i = 0; i < 6; ++i) scene.disparity.disparity_px(21 + i, 8) = 4.5F;
  EXPECT_NEAR(scene.located(kRig).list[0].extent_in_camera_m->z, (10 / 4.5 - 2) * 10 / 9, 1e-4);
}

TEST(Locate, ThePositionIsThatOfTheMaskEvenWhereItHasHoles) {
  Scene scene({60, 20}, {{{20, 5, 10, 10}, 5}});
  for (int y = 8; y < 15; ++y) {
    for (int x = 20; x < 30; ++x) scene.disparity.disparity_px(x, y) = kNan;
  }
  for (int y = 5; y < 10; ++y) scene.objects.labels(20, y) = ObjectId::none;
  const Object object = scene.located(kRig).list[0];
  EXPECT_NEAR(object.position_in_camera_m->x, (9.5 * 50 + 10 * 45) / 95 * 0.02 - 5 * 0.02, 1e-5);
  EXPECT_NEAR(object.position_in_camera_m->y, ((9.5 * 100 - 7 * 5) / 95 - 10) * 0.02, 1e-5);
}

TEST(Locate, MeasuresTheLargestPartOfOneSurface) {
  // Of the mask's 100 pixels, 40 are behind the rest by more than a pixel of disparity.
  Scene scene({60, 20}, {{{20, 5, 10, 10}, 5}});
  for (int y = 5; y < 15; ++y) {
    for (int x = 26; x < 30; ++x) scene.disparity.disparity_px(x, y) = 3.5F;
  }
  const Object object = scene.located(kRig).list[0];
  EXPECT_NEAR(object.extent_in_camera_m->x, 5 * 0.02 * 100 / 98, 1e-5);
  EXPECT_NEAR(object.extent_in_camera_m->z, 0, 1e-5);
  EXPECT_NEAR(object.position_in_camera_m->x, 4.5 * 0.02, 1e-5);  // of the whole mask
}

TEST(Locate, KeepsPartsSeparatedByAHoleAtTheSameDepth) {
  Scene scene({60, 20}, {{{20, 5, 10, 10}, 5}});
  for (int y = 5; y < 15; ++y) scene.disparity.disparity_px(26, y) = kNan;
  EXPECT_NEAR(scene.located(kRig).list[0].extent_in_camera_m->x, 9 * 0.02 * 100 / 98, 1e-5);
  // Not on the largest surface, and nearer than all of it.
  for (int y = 5; y < 15; ++y) scene.disparity.disparity_px(29, y) = 5.01F;
  const Object object = scene.located(kRig).list[0];
  EXPECT_NEAR(object.extent_in_camera_m->x, 8 * 0.02 * 100 / 98, 1e-5);
  EXPECT_NEAR(object.extent_in_camera_m->z, 0, 1e-5);
}

TEST(Locate, AnObjectFartherThanAFloatHoldsHasNoPosition) {
  constexpr StereoRig kFar{.focal_px = 1e30F, .cx_px = 20, .cy_px = 10, .baseline_m = 1e20F, .doffs_px = 0};
  const Object object = Scene({120, 60}, {{{10, 10, 30, 20}, 8}}).located(kFar).list[0];
  EXPECT_FALSE(object.position_in_camera_m);
  EXPECT_FALSE(object.extent_in_camera_m);
}

TEST(Locate, AnObjectAtInfinityHasNoPosition) {
  EXPECT_FALSE(Scene({60, 20}, {{{20, 5, 10, 10}, 0}}).located(kRig).list[0].position_in_camera_m);
}

TEST(Locate, TheIntervalOfDepthIsThatOfTheDisparity) {
  const Object object = Scene({60, 20}, {{{20, 5, 10, 10}, 5}}).located(kRig).list[0];
  ASSERT_TRUE(object.depth_interval_m);
  ASSERT_GT(object.disparity_sigma_px, 0.01F);
  const double off = 1.96 * double{object.disparity_sigma_px};
  EXPECT_NEAR(object.depth_interval_m->low, 10 / (5 + off), 1e-5);
  EXPECT_NEAR(object.depth_interval_m->high, 10 / (5 - off), 1e-5);
}

TEST(Locate, APossiblyInfiniteDepthIsReported) {
  const Object object = Scene({60, 20}, {{{20, 5, 10, 10}, 0.05F}}).located(kRig).list[0];
  ASSERT_TRUE(object.depth_interval_m);
  EXPECT_TRUE(std::isinf(object.depth_interval_m->high));
  EXPECT_LT(object.depth_interval_m->low, object.position_in_camera_m->z);
}

TEST(Locate, IsLessCertainOfScatteredOrSparseDisparities) {
  Scene scene({60, 20}, {{{20, 5, 10, 10}, 5}, {{35, 5, 10, 10}, 5}, {{48, 5, 10, 10}, 5}});
  for (int y = 5; y < 15; ++y) {
    for (int x = 35; x < 45; ++x) scene.disparity.disparity_px(x, y) += 0.2F * static_cast<float>(x % 5);
  }
  scene.objects.list[2].valid_share = 0.5F;
  const Objects found = scene.located({});
  EXPECT_GT(found.list[1].disparity_sigma_px, 1.5F * found.list[0].disparity_sigma_px);
  EXPECT_GT(found.list[2].disparity_sigma_px, 1.5F * found.list[0].disparity_sigma_px);
}

// ---- the main part: a slow twin ----

/// The largest set of the object's pixels connected by steps of at most 1 px of disparity; ties: first in
/// raster order.
std::set<std::pair<int, int>> largest_part(const Scene& scene, ObjectId id) {
  const auto [width, height] = scene.objects.labels.size();
  std::set<std::pair<int, int>> seen;
  std::set<std::pair<int, int>> largest;
  const auto is_of = [&](int x, int y) {
    return x >= 0 && y >= 0 && x < width && y < height && scene.objects.labels(x, y) == id &&
           !std::isnan(scene.disparity.disparity_px(x, y));
  };
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (!is_of(x, y) || seen.count({x, y}) != 0) continue;
      std::set<std::pair<int, int>> part{{x, y}};
      std::queue<std::pair<int, int>> next({{x, y}});
      for (; !next.empty(); next.pop()) {
        const auto [u, v] = next.front();
        for (const auto& [p, q] : {std::pair{u + 1, v}, {u - 1, v}, {u, v + 1}, {u, v - 1}}) {
          if (!is_of(p, q) || part.count({p, q}) != 0) continue;
          if (std::abs(scene.disparity.disparity_px(p, q) - scene.disparity.disparity_px(u, v)) > 1) continue;
          part.insert({p, q});
          next.push({p, q});
        }
      }
      seen.insert(part.begin(), part.end());
      if (part.size() > largest.size()) largest = part;
    }
  }
  return largest;
}

/// Those, and the other pixels of the object with a disparity between their least and greatest.
std::set<std::pair<int, int>> main_part(const Scene& scene, ObjectId id) {
  const std::set<std::pair<int, int>> largest = largest_part(scene, id);
  std::set<float> known;
  for (const auto& [x, y] : largest) known.insert(scene.disparity.disparity_px(x, y));
  std::set<std::pair<int, int>> part;
  for (int y = 0; y < scene.objects.labels.height(); ++y) {
    for (int x = 0; x < scene.objects.labels.width(); ++x) {
      const float d = scene.disparity.disparity_px(x, y);
      if (scene.objects.labels(x, y) == id && d >= *known.begin() && d <= *known.rbegin())
        part.insert({x, y});
    }
  }
  return part;
}

TEST(Locate, TheMainPartIsThatOfTheDefinition) {
  std::mt19937 bits(4);
  for (int round = 0; round < 20; ++round) {
    Scene scene({70, 150}, {{{3, 4, 30, 140}, 5}, {{33, 4, 30, 140}, 5}});
    const float step = 0.45F * static_cast<float>(1 + round % 4);  // from one surface to many small ones
    for (int y = 0; y < 150; ++y) {
      for (int x = 0; x < 70; ++x) {
        const auto random = static_cast<int>(bits() % 10);
        scene.disparity.disparity_px(x, y) = random == 0 ? kNan : 5.0F + step * static_cast<float>(random);
      }
    }
    const Objects found = scene.located(kRig, {}, round % 3 + 1);
    for (const Object& object : found.list) {
      std::vector<float> across_m;
      for (const auto& [x, y] : main_part(scene, object.id))
        across_m.push_back(static_cast<float>(x - 20) * 10 / scene.disparity.disparity_px(x, y) / 100);
      std::sort(across_m.begin(), across_m.end());
      const auto at = [&](std::size_t percent) {
        return across_m[(percent * (across_m.size() - 1) + 50) / 100];
      };
      EXPECT_NEAR(object.extent_in_camera_m->x, (at(99) - at(1)) * 100 / 98, 1e-5);
    }
  }
}

// ---- boxes on the floor ----

constexpr StereoRig kLarge{.focal_px = 300, .cx_px = 160, .cy_px = 120, .baseline_m = 0.2F, .doffs_px = 0};

Ground level_floor(float height_m) {
  return {GroundPlane{0, kLarge.baseline_m / height_m, -kLarge.baseline_m / height_m * kLarge.cy_px}, 1, 0,
          Refusal::none};
}

/// A camera 1 m above the floor that sees two sides of a crate: its nearest edge is at `corner` (x forward, y
/// left), from which one side extends at `yaw` and the other perpendicular to it.
struct Crate {
  double yaw;
  double length_a;
  double length_b;
  double height;
};

Scene scene_of(const Crate& crate, std::pair<double, double> corner) {
  Scene scene({320, 240}, {});
  Object object;
  object.id = ObjectId{1};
  object.valid_share = 1;
  std::vector<float> all;
  for (int y = 0; y < 240; ++y) {
    for (int x = 0; x < 320; ++x) {
      scene.disparity.disparity_px(x, y) = kNan;
      // The ray (forward, left, up) = (1, −(x − cx)/f, −(y − cy)/f), from 1 m above the floor.
      const double left = -(x - 160) / 300.0;
      const double up = -(y - 120) / 300.0;
      double nearest = std::numeric_limits<double>::infinity();
      for (const auto& [angle, length] :
           {std::pair{crate.yaw, crate.length_a}, {crate.yaw + std::numbers::pi / 2, crate.length_b}}) {
        // corner + s·(cos, sin) = t·(1, left)
        const double determinant = std::sin(angle) - left * std::cos(angle);
        if (std::abs(determinant) < 1e-9) continue;
        const double t = (corner.first * std::sin(angle) - corner.second * std::cos(angle)) / determinant;
        const double s = (left * corner.first - corner.second) / determinant;
        const double z = 1 + t * up;
        if (s < 0 || s > length || z < 0 || z > crate.height || t <= 0) continue;
        nearest = std::min(nearest, t);
      }
      if (std::isinf(nearest)) continue;
      scene.objects.labels(x, y) = object.id;
      scene.disparity.disparity_px(x, y) = static_cast<float>(60 / nearest);
      all.push_back(static_cast<float>(60 / nearest));
    }
  }
  std::nth_element(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2), all.end());
  object.disparity_px = all[all.size() / 2];
  scene.objects.list.push_back(object);
  return scene;
}

/// From the 1st to the 99th percentile of how far up the main part's points are, each with the mean disparity of a
/// window.
Interval heights_of_box(const Scene& scene, ObjectId id) {
  const std::set<std::pair<int, int>> part = main_part(scene, id);
  std::vector<float> up_m;
  for (const auto& [x, y] : part) {
    float sum = 0;
    float count = 0;
    for (int v = y - 2; v <= y + 2; ++v) {
      for (int u = x - 2; u <= x + 2; ++u) {
        if (part.count({u, v}) == 0) continue;
        sum += scene.disparity.disparity_px(u, v);
        ++count;
      }
    }
    up_m.push_back((kLarge.cy_px - static_cast<float>(y)) * kLarge.baseline_m / (sum / count));
  }
  std::sort(up_m.begin(), up_m.end());
  const auto at = [&](std::size_t percent) { return up_m[(percent * (up_m.size() - 1) + 50) / 100]; };
  return {at(1), at(99)};
}

TEST(Locate, TheBoxIsThatOfTheMeansInWindows) {
  std::mt19937 bits(5);
  for (const Rect box : {Rect{3, 4, 30, 40}, {0, 0, 70, 50}, {69, 10, 1, 30}, {5, 49, 60, 1}, {8, 8, 1, 1}}) {
    Scene scene({70, 50}, {{box, 5}});
    for (int y = 0; y < 50; ++y) {
      for (int x = 0; x < 70; ++x) {
        const auto random = static_cast<float>(bits() % 16);
        const bool is_hole = random == 0 && box.width * box.height > 1;
        scene.disparity.disparity_px(x, y) = is_hole ? kNan : 30 + 0.125F * random;
      }
    }
    const Object object = scene.located(kLarge, level_floor(1)).list[0];
    ASSERT_TRUE(object.box_on_floor);
    const auto [low, high] = heights_of_box(scene, object.id);
    EXPECT_NEAR(object.box_on_floor->size_m.z, high - low, 1e-5);
    EXPECT_NEAR(object.box_on_floor->centre_in_floor_m.z, 1 + (low + high) / 2, 1e-5);
  }
}

TEST(Locate, ACratesBoxIsTheCrate) {
  for (const double yaw : {-0.9, -0.6, -0.3}) {
    const Crate crate{yaw, 0.9, 0.5, 0.6};
    const std::pair corner{2.5, 0.1};
    const Object object = scene_of(crate, corner).located(kLarge, level_floor(1)).list[0];
    ASSERT_TRUE(object.box_on_floor);
    const FloorBox& box = *object.box_on_floor;
    EXPECT_NEAR(box.size_m.x, 0.9, 0.095) << yaw;  // without the tails, and of means in windows
    EXPECT_NEAR(box.size_m.y, 0.5, 0.06) << yaw;
    EXPECT_NEAR(box.size_m.z, 0.6, 0.04) << yaw;
    EXPECT_NEAR(box.yaw_rad, yaw, 0.06) << yaw;
    const double along_x = 0.45 * std::cos(yaw) - 0.25 * std::sin(yaw);
    const double along_y = 0.45 * std::sin(yaw) + 0.25 * std::cos(yaw);
    EXPECT_NEAR(box.centre_in_floor_m.x, corner.first + along_x, 0.06) << yaw;
    EXPECT_NEAR(box.centre_in_floor_m.y, corner.second + along_y, 0.06) << yaw;
    EXPECT_NEAR(box.centre_in_floor_m.z, 0.3, 0.03) << yaw;
  }
}

/// A wall as one object of given width and height, rotated by `yaw` about its centre column, 2 m ahead.
Scene wall_of(int width, int height, double yaw) {
  Scene scene({320, 240}, {{{160 - width / 2, 120 - height / 2, width, height}, 30}});
  for (int y = 0; y < 240; ++y) {
    for (int x = 0; x < 320; ++x) {
      if (scene.objects.labels(x, y) == ObjectId::none) continue;
      // (2, 0) + s·(cos, sin) = t·(1, −(x − cx)/f)
      const double left = -(x - 160) / 300.0;
      const double t = 2 * std::sin(yaw) / (std::sin(yaw) - left * std::cos(yaw));
      scene.disparity.disparity_px(x, y) = static_cast<float>(60 / t);
    }
  }
  return scene;
}

TEST(Locate, ABoxIsAlignedWithItsFaceWhateverItsWidthInPixels) {
  for (const auto& [width, height] : {std::pair{60, 171}, {64, 128}, {64, 127}, {32, 160}}) {
    const double yaw = -1.1;
    const Object object = wall_of(width, height, yaw).located(kLarge, level_floor(1)).list[0];
    ASSERT_TRUE(object.box_on_floor);
    EXPECT_NEAR(object.box_on_floor->yaw_rad, yaw, 0.05) << width;
    EXPECT_LT(object.box_on_floor->size_m.y, 0.02) << width;
  }
}

TEST(Locate, DisparitiesNearInfinityAreHarmlessAndHaveNoPosition) {
  std::mt19937 bits(1);
  for (int round = 0; round < 30; ++round) {
    Scene scene({320, 240}, {{{100, 60, 90, 90}, 0.5F}});
    for (int y = 60; y < 150; ++y) {
      for (int x = 100; x < 190; ++x) {
        const double exponent = -38.0 * static_cast<double>(bits() % 1000) / 999;
        if (bits() % 3 != 0)
          scene.disparity.disparity_px(x, y) = static_cast<float>(std::pow(10.0, exponent));
      }
    }
    if (round % 2 == 0) scene.objects.list[0].disparity_px = 1e-37F;
    const Object object = scene.located(kLarge, level_floor(1)).list[0];
    EXPECT_EQ(object.position_in_camera_m.has_value(), round % 2 == 1);
    if (!object.box_on_floor) continue;
    for (const float c : object.box_on_floor->centre_covariance_m2) EXPECT_TRUE(std::isfinite(c));
    EXPECT_TRUE(std::isfinite(object.box_on_floor->centre_in_floor_m.x));
    EXPECT_TRUE(std::isfinite(object.extent_in_camera_m->z));
  }
}

TEST(Locate, AnObjectWhoseMeansAreBeyondInfinityHasNoBox) {
  StereoRig rig = kLarge;
  rig.doffs_px = -10;
  Scene scene({320, 240}, {{{100, 60, 30, 30}, 10.1F}});
  for (int y = 60; y < 90; ++y) {
    for (int x = 100; x < 130; ++x) {
      if ((x + y) % 3 == 0) scene.disparity.disparity_px(x, y) = 9.2F;
    }
  }
  const Object object = scene.located(rig, level_floor(1)).list[0];
  EXPECT_TRUE(object.extent_in_camera_m);
  EXPECT_FALSE(object.box_on_floor);
}

TEST(Locate, KeepsNothingOfAnEarlierFrame) {
  Scene scene({60, 20}, {{{20, 5, 10, 10}, 5}});
  scene.objects = scene.located(kLarge, level_floor(1));
  ASSERT_TRUE(scene.objects.list[0].box_on_floor);
  const Object again = scene.located({}).list[0];
  EXPECT_FALSE(again.position_in_camera_m);
  EXPECT_FALSE(again.depth_interval_m);
  EXPECT_FALSE(again.extent_in_camera_m);
  EXPECT_FALSE(again.box_on_floor);
}

TEST(Locate, ABoxIsMostCertainAcrossTheView) {
  const Object object = scene_of({-0.6, 0.9, 0.5, 0.6}, {2.5, -0.5}).located(kLarge, level_floor(1)).list[0];
  ASSERT_TRUE(object.box_on_floor);
  const auto& [xx, xy, xz, yy, yz, zz] = object.box_on_floor->centre_covariance_m2;
  const double z = object.position_in_camera_m->z;
  const double sigma_z = z * z * object.disparity_sigma_px / 60;
  EXPECT_GT(std::sqrt(xx), sigma_z);  // the forward axis is depth, including the box's extent
  EXPECT_LT(std::sqrt(xx), sigma_z + 0.2 * 0.9);
  EXPECT_LT(yy, xx);
  EXPECT_LT(zz, xx);
  EXPECT_GT(xx * yy - xy * xy, 0);  // positive definite
  EXPECT_GT(yy * zz - yz * yz, 0);
  EXPECT_GT(xx * zz - xz * xz, 0);
}

}  // namespace
}  // namespace cairn
