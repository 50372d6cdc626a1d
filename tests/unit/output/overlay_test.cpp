// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/core/image.hpp>
#include <cairn/output/overlay.hpp>
#include <cstdlib>
#include <limits>
#include <set>

namespace cairn::output {
namespace {

Objects one_object(Size size, Rect box) {
  Objects objects;
  objects.labels = Image<ObjectId>(size, ObjectId::none, {});
  for (int y = box.y; y < box.y + box.height; ++y) {
    for (int x = box.x; x < box.x + box.width; ++x) objects.labels(x, y) = ObjectId{1};
  }
  Object object;
  object.id = ObjectId{1};
  object.box_px = box;
  object.pixel_count = box.width * box.height;
  object.disparity_px = 12.5F;
  objects.list.push_back(object);
  return objects;
}

int distance(Rgb a, Rgb b) {
  return std::abs(a.r - b.r) + std::abs(a.g - b.g) + std::abs(a.b - b.b);
}

TEST(ObjectOverlay, IsTheLeftImageEnlargedByAnIntegerFactorIfSmall) {
  const Image<Gray> small({160, 120}, Gray{100}, {});
  const Image<Gray> large({1280, 960}, Gray{100}, {});
  EXPECT_EQ(draw_objects(small, {}, one_object({160, 120}, {10, 10, 60, 60}), {}).size(),
            (Size{640, 504}));  // a legend of 24 px
  EXPECT_EQ(draw_objects(large, {}, one_object({1280, 960}, {10, 10, 60, 60}), {}).size(), (Size{1280, 984}));
}

TEST(ObjectOverlay, TintsObjectsAndFloorOnGrey) {
  const Size size{640, 480};
  const Image<Gray> left(size, Gray{120}, {});
  Image<std::uint8_t> floor(size, 0, {});
  for (int y = 400; y < 480; ++y) std::fill_n(floor.row(y), size.width, std::uint8_t{255});
  const Image<Rgb> picture = draw_objects(left, {}, one_object(size, {100, 100, 200, 200}), floor);
  const Rgb background = picture(10, 10);
  EXPECT_EQ(background.r, background.g);
  EXPECT_EQ(background.g, background.b);
  EXPECT_GT(distance(picture(120, 120), background), 60);  // in the object, away from its label
  EXPECT_GT(distance(picture(10, 450), background), 10);
  EXPECT_LT(distance(picture(10, 450), background), distance(picture(120, 120), background));
}

TEST(ObjectOverlay, BrightensADimSceneAndNoOther) {
  const Size size{640, 480};
  const auto background = [&](Gray level) {
    const Image<Gray> left(size, level, {});
    return draw_objects(left, {}, one_object(size, {100, 100, 200, 200}), {})(10, 10).g;
  };
  EXPECT_EQ(background(220), 165);  // a quarter darker, like everything outside objects
  EXPECT_EQ(background(25), 150);   // previously brightened eightfold
  EXPECT_EQ(background(5), 30);     // the maximum
  EXPECT_EQ(background(0), 0);
}

TEST(ObjectOverlay, HasALegendBelow) {
  const Size size{640, 480};
  const Objects objects = one_object(size, {100, 100, 200, 200});
  const Image<std::uint8_t> floor(size, 255, {});
  const Image<Gray> left(size, Gray{120}, {});
  const auto chips = [&](const Image<Rgb>& picture) {
    std::set<std::array<std::uint8_t, 3>> colours;
    for (int x = 0; x < picture.width(); ++x) {
      const Rgb c = picture(x, picture.height() - 12);
      colours.insert({c.r, c.g, c.b});
    }
    return colours;
  };
  const Rgb object = object_colour(ObjectId{1});
  const auto with_floor = chips(draw_objects(left, {}, objects, floor));
  EXPECT_EQ(with_floor.count({object.r, object.g, object.b}), 1U);
  EXPECT_EQ(with_floor.count({90, 150, 190}), 1U);
  EXPECT_EQ(chips(draw_objects(left, {}, objects, {})).count({90, 150, 190}), 0U);
}

TEST(ObjectOverlay, MarksStepsOfTheGround) {
  const Size size{640, 480};
  const Image<Gray> left(size, Gray{120}, {});
  Objects none;
  none.labels = Image<ObjectId>(size, ObjectId::none, {});
  // A camera 1 m above the floor that looks ahead; a kerb 2 m ahead, from 1 m to the left to 1 m to the right.
  const FloorFrame floor{{0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, 1};
  const StereoRig rig{.focal_px = 200, .cx_px = 320, .cy_px = 200, .baseline_m = 0.1F};
  const std::vector<DrawnStep> steps = drawn_steps({{{2, 1, 0}, {2, -1, 0}, 0.12F}}, floor, rig);
  ASSERT_EQ(steps.size(), 1U);
  EXPECT_FLOAT_EQ(steps[0].from_x, 220);
  EXPECT_FLOAT_EQ(steps[0].to_x, 420);
  EXPECT_FLOAT_EQ(steps[0].from_y, 300);
  EXPECT_FLOAT_EQ(steps[0].to_y, 300);
  EXPECT_EQ(steps[0].height_m, 0.12F);
  const Image<Rgb> with = draw_objects(left, {}, none, {}, steps);
  const Image<Rgb> without = draw_objects(left, {}, none, {});
  EXPECT_GT(distance(with(230, 300), without(230, 300)), 60);
  EXPECT_EQ(distance(with(230, 290), without(230, 290)), 0);
  EXPECT_EQ(distance(with(210, 300), without(210, 300)), 0);
  int changed_by_label = 0;
  for (int y = 285; y < 315; ++y) changed_by_label += distance(with(315, y), without(315, y)) > 0 ? 1 : 0;
  EXPECT_GT(changed_by_label, 4);
  int changed_in_legend = 0;
  for (int x = 0; x < size.width; ++x)
    changed_in_legend += with(x, size.height + 12) == without(x, size.height + 12) ? 0 : 1;
  EXPECT_GT(changed_in_legend, 10);
}

TEST(ObjectOverlay, LabelsEachObject) {
  const Size size{640, 480};
  const Image<Gray> left(size, Gray{120}, {});
  const Image<Rgb> picture = draw_objects(left, {}, one_object(size, {100, 100, 200, 200}), {});
  int white = 0;
  for (int y = 180; y < 220; ++y) {
    for (int x = 150; x < 250; ++x) white += distance(picture(x, y), {255, 255, 255}) < 150 ? 1 : 0;
  }
  EXPECT_GT(white, 20);
}

bool overlap(const Rect& a, const Rect& b) {
  return a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height;
}

TEST(LabelPlaces, OfAdjacentObjectsDoNotOverlap) {
  const Size picture{640, 480};
  std::vector<Rect> wanted;
  for (int i = 0; i < 6; ++i) wanted.push_back({300 + 12 * i, 200 + 2 * (i % 2), 60, 14});  // poles
  for (int i = 0; i < 4; ++i) wanted.push_back({620 + i, -5 + i, 60, 14});                  // a corner
  const std::vector<Rect> places = place_labels(wanted, picture);
  ASSERT_EQ(places.size(), wanted.size());
  EXPECT_EQ(places[0].x, wanted[0].x);  // the first stays
  EXPECT_EQ(places[0].y, wanted[0].y);
  for (std::size_t i = 0; i < places.size(); ++i) {
    EXPECT_GE(places[i].x, 0);
    EXPECT_GE(places[i].y, 0);
    EXPECT_LE(places[i].x + places[i].width, picture.width);
    EXPECT_LE(places[i].y + places[i].height, picture.height);
    for (std::size_t k = 0; k < i; ++k) EXPECT_FALSE(overlap(places[i], places[k])) << i << " " << k;
  }
}

TEST(LabelPlaces, ArePreferredIfNothingCollidesOrNothingIsFree) {
  const std::vector<Rect> apart{{10, 10, 50, 14}, {10, 100, 50, 14}};
  const auto same = place_labels(apart, {640, 480});
  for (std::size_t i = 0; i < apart.size(); ++i) EXPECT_EQ(same[i].y, apart[i].y);
  const auto crowded = place_labels({{0, 0, 50, 14}, {0, 0, 50, 14}}, {50, 14});
  EXPECT_EQ(crowded[1].x, 0);
  EXPECT_EQ(crowded[1].y, 0);
}

TEST(ObjectOverlay, AcceptsObjectsAtTheBorderAndImagesOfOnePixel) {
  const Image<Gray> left({1, 1}, Gray{0}, {});
  const Image<std::uint8_t> floor({1, 1}, 255, {});
  EXPECT_FALSE(draw_objects(left, {}, one_object({1, 1}, {0, 0, 1, 1}), floor).empty());
  const Image<Gray> strip({700, 2}, Gray{0}, {});
  EXPECT_FALSE(draw_objects(strip, {}, one_object({700, 2}, {699, 0, 1, 2}), {}).empty());
}

TEST(ObjectColours, OfTheFirstObjectsAreFarApart) {
  for (int a = 1; a <= 8; ++a) {
    for (int b = a + 1; b <= 8; ++b)
      EXPECT_GT(distance(object_colour(ObjectId{a}), object_colour(ObjectId{b})), 60);
  }
}

DisparityMap map_of(Size size, float disparity) {
  return {Image<float>(size, disparity, {}), Image<Reject>(size, Reject::none, {})};
}

TEST(DisparityView, ShowsEveryReasonInItsOwnColour) {
  DisparityMap map = map_of({640, 480}, 20);
  int x = 0;
  std::set<std::array<std::uint8_t, 3>> colours;
  for (const auto& reason : kRejects) {
    map.reject(x, 0) = reason.value;
    map.disparity_px(x, 0) = std::numeric_limits<float>::quiet_NaN();
    ++x;
  }
  const Image<Rgb> picture = draw_disparity(map, std::nullopt);
  for (int i = 0; i <= x; ++i) colours.insert({picture(i, 0).r, picture(i, 0).g, picture(i, 0).b});
  EXPECT_EQ(colours.size(), kRejects.size() + 1);  // and that of a disparity
}

TEST(DisparityView, HasALegendNextToTheImage) {
  const DisparityMap map = map_of({640, 480}, 20);
  const Image<Rgb> picture = draw_disparity(map, StereoRig{500, 320, 240, 0.1F, 0});
  ASSERT_GT(picture.width(), 640);
  EXPECT_EQ(picture.height(), 480);
  int bright = 0;
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 640; x < picture.width(); ++x) bright += picture(x, y).g > 180 ? 1 : 0;
  }
  EXPECT_GT(bright, 200);
}

TEST(DisparityView, ListsOnlyTheReasonsInForce) {
  DisparityMap map = map_of({640, 480}, 20);
  const auto has_colour = [&](Rgb colour, Reject in_force) {
    const Image<Rgb> picture = draw_disparity(map, std::nullopt, in_force);
    for (int y = 0; y < picture.height(); ++y) {
      for (int x = 640; x < picture.width(); ++x)
        if (picture(x, y) == colour) return true;
    }
    return false;
  };
  const auto flat = std::find_if(kReasons.begin(), kReasons.end(),
                                 [](const Reason& reason) { return reason.bit == Reject::flat; });
  EXPECT_TRUE(has_colour(flat->colour, Reject::flat | Reject::speckle));
  EXPECT_FALSE(has_colour(flat->colour, Reject::speckle));
  map.reject(3, 3) = Reject::flat;  // from an older result, whichever checks are in force now
  EXPECT_TRUE(has_colour(flat->colour, Reject::speckle));
}

TEST(DisparityView, AcceptsOnlyHolesAndOnePixel) {
  DisparityMap map = map_of({1, 1}, std::numeric_limits<float>::quiet_NaN());
  map.reject(0, 0) = Reject::border | Reject::no_texture;
  EXPECT_FALSE(draw_disparity(map, std::nullopt).empty());
}

}  // namespace
}  // namespace cairn::output
