// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/core/image.hpp>
#include <cairn/evaluation/object_error.hpp>
#include <cmath>
#include <limits>

namespace cairn {
namespace {

constexpr Size kSize{100, 80};

template <class Id>
void paint(Image<Id>& image, Rect box, Id id) {
  for (int y = box.y; y < box.y + box.height; ++y) {
    for (int x = box.x; x < box.x + box.width; ++x) image(x, y) = id;
  }
}

/// An image of our ids and one of true ids, initially empty.
struct Scene {
  Image<ObjectId> ours{kSize, ObjectId::none, {}};
  Image<TruthId> truth{kSize, TruthId::none, {}};

  void found(int id, Rect box) { paint(ours, box, ObjectId{id}); }
  void real(int id, Rect box) { paint(truth, box, TruthId{id}); }
  [[nodiscard]] ObjectErrors score(ObjectErrorConfig config = {}) const {
    return object_errors(ours, truth, config);
  }
};

/// The paper's Equation (5), on areas in px.
double segmentation_error(double truth, double ours, double both) {
  return (truth + ours - 2 * both) / both;
}

TEST(TrueObjectScore, HasTheErrorOfEquationFiveForEveryOverlap) {
  for (int both = 1; both <= 60; ++both) {
    const TrueObjectScore score{.iou = both / (90.0 + 60.0 - both)};
    EXPECT_NEAR(score.error(), segmentation_error(90, 60, both), 1e-12) << both;
  }
  EXPECT_EQ(TrueObjectScore{.iou = 0}.error(), std::numeric_limits<double>::infinity());
}

TEST(ObjectErrors, APerfectResultHasNoErrorAnywhere) {
  Scene scene;
  scene.real(7, {10, 10, 30, 20});
  scene.found(1, {10, 10, 30, 20});
  const ObjectErrors errors = scene.score();
  ASSERT_EQ(errors.truth.size(), 1U);
  EXPECT_EQ(errors.truth[0].id, TruthId{7});
  EXPECT_EQ(errors.truth[0].found, ObjectId{1});
  EXPECT_DOUBLE_EQ(errors.truth[0].iou, 1.0);
  EXPECT_DOUBLE_EQ(errors.truth[0].error(), 0.0);
  EXPECT_DOUBLE_EQ(errors.truth[0].boundary_f, 1.0);
  ASSERT_EQ(errors.ours.size(), 1U);
  EXPECT_FALSE(errors.ours[0].phantom);
  EXPECT_DOUBLE_EQ(errors.ours[0].share_on_objects, 1.0);
}

TEST(ObjectErrors, AgreeWithEquationFiveOnCountedAreas) {
  Scene scene;
  scene.real(1, {10, 10, 30, 20});   // 600 px
  scene.found(4, {20, 10, 40, 20});  // 800 px, 400 in common
  const ObjectErrors errors = scene.score();
  EXPECT_DOUBLE_EQ(errors.truth[0].error(), segmentation_error(600, 800, 400));
  EXPECT_DOUBLE_EQ(errors.truth[0].error(), 1.5);
}

TEST(ObjectErrors, ATrueObjectIsComparedByIouNotByOverlap) {
  Scene scene;
  scene.real(1, {10, 10, 20, 20});
  scene.found(1, {10, 10, 20, 12});  // 240 of its 400 px and no others
  scene.found(2, {0, 22, 100, 58});  // 160 of its px and 5640 others
  EXPECT_EQ(scene.score().truth[0].found, ObjectId{1});
}

TEST(ObjectErrors, AMissedObjectHasInfiniteErrorThatCountsTwoHundredPercent) {
  Scene scene;
  scene.real(1, {10, 10, 30, 20});
  scene.found(1, {60, 50, 30, 20});
  const ObjectErrors errors = scene.score();
  EXPECT_EQ(errors.truth[0].found, ObjectId::none);
  EXPECT_TRUE(std::isinf(errors.truth[0].error()));
  EXPECT_DOUBLE_EQ(errors.truth[0].capped_error(), 2.0);
  EXPECT_DOUBLE_EQ(errors.truth[0].boundary_f, 0.0);
}

TEST(ObjectErrors, DoNotScoreTrueObjectsBelowTheMinimumArea) {
  Scene scene;
  scene.real(1, {0, 0, 10, 20});   // 200 px
  scene.real(2, {50, 0, 10, 19});  // 190 px
  ASSERT_EQ(scene.score().truth.size(), 1U);
  EXPECT_EQ(scene.score().truth[0].id, TruthId{1});
  EXPECT_EQ(scene.score({.min_area = 190}).truth.size(), 2U);
}

TEST(ObjectErrors, ExcludeDontCarePixelsFromAreas) {
  Scene scene;
  scene.real(1, {10, 10, 20, 20});
  scene.truth(10, 10) = TruthId::none;
  paint(scene.truth, {30, 10, 10, 20}, TruthId::dont_care);
  scene.found(1, {10, 10, 30, 20});  // 200 of its px are don't-care
  const ObjectErrors errors = scene.score();
  EXPECT_DOUBLE_EQ(errors.truth[0].iou, 399 / 400.0);
  EXPECT_EQ(errors.ours[0].pixel_count, 400);
  EXPECT_FALSE(errors.ours[0].mostly_dont_care);
}

TEST(ObjectErrors, ObjectsMostlyOnDontCareAreNeitherRightNorWrong) {
  Scene scene;
  paint(scene.truth, {0, 0, 60, 80}, TruthId::dont_care);
  scene.found(1, {40, 0, 30, 20});   // 400 px on don't-care, 200 outside
  scene.found(2, {50, 30, 30, 20});  // 200 px on don't-care, 400 outside
  scene.found(3, {0, 60, 20, 20});   // entirely on don't-care
  const ObjectErrors errors = scene.score();
  ASSERT_EQ(errors.ours.size(), 3U);
  EXPECT_TRUE(errors.ours[0].mostly_dont_care);
  EXPECT_FALSE(errors.ours[0].phantom);
  EXPECT_FALSE(errors.ours[1].mostly_dont_care);
  EXPECT_TRUE(errors.ours[1].phantom);
  EXPECT_TRUE(errors.ours[2].mostly_dont_care);
  EXPECT_EQ(summarise({{scene.score(), false}}).our_objects, 1);
}

TEST(ObjectErrors, APhantomHasTwoHundredPixelsAndLessThanAQuarterOfThemOnTrueObjects) {
  Scene scene;
  scene.real(1, {0, 0, 20, 20});
  scene.real(2, {0, 20, 20, 20});
  scene.found(1, {15, 0, 20, 40});  // 200 of 800 px on true objects, half of them on each: exactly a quarter
  scene.found(2, {50, 0, 10, 20});  // 200 px on no object
  scene.found(3, {70, 0, 10, 19});  // 190 px on no object: too small to matter
  scene.found(4, {0, 35, 15, 60 - 35});  // 75 of 375 px: less than a quarter
  const ObjectErrors errors = scene.score();
  EXPECT_FALSE(errors.ours[0].phantom);
  EXPECT_TRUE(errors.ours[1].phantom);
  EXPECT_FALSE(errors.ours[2].phantom);
  EXPECT_TRUE(errors.ours[3].phantom);
}

TEST(ObjectErrors, HalvesOverSegmentAndACommonObjectUnderSegments) {
  Scene scene;
  scene.real(1, {0, 0, 40, 40});
  scene.real(2, {50, 0, 20, 40});
  scene.real(3, {70, 0, 20, 40});
  scene.found(1, {0, 0, 20, 40});
  scene.found(2, {20, 0, 20, 40});
  scene.found(3, {50, 0, 40, 40});
  const ObjectErrors errors = scene.score();
  EXPECT_TRUE(errors.truth[0].over_segmented);
  EXPECT_FALSE(errors.truth[0].under_segmented);
  EXPECT_FALSE(errors.truth[1].over_segmented);
  EXPECT_TRUE(errors.truth[1].under_segmented);
  EXPECT_TRUE(errors.truth[2].under_segmented);
}

TEST(ObjectErrors, StateTheBoundaryToleranceInPixels) {
  const Image<ObjectId> ours({320, 240}, ObjectId::none, {});
  const Image<TruthId> truth({320, 240}, TruthId::none, {});
  EXPECT_EQ(object_errors(ours, truth, {}).boundary_tolerance_px, 3);  // 0.75 % of 400
  EXPECT_EQ(object_errors(ours, truth, {.boundary_tolerance = 0}).boundary_tolerance_px, 1);
}

TEST(ObjectErrors, WorkOnAnImageOfOnePixel) {
  const Image<ObjectId> ours({1, 1}, ObjectId{1}, {});
  const Image<TruthId> truth({1, 1}, TruthId{1}, {});
  const ObjectErrors errors = object_errors(ours, truth, {.min_area = 1});
  ASSERT_EQ(errors.truth.size(), 1U);
  EXPECT_DOUBLE_EQ(errors.truth[0].iou, 1.0);
  EXPECT_DOUBLE_EQ(errors.truth[0].boundary_f, 1.0);
}

Image<std::uint8_t> mask(Rect box) {
  Image<std::uint8_t> image(kSize, 0, {});
  paint(image, box, std::uint8_t{1});
  return image;
}

TEST(BoundaryF, ForgivesAShiftUpToTheTolerance) {
  const Image<std::uint8_t> here = mask({20, 20, 30, 30});
  const Image<std::uint8_t> shifted = mask({23, 20, 30, 30});
  EXPECT_DOUBLE_EQ(boundary_f(here, shifted, {}, 3), 1.0);
  EXPECT_LT(boundary_f(here, shifted, {}, 2), 1.0);
  EXPECT_GT(boundary_f(here, shifted, {}, 2), 0.5);  // the horizontal sides still agree
}

TEST(BoundaryF, IsTheHarmonicMeanOfPrecisionAndRecall) {
  const Image<std::uint8_t> one = mask({20, 20, 10, 10});
  Image<std::uint8_t> two = mask({20, 20, 10, 10});
  paint(two, {60, 20, 10, 10}, std::uint8_t{1});
  EXPECT_DOUBLE_EQ(boundary_f(one, two, {}, 2), 2 * 0.5 * 1.0 / 1.5);
  EXPECT_DOUBLE_EQ(boundary_f(two, one, {}, 2), boundary_f(one, two, {}, 2));
}

TEST(BoundaryF, UsesEuclideanDistance) {
  const Image<std::uint8_t> a = mask({20, 20, 1, 1});
  const Image<std::uint8_t> b = mask({23, 24, 1, 1});  // 5 px away
  EXPECT_DOUBLE_EQ(boundary_f(a, b, {}, 5), 1.0);
  EXPECT_DOUBLE_EQ(boundary_f(a, b, {}, 4), 0.0);
}

TEST(BoundaryF, DoesNotCountTheImageBorderOrDontCareAsBoundary) {
  const Image<std::uint8_t> all = mask({0, 0, kSize.width, kSize.height});
  const Image<std::uint8_t> none = mask({});
  EXPECT_DOUBLE_EQ(boundary_f(all, none, {}, 2), 1.0);  // neither has a boundary
  const Image<std::uint8_t> left = mask({0, 0, 50, kSize.height});
  EXPECT_DOUBLE_EQ(boundary_f(all, left, {}, 2), 0.0);
  const Image<std::uint8_t> right_is_unknown = mask({50, 0, 50, kSize.height});
  EXPECT_DOUBLE_EQ(boundary_f(all, left, right_is_unknown, 2), 1.0);
}

TEST(Summary, CountsAndAveragesOverTheObjectsOfAllFrames) {
  Scene good;
  good.real(1, {0, 0, 20, 20});
  good.found(1, {0, 0, 20, 20});
  Scene half;
  half.real(1, {0, 0, 20, 20});
  half.found(1, {0, 0, 20, 12});   // IoU 0.6
  half.found(2, {60, 0, 20, 20});  // a phantom
  Scene missed;
  missed.real(1, {0, 0, 20, 20});
  const ObjectSummary sum =
      summarise({{good.score(), false}, {half.score(), false}, {missed.score(), false}});
  EXPECT_EQ(sum.frames, 3);
  EXPECT_EQ(sum.true_objects, 3);
  EXPECT_DOUBLE_EQ(sum.recall_50(), 2 / 3.0);
  EXPECT_DOUBLE_EQ(sum.recall_75(), 1 / 3.0);
  EXPECT_EQ(sum.missed, 1);
  EXPECT_DOUBLE_EQ(sum.precision_50(), 2 / 3.0);
  EXPECT_DOUBLE_EQ(sum.precision_75(), 1 / 3.0);
  EXPECT_DOUBLE_EQ(sum.phantoms_per_frame(), 1 / 3.0);
  const double e = 400 / 240.0 - 1;
  EXPECT_NEAR(sum.mean_error, (0 + e + 2) / 3, 1e-12);
  EXPECT_NEAR(sum.median_error, e, 1e-12);
  EXPECT_NEAR(sum.mean_iou, (1 + 0.6 + 0) / 3, 1e-12);
}

TEST(Summary, OfAFrameWithPartialTruthJudgesNoneOfOurs) {
  Scene scene;
  scene.real(1, {0, 0, 20, 20});
  scene.found(1, {60, 0, 20, 20});
  const ObjectSummary sum = summarise({{scene.score(), true}});
  EXPECT_EQ(sum.true_objects, 1);
  EXPECT_EQ(sum.complete_frames, 0);
  EXPECT_EQ(sum.our_objects, 0);
  EXPECT_TRUE(std::isnan(sum.precision_50()));
  EXPECT_TRUE(std::isnan(sum.phantoms_per_frame()));
}

TEST(Summary, OfNoObjectsIsNaN) {
  const ObjectSummary sum = summarise({});
  EXPECT_TRUE(std::isnan(sum.mean_error));
  EXPECT_TRUE(std::isnan(sum.median_error));
  EXPECT_TRUE(std::isnan(sum.recall_50()));
}

TEST(Median, IsTheMiddleOrTheMeanOfTheTwoMiddleValues) {
  EXPECT_DOUBLE_EQ(median({3, 1, 2}), 2);
  EXPECT_DOUBLE_EQ(median({4, 1, 3, 2}), 2.5);
  EXPECT_TRUE(std::isnan(median({})));
}

// The paper's own table, which gives no mean: it is 19.5, the median 11.6.
TEST(Median, OfThePapersTableIsAsReported) {
  const std::vector<double> errors{24.97, 5.04, 11.64, 7.36, 13.34, 7.92, 18.78, 74.74, 41.83, 4.11, 4.94};
  EXPECT_NEAR(median(errors), 11.6, 0.05);
}

}  // namespace
}  // namespace cairn
