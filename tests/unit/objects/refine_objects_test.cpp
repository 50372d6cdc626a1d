// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <algorithm>
#include <cairn/objects/refine_objects.hpp>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>
#include <vector>

namespace cairn {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr Size kSize{160, 60};

/// A wavy board and its image in the right camera, rounded to whole grey levels.
float wave(double x, int y) {
  return static_cast<float>(128 + 40 * std::sin(x * 0.45 + y * 0.3) + 25 * std::sin(x * 0.19 - y * 0.7));
}
Gray rounded(float value) {
  return static_cast<Gray>(std::lround(value));
}

/// Boards as objects 1, 2, … in a pair of images in which they have their true disparities.
struct Scene {
  struct Board {
    Rect rect;
    float true_px;
    float surface_disparity_px;  // by the matching
  };
  Image<Gray> left;
  Image<Gray> right;
  Objects objects;
  DisparityMap disparity;

  explicit Scene(const std::vector<Board>& boards, bool textured = true, int brighter = 0, Size size = kSize)
      : left(size, Gray{90}, {}),
        right(size, Gray{90}, {}),
        objects{Image<ObjectId>(size, ObjectId::none, {}), {}},
        disparity{Image<float>(size, 2.0F, {}), Image<Reject>(size, Reject::none, {})} {
    for (const auto& [rect, true_px, surface_disparity_px] : boards) {
      Object object;
      object.id = ObjectId{static_cast<std::int32_t>(objects.list.size()) + 1};
      object.box_px = rect;
      object.pixel_count = rect.width * rect.height;
      object.disparity_px = surface_disparity_px;
      objects.list.push_back(object);
      for (int y = rect.y; y < rect.y + rect.height; ++y) {
        for (int x = rect.x; x < rect.x + rect.width; ++x) {
          objects.labels(x, y) = object.id;
          disparity.disparity_px(x, y) = surface_disparity_px;
          left(x, y) = textured ? rounded(wave(x, y)) : Gray{128};
        }
        for (int x = 0; x < size.width; ++x) {
          const double in_left = x + double{true_px};
          if (in_left >= rect.x && in_left < rect.x + rect.width)
            right(x, y) = textured ? rounded(wave(in_left, y) + static_cast<float>(brighter)) : Gray{128};
        }
      }
    }
  }
  [[nodiscard]] Objects refined(int threads = 1, const FittedTrees& bias = {}) const {
    return refine_objects({objects.labels.clone(), objects.list}, disparity, left, right, bias,
                          Exec::with_threads(threads));
  }
  [[nodiscard]] BiasFeatures features(double shift_px = 0) const {
    const std::vector<double> shifts(objects.list.size(), shift_px);
    return bias_features(objects, shifts, disparity, left, right, {}).front();
  }
};

TEST(RefineObjects, FindsTheShiftThatMakesTheImagesAgree) {
  for (const float off : {-0.6F, -0.25F, 0.0F, 0.25F, 0.6F}) {
    const Scene scene({{{40, 10, 60, 40}, 12.3F, 12.3F + off}});
    EXPECT_NEAR(scene.refined().list[0].disparity_px, 12.3, 0.03) << off;
  }
}

TEST(RefineObjects, UsesSomeRowsOfALargeObject) {
  for (const float off : {-0.4F, 0.3F}) {
    const Scene scene({{{40, 10, 560, 300}, 12.3F, 12.3F + off}}, true, 0, {640, 320});
    EXPECT_NEAR(scene.refined().list[0].disparity_px, 12.3, 0.03) << off;
  }
}

TEST(RefineObjects, IgnoresGainAndOffset) {
  const Scene scene({{{40, 10, 60, 40}, 12.3F, 12.1F}}, true, 20);
  EXPECT_NEAR(scene.refined().list[0].disparity_px, 12.3, 0.03);
}

TEST(RefineObjects, KeepsTheDisparityWithoutTexture) {
  const Scene scene({{{40, 10, 40, 40}, 12, 12.5F}}, false);
  EXPECT_FLOAT_EQ(scene.refined().list[0].disparity_px, 12.5F);
}

TEST(RefineObjects, ShiftsByOnePixelAtMost) {
  const Scene scene({{{40, 10, 60, 40}, 12, 9}});
  EXPECT_LE(std::abs(scene.refined().list[0].disparity_px - 9), 1.0F);
}

TEST(RefineObjects, UsesNoHolesNoOutlinesAndNothingOutsideTheRightImage) {
  Scene scene({{{40, 10, 60, 40}, 12.3F, 12.1F}});
  for (int y = 10; y < 50; ++y) {
    for (int x = 40; x < 44; ++x) scene.disparity.disparity_px(x, y) = 30;  // as carried from elsewhere
    for (int x = 70; x < 74; ++x) scene.disparity.disparity_px(x, y) = kNan;
    for (int x = 60; x < 64; ++x) scene.disparity.disparity_px(x, y) = y % 2 == 0 ? 200.0F : -200.0F;
  }
  EXPECT_NEAR(scene.refined().list[0].disparity_px, 12.3, 0.03);
}

TEST(RefineObjects, WithoutARightImageNothingChanges) {
  const Scene scene({{{40, 10, 60, 40}, 12.3F, 12.1F}});
  const Objects same = refine_objects({scene.objects.labels.clone(), scene.objects.list}, scene.disparity,
                                      scene.left, {}, disparity_bias_trees(), {});
  EXPECT_EQ(same.list[0].disparity_px, 12.1F);
}

TEST(RefineObjects, AddsTheExpectedBiasBeyondDoubt) {
  const Scene scene({{{40, 10, 60, 40}, 12, 12}}, false);
  for (const auto& [bias, added] : {std::pair{0.05F, 0.0F},
                                    {-0.05F, 0.0F},
                                    {0.3F, 0.22F},
                                    {-0.3F, -0.22F},
                                    {9.0F, 1.0F},
                                    {-9.0F, -1.0F}}) {
    const FittedTrees always(bias, {}, {});
    EXPECT_NEAR(scene.refined(1, always).list[0].disparity_px - 12, added, 1e-5) << bias;
  }
}

TEST(RefineObjects, ChangesADisparityByHalfAtMost) {
  const Scene scene({{{40, 10, 60, 40}, 1.5F, 1.5F}}, false);
  EXPECT_FLOAT_EQ(scene.refined(1, FittedTrees(-9, {}, {})).list[0].disparity_px, 0.75F);
}

// ---- features of the bias ----

float feature(const BiasFeatures& features, std::string_view name) {
  const auto names = bias_feature_names();
  const auto at = std::find(names.begin(), names.end(), name);
  EXPECT_NE(at, names.end()) << name;
  return features[static_cast<std::size_t>(at - names.begin())];
}

TEST(BiasFeatures, AreZeroForALevelBoardInItsPlace) {
  const Scene scene({{{40, 10, 60, 40}, 12, 12}});
  const BiasFeatures features = scene.features(0.125);
  for (const std::string_view name : {"disparity at the ends of the rows, minus the median",
                                      "disparity of the upper part, minus the median",
                                      "plane of the disparities at the centroid, minus the median"})
    EXPECT_EQ(feature(features, name), 0) << name;
  for (const std::string_view name :
       {"shift by the images, middle of the rows", "shift by the images from a plane, middle of the rows",
        "shift by the images from a plane, without the outline"})
    EXPECT_NEAR(feature(features, name), 0, 0.01) << name;
  EXPECT_EQ(feature(features, "shift by the images"), 0.125F);
  EXPECT_EQ(feature(features, "disparity times mean width, share of the image"), 12.0F * 60 / 160);
  EXPECT_EQ(feature(features, "disparity minus that beside the object"), 10) << "the background has 2 px";
}

TEST(BiasFeatures, ShowThatTheEndsOfARoundObjectAreFarther) {
  Scene scene({{{40, 10, 60, 40}, 12, 12}});
  for (int y = 10; y < 50; ++y) {
    for (int x = 40; x < 100; ++x) {
      const float across = (static_cast<float>(x) - 69.5F) / 30;
      scene.disparity.disparity_px(x, y) = 12 - 2 * across * across - (y < 16 ? 3.0F : 0.0F);
    }
  }
  scene.objects.list[0].disparity_px = 11.5F;
  const BiasFeatures features = scene.features();
  EXPECT_LT(feature(features, "disparity at the ends of the rows, minus the median"), -0.5F);
  EXPECT_LT(feature(features, "disparity of the upper part, minus the median"), -0.1F);
}

TEST(BiasFeatures, SeeWhereTheImagesAgree) {
  const Scene scene({{{40, 10, 60, 40}, 12.3F, 12}});
  const BiasFeatures features = scene.features();
  for (const std::string_view name :
       {"shift by the images, middle of the rows", "shift by the images from a plane, middle of the rows",
        "shift by the images from a plane, without the outline"})
    EXPECT_NEAR(feature(features, name), 0.3, 0.03) << name;
  EXPECT_GT(feature(features, "certainty of that shift"), 10);
  const Scene plain({{{40, 10, 60, 40}, 12.3F, 12}}, false);
  EXPECT_EQ(feature(plain.features(), "certainty of that shift"), 0);
}

TEST(BiasFeatures, ContinueAPlaneAcrossAHole) {
  Scene scene({{{40, 10, 60, 40}, 12, 12}});
  for (int y = 10; y < 50; ++y) {
    for (int x = 40; x < 100; ++x)
      scene.disparity.disparity_px(x, y) = x < 80 ? 12 + 0.02F * (static_cast<float>(x) - 69.5F) : kNan;
  }
  EXPECT_NEAR(feature(scene.features(), "plane of the disparities at the centroid, minus the median"), 0,
              0.01)
      << "of 12, in the middle";
}

TEST(BiasFeatures, AreFiniteForTheSmallestObjects) {
  for (const Rect rect :
       {Rect{0, 0, 1, 1}, Rect{159, 59, 1, 1}, Rect{0, 0, 160, 1}, Rect{0, 0, 1, 60}, Rect{0, 0, 160, 60}}) {
    Scene scene({{rect, 3, 3}});
    for (const float value : scene.features())
      EXPECT_TRUE(std::isfinite(value)) << text(Size{rect.width, rect.height});
    for (int y = 0; y < kSize.height; ++y) {
      for (int x = 0; x < kSize.width; ++x) {
        if (x != rect.x || y != rect.y) scene.disparity.disparity_px(x, y) = kNan;
      }
    }
    for (const float value : scene.features())
      EXPECT_TRUE(std::isfinite(value)) << text(Size{rect.width, rect.height});
  }
}

TEST(RefineObjects, NumbersTheNearestFirst) {
  // The matching saw the first one nearer.
  const Scene scene({{{20, 10, 50, 40}, 10.0F, 10.3F}, {{90, 10, 50, 40}, 10.6F, 10.2F}});
  const Objects refined = scene.refined();
  ASSERT_EQ(refined.list.size(), 2U);
  EXPECT_EQ(refined.list[0].box_px.x, 90);
  EXPECT_EQ(refined.list[1].box_px.x, 20);
  EXPECT_GT(refined.list[0].disparity_px, refined.list[1].disparity_px);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(refined.list[i].id, ObjectId{static_cast<std::int32_t>(i) + 1});
    EXPECT_EQ(refined.labels(refined.list[i].box_px.x, 30), refined.list[i].id);
  }
  EXPECT_EQ(refined.labels(0, 0), ObjectId::none);
}

TEST(RefineObjects, IsTheSameOnAnyNumberOfThreads) {
  const Scene scene(
      {{{5, 10, 40, 40}, 3.0F, 3.2F}, {{50, 10, 40, 40}, 9, 9.4F}, {{95, 10, 40, 40}, 20, 19.7F}});
  const Objects one = scene.refined(1, disparity_bias_trees());
  for (const int threads : {2, 3, 8}) {
    const Objects more = scene.refined(threads, disparity_bias_trees());
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(more.list[i].disparity_px, one.list[i].disparity_px);
  }
}

}  // namespace
}  // namespace cairn
