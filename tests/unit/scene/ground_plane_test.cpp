// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>
#include <cairn/core/error.hpp>
#include <cairn/scene/ground_plane.hpp>

#include <algorithm>
#include <bit>
#include <cairn/core/error.hpp>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "support/collection.hpp"
#include "support/grids.hpp"

namespace cairn {
namespace {

using grids::grid;
using grids::numbers;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

/// A room as seen by a matcher, 320×240: floor, wall, upright boxes and their mirror images in a glossy
/// floor.
struct Room {
  Size size{320, 240};
  std::optional<GroundPlane> floor = GroundPlane{0.0F, 0.12F, -8.0F};
  float wall_px = 6.0F;
  std::vector<Rect> boxes{};   // each with its lower edge on the floor
  bool mirror = false;         // the floor shows the boxes mirrored at its surface
  bool shown = true;           // the boxes themselves are visible
  float noise_px = 0.3F;       // standard deviation
  double density = 0.7;        // share of pixels with a match
  double floor_density = 1.0;  // of these, on the floor
  double wrong = 0.05;         // share of matches with a random value from 0 to 32 px
  std::uint32_t seed = 1;
};

DisparityMap matches_of(const Room& room) {
  std::mt19937 random(room.seed);
  const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0; };
  const auto normal = [&] {  // approximately
    double sum = -6;
    for (int i = 0; i < 12; ++i) sum += uniform();
    return static_cast<float>(sum);
  };
  DisparityMap map{Image<float>(room.size), Image<Reject>(room.size)};
  for (int y = 0; y < room.size.height; ++y) {
    for (int x = 0; x < room.size.width; ++x) {
      const float floor =
          room.floor ? room.floor->disparity_px(static_cast<float>(x), static_cast<float>(y)) : -1000.0F;
      float d = std::max(floor, room.wall_px);
      bool on_floor = floor >= room.wall_px;
      for (const Rect& box : room.boxes) {
        const int foot = box.y + box.height;
        const float near =
            room.floor ? room.floor->disparity_px(static_cast<float>(x), static_cast<float>(foot)) : 20.0F;
        if (x < box.x || x >= box.x + box.width) continue;
        const bool shown = room.shown && y >= box.y && y < foot;
        const bool mirrored = room.mirror && y >= foot && y < foot + box.height;
        if (!shown && !mirrored) continue;
        d = near;
        on_floor = false;
      }
      bool matched = uniform() < room.density;
      if (on_floor) matched = matched && uniform() < room.floor_density;
      if (uniform() < room.wrong) {
        d = static_cast<float>(32 * uniform());
      } else {
        d += room.noise_px * normal();
      }
      map.disparity_px(x, y) = matched ? d : kNaN;
      map.reject(x, y) = matched ? Reject::none : Reject::flat;
    }
  }
  return map;
}

Ground found_in(const Room& room, int threads = 1) {
  return fit_ground(matches_of(room), std::nullopt, {}, Exec::with_threads(threads));
}

/// The largest error of the found floor in the lower half of the image.
float error(const Ground& ground, const Room& room) {
  float largest = 0;
  for (const int y : {room.size.height / 2, room.size.height - 1}) {
    for (const int x : {0, room.size.width - 1}) {
      const auto fx = static_cast<float>(x);
      const auto fy = static_cast<float>(y);
      largest =
          std::max(largest, std::abs(ground.plane->disparity_px(fx, fy) - room.floor->disparity_px(fx, fy)));
    }
  }
  return largest;
}

const std::vector<Rect> kFurniture{{30, 60, 60, 120}, {140, 90, 40, 70}, {220, 40, 70, 170}};

#define EXPECT_FINDS(room, tolerance)                                                    \
  {                                                                                      \
    const Ground found = found_in(room);                                                 \
    ASSERT_TRUE(found.plane) << "refused: " << static_cast<int>(found.refusal);          \
    EXPECT_EQ(found.refusal, Refusal::none);                                             \
    EXPECT_LT(error(found, room), tolerance) << found.plane->a << " " << found.plane->b; \
  }

TEST(GroundAutomatic, FindsAFloorAmongNoiseAndFurniture) {
  for (std::uint32_t seed = 1; seed <= 5; ++seed) {
    const Room room{.boxes = kFurniture, .seed = seed};
    EXPECT_FINDS(room, 0.25F);
  }
}

TEST(GroundAutomatic, FindsAFloorThatMirrorsTheFurniture) {
  const Room room{.boxes = kFurniture, .mirror = true};
  EXPECT_FINDS(room, 0.3F);
}

/// A uniform glossy floor below a level camera, so that mirror images extend as far below the feet of the
/// boxes as the boxes extend above; `times` the usual size.
Room of_mirror_images(int times, std::uint32_t seed) {
  const float centre = (240.0F * static_cast<float>(times) - 1) / 2;
  return {.size = {320 * times, 240 * times},
          .floor = GroundPlane{0.0F, 0.12F, -0.12F * centre},
          .wall_px = -1000,
          .boxes = {{5 * times, 85 * times, 90 * times, 80 * times},
                    {165 * times, 80 * times, 90 * times, 80 * times}},
          .mirror = true,
          .floor_density = 0.2,
          .wrong = 0.02,
          .seed = seed};
}

TEST(GroundAutomatic, FindsAFloorThatShowsMoreMirrorImagesThanItself) {
  for (std::uint32_t seed = 1; seed <= 5; ++seed) EXPECT_FINDS(of_mirror_images(1, seed), 0.25F);
}

/// Random squares of 4 px; where the room shows mirror images, those of the boxes, or of nothing.
Image<Gray> image_of(const Room& room, bool is_mirrored) {
  std::mt19937 random(room.seed);
  Image<Gray> left(room.size);
  for (int y = 0; y < room.size.height; ++y) {
    for (int x = 0; x < room.size.width; ++x) {
      const bool is_first = x % 4 == 0 && y % 4 == 0;
      left(x, y) = is_first ? static_cast<Gray>(random() & 255U) : left(x / 4 * 4, y / 4 * 4);
    }
  }
  for (const Rect& box : room.boxes) {
    const int foot = box.y + box.height;
    for (int y = foot; is_mirrored && y < std::min(foot + box.height, room.size.height); ++y)
      std::copy_n(left.row(2 * foot - 1 - y) + box.x, box.width, left.row(y) + box.x);
  }
  return left;
}

TEST(GroundAutomatic, APlaneThatOnlyMirrorImagesSupportMustLookLikeAMirror) {
  for (std::uint32_t seed = 1; seed <= 5; ++seed) {
    const Room room = of_mirror_images(1, seed);
    const DisparityMap map = matches_of(room);
    const auto found = [&](bool is_mirrored) {
      const Image<Gray> left = image_of(room, is_mirrored);
      return fit_ground(map.disparity_px, std::nullopt, {}, {}, left);
    };
    const Ground mirror = found(true);
    ASSERT_TRUE(mirror.plane) << seed;
    EXPECT_LT(error(mirror, room), 0.25F) << seed;
    EXPECT_FALSE(found(false).plane) << seed;
  }
}

TEST(GroundAutomatic, FindsAMirroringFloorInALargeImageToo) {
  EXPECT_FINDS(of_mirror_images(3, 1), 0.25F);
}

TEST(GroundAutomatic, DoesNotExplainPointsBelowAPlaneByReflectionsOfUnseenObjects) {
  for (std::uint32_t seed = 1; seed <= 5; ++seed) {
    Room room = of_mirror_images(1, seed);
    room.shown = false;
    EXPECT_FALSE(found_in(room).plane) << seed;
  }
}

TEST(GroundAutomatic, FindsAFloorWithFewMatchesNextToALargeWall) {
  // Most hypotheses are on the wall; if it were tried repeatedly, no hypothesis would be left for the floor.
  for (std::uint32_t seed = 1; seed <= 5; ++seed) {
    const Room room{.wall_px = 5, .floor_density = 0.2, .wrong = 0.02, .seed = seed};
    EXPECT_FINDS(room, 0.5F);
  }
}

TEST(GroundAutomatic, FindsAFloorWithFewMatches) {
  // A tenth of its pixels; the foot of the wall, seven times as dense, biases the fit.
  const Room room{.boxes = kFurniture, .floor_density = 0.15, .wrong = 0.02};
  EXPECT_FINDS(room, 0.75F);
}

TEST(GroundAutomatic, FindsAFloorIfAThirdOfTheMatchesIsWrong) {
  const Room room{.wrong = 0.33};
  EXPECT_FINDS(room, 0.3F);
}

TEST(GroundAutomatic, FindsTheFloorOfARolledCamera) {
  for (const float a : {-0.04F, -0.02F, 0.015F, 0.03F}) {
    const Room room{.floor = GroundPlane{a, 0.12F, -8.0F - 160 * a}, .boxes = kFurniture};
    EXPECT_FINDS(room, 0.4F);
  }
}

TEST(GroundAutomatic, FindsATableSeenFromAbove) {
  const Room room{.size = {640, 480},
                  .floor = GroundPlane{0.0F, 0.057F, 91.3F},
                  .wall_px = 0,
                  .boxes = {{100, 200, 80, 60}},
                  .density = 0.04};
  EXPECT_FINDS(room, 0.5F);
}

TEST(GroundAutomatic, ABoxsLidIsNoFloorWhenThereIsOneBelow) {
  const GroundPlane floor{0.0F, 0.057F, 60.0F};
  DisparityMap map = matches_of({.floor = floor, .wall_px = 0});
  for (int y = 20; y < 210; ++y) {
    for (int x = 10; x < 310;
         ++x) {  // a parallel surface, a fifth nearer, with three quarters of all matches
      map.disparity_px(x, y) *= 1.2F;
    }
  }
  const Ground ground = fit_ground(map, std::nullopt, {}, {});
  ASSERT_TRUE(ground.plane);
  EXPECT_LT(error(ground, {.floor = floor}), 0.5F);
}

TEST(GroundAutomatic, ASlantedBoardWithMorePointsBehindThanOnItIsNoFloor) {
  DisparityMap map = matches_of({.floor = {}, .wall_px = 2, .wrong = 0.02});
  for (int y = 70; y < 200; ++y) {
    for (int x = 60; x < 270; ++x) map.disparity_px(x, y) += 6 + 0.08F * static_cast<float>(y);
  }
  const Ground ground = fit_ground(map, std::nullopt, {}, {});
  EXPECT_FALSE(ground.plane) << ground.plane->a << " " << ground.plane->b;
}

TEST(GroundAutomatic, SupportAndResidualAreThoseOfTheMatches) {
  const Ground ground = found_in({.wall_px = -100, .noise_px = 0.3F, .wrong = 0.2});
  // 80 % of all matches are on the floor; few of the wrong ones coincide with it.
  EXPECT_NEAR(ground.support, 0.8F, 0.05F);
  EXPECT_NEAR(ground.residual_px, 0.31F, 0.04F);
}

TEST(GroundAutomatic, WithoutMatchesThereIsNone) {
  const Ground none = found_in({.density = 0});
  EXPECT_EQ(none.refusal, Refusal::too_few_matches);
  EXPECT_FALSE(none.plane);
  EXPECT_EQ(found_in({.density = 0.003}).refusal, Refusal::too_few_matches);
}

TEST(GroundAutomatic, NoiseIsNoFloor) {
  for (std::uint32_t seed = 1; seed <= 5; ++seed) {
    EXPECT_EQ(found_in({.wrong = 1, .seed = seed}).refusal, Refusal::no_plane);
  }
}

TEST(GroundAutomatic, AWallIsNoFloor) {
  for (std::uint32_t seed = 1; seed <= 5; ++seed) {
    EXPECT_EQ(found_in({.floor = {}, .wall_px = 11, .seed = seed}).refusal, Refusal::implausible);
  }
}

/// A plane that fills the image as a floor does, seen from this height in baselines.
Room slope_at(float height, float tangent_of_roll = 0) {
  constexpr float kWidth = 320;  // the focal length without a calibration
  constexpr float kPitch = 0.7F;
  const float b = std::cos(kPitch) / height;
  const GroundPlane plane{tangent_of_roll * b, b,
                          kWidth * std::sin(kPitch) / height - 119.5F * b - tangent_of_roll * b * 159.5F};
  return {.floor = plane, .wall_px = -1000, .noise_px = 0.1F, .wrong = 0};
}

TEST(GroundAutomatic, IsNoneFarBelowTheCamera) {
  EXPECT_FINDS(slope_at(20), 0.25F);
  EXPECT_FINDS(slope_at(60), 0.25F);  // everything lies on it
  const Ground far = found_in(slope_at(150));
  EXPECT_FALSE(far.plane);
  EXPECT_EQ(far.refusal, Refusal::unlikely);
}

TEST(GroundAutomatic, FurnitureInFrontOfAWallIsNoFloor) {
  // Nearer objects are lower in the image, so a slanted plane fits across them.
  for (std::uint32_t seed = 1; seed <= 5; ++seed) {
    const Room room{
        .floor = GroundPlane{0.0F, 0.12F, -8.0F}, .boxes = kFurniture, .floor_density = 0, .seed = seed};
    EXPECT_FALSE(found_in(room).plane);
    const Room mirrored{.boxes = kFurniture, .mirror = true, .floor_density = 0, .seed = seed};
    EXPECT_FALSE(found_in(mirrored).plane);
  }
}

TEST(GroundAutomatic, ASlantedSideWallIsNoFloor) {
  DisparityMap map = matches_of({.floor = {}, .wall_px = 0, .wrong = 0.02});
  for (int y = 0; y < 240; ++y) {
    for (int x = 0; x < 320; ++x) map.disparity_px(x, y) += 4 + 0.08F * static_cast<float>(x);
  }
  const Ground ground = fit_ground(map, std::nullopt, {}, {});
  EXPECT_FALSE(ground.plane) << ground.plane->a << " " << ground.plane->b;
}

TEST(GroundAutomatic, AnyImageSizeIsSafe) {
  for (const Size size : {Size{1, 1}, Size{1, 400}, Size{400, 1}, Size{3, 7}, Size{17, 40}, Size{2, 20000}}) {
    for (const double density : {0.0, 0.1, 1.0}) {
      const Ground ground = found_in({.size = size, .density = density});
      EXPECT_EQ(ground.plane.has_value(), ground.refusal == Refusal::none);
    }
  }
}

TEST(GroundAutomatic, IsTheSameForAnyNumberOfThreads) {
  const Room room{.boxes = kFurniture, .mirror = true, .seed = 7};
  const Ground one = found_in(room, 1);
  for (const int threads : {2, 3}) {
    const Ground many = found_in(room, threads);
    EXPECT_EQ(std::bit_cast<std::uint32_t>(one.plane->a), std::bit_cast<std::uint32_t>(many.plane->a));
    EXPECT_EQ(std::bit_cast<std::uint32_t>(one.plane->b), std::bit_cast<std::uint32_t>(many.plane->b));
    EXPECT_EQ(std::bit_cast<std::uint32_t>(one.plane->c), std::bit_cast<std::uint32_t>(many.plane->c));
    EXPECT_EQ(one.support, many.support);
    EXPECT_EQ(one.residual_px, many.residual_px);
  }
}

TEST(GroundAutomatic, DisparitiesMayHaveAnotherOrigin) {
  // With doffs, infinity has disparity −doffs: the same room with every disparity 20 px smaller.
  const Room room{.boxes = kFurniture};
  DisparityMap map = matches_of(room);
  for (int y = 0; y < 240; ++y) {
    for (int x = 0; x < 320; ++x) map.disparity_px(x, y) -= 20;
  }
  const Ground ground = fit_ground(map, StereoRig{320, 159.5F, 119.5F, 0.1F, 20}, {}, {});
  ASSERT_TRUE(ground.plane);
  EXPECT_NEAR(ground.plane->b, 0.12F, 0.003F);
  EXPECT_NEAR(ground.plane->c, -28.0F, 0.4F);
}

GroundConfig pose(float height, float pitch, float roll) {
  GroundConfig config;
  config.source = GroundSource::pose;
  config.known = {{}, height, pitch, roll};
  return config;
}

TEST(GroundFromPose, ALevelCameraSeesTheHorizonAtItsCentre) {
  // Z of the floor in row y is focal·height/(y − cy), so d = baseline/height·(y − cy).
  const StereoRig rig{250, 160, 120, 0.2F, 3};
  const Ground ground = fit_ground(DisparityMap{}, rig, pose(0.5F, 0, 0), {});
  EXPECT_NEAR(ground.plane->a, 0, 1e-7);
  EXPECT_NEAR(ground.plane->b, 0.4F, 1e-6);
  EXPECT_NEAR(ground.plane->c, -0.4F * 120 - 3, 1e-4);
}

TEST(GroundFromPose, LookingDownRaisesTheHorizon) {
  // At 45 degrees the optical axis meets the floor at depth height·√2: d = focal·baseline/(height·√2) at the
  // centre.
  const StereoRig rig{250, 160, 120, 0.2F, 0};
  const Ground ground = fit_ground(DisparityMap{}, rig, pose(0.5F, 45, 0), {});
  EXPECT_NEAR(ground.plane->disparity_px(160, 120), 250 * 0.2F / (0.5F * std::sqrt(2.0F)), 1e-3);
}

TEST(GroundFromPose, WhenTheRightSideIsLowerTheFloorIsNearerThere) {
  const StereoRig rig{250, 160, 120, 0.2F, 0};
  const Ground ground = fit_ground(DisparityMap{}, rig, pose(0.5F, 0, 10), {});
  EXPECT_NEAR(ground.plane->a / ground.plane->b, std::tan(10 * 3.14159265F / 180), 1e-5);
}

TEST(GroundFromPose, NeedsACalibration) {
  const Ground ground = fit_ground(DisparityMap{}, std::nullopt, pose(1, 0, 0), {});
  EXPECT_EQ(ground.refusal, Refusal::no_rig);
  EXPECT_FALSE(ground.plane);
  EXPECT_THROW(validate(pose(1, 0, 0), false), Error);
  EXPECT_NO_THROW(validate(pose(1, 0, 0), true));
}

TEST(GroundFromPose, NeedsAHeight) {
  GroundConfig config = pose(1, 0, 0);
  config.known.camera_height_m.reset();
  EXPECT_THROW(validate(config, true), Error);
  EXPECT_THROW(validate(pose(0, 0, 0), true), Error);
  EXPECT_THROW(validate(pose(-1, 0, 0), true), Error);
  EXPECT_THROW(validate(pose(1, 90, 0), true), Error);
  EXPECT_THROW(validate(pose(1, 0, std::numeric_limits<float>::quiet_NaN()), true), Error);
  const StereoRig rig{250, 160, 120, 0.2F, 0};
  EXPECT_FALSE(fit_ground(DisparityMap{}, rig, config, {}).plane);
}

/// The truth of a rendered frame, if the data is available.
std::filesystem::path rendered(const std::string& frame) {
  return collection() / "rendered" / "dev" / frame;
}

std::vector<std::vector<double>> numbers_in(const std::filesystem::path& file) {
  std::vector<std::vector<double>> rows;
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::replace(line.begin(), line.end(), '=', ' ');
    std::istringstream words(line);
    rows.emplace_back();
    for (std::string word; words >> word;) {
      if (std::isalpha(static_cast<unsigned char>(word[0])) == 0) rows.back().push_back(std::stod(word));
    }
  }
  return rows;
}

TEST(GroundFromPose, AgreesWithARenderedCamera) {
  for (const char* frame : {"320x240/dev_s04", "640x480/dev_s11"}) {
    if (!std::filesystem::exists(rendered(frame))) GTEST_SKIP() << "no data at " << rendered(frame);
    const auto truth = numbers_in(rendered(frame) / "ground.txt").back();
    const auto camera_to_world = numbers_in(rendered(frame) / "pose.txt");
    const auto calib = numbers_in(rendered(frame) / "calib.txt");  // fx, fy, cx, cy, baseline
    const StereoRig rig{static_cast<float>(calib[0][0]), static_cast<float>(calib[2][0]),
                        static_cast<float>(calib[3][0]), static_cast<float>(calib[4][0]), 0};
    // World z is up, so its row, negated, is the direction of gravity in the camera's frame.
    constexpr double kDegrees = 180 / 3.14159265358979;
    const auto& up = camera_to_world[2];
    const auto config = pose(static_cast<float>(up[3]), static_cast<float>(std::asin(-up[2]) * kDegrees),
                             static_cast<float>(std::atan2(-up[0], -up[1]) * kDegrees));
    const Ground ground = fit_ground(DisparityMap{}, rig, config, {});
    EXPECT_NEAR(ground.plane->a, truth[0], 1e-5) << frame;
    EXPECT_NEAR(ground.plane->b, truth[1], 1e-5) << frame;
    EXPECT_NEAR(ground.plane->c, truth[2], 5e-3) << frame;
  }
}

TEST(LikelyGround, IsTheFittedGroundIfThereIsOne) {
  const DisparityMap map = matches_of({.boxes = kFurniture});
  const Ground given{GroundPlane{0.1F, 0.2F, 3}, 0.4F, 0.5F, Refusal::none};
  for (const GroundSource source : {GroundSource::automatic, GroundSource::points}) {
    GroundConfig config;
    config.source = source;
    const Ground likely = likely_ground(given, map, std::nullopt, config, {});
    ASSERT_TRUE(likely.plane);
    EXPECT_EQ(likely.plane->b, 0.2F);
    EXPECT_EQ(likely.support, 0.4F);
  }
}

TEST(LikelyGround, UsesAllDisparitiesIfTooFewAreTextured) {
  const Room room{.boxes = kFurniture};
  const DisparityMap map = matches_of(room);
  const Image<float> nothing(room.size, kNaN, {});
  const Ground refused = fit_ground(nothing, std::nullopt, {}, {});
  ASSERT_EQ(refused.refusal, Refusal::too_few_matches);
  const Ground likely = likely_ground(refused, map, std::nullopt, {}, {});
  ASSERT_TRUE(likely.plane);
  EXPECT_LT(error(likely, room), 0.25F);
}

TEST(LikelyGround, IsNoneWhereTexturedDisparitiesShowItToBeUpright) {
  // A wall with little texture, across which smooth matching draws a slope.
  DisparityMap slope{Image<float>({320, 240}), Image<Reject>({320, 240}, Reject::none, {})};
  for (int y = 0; y < 240; ++y)
    std::fill_n(slope.disparity_px.row(y), 320, 6 + 0.01F * static_cast<float>(y));
  const Image<float> wall({320, 240}, 7.2F, {});
  const Ground refused{{}, 0, 0, Refusal::too_few_matches};
  EXPECT_TRUE(likely_ground(refused, slope, std::nullopt, {}, {}).plane);
  EXPECT_TRUE(likely_ground(refused, slope, std::nullopt, {}, {}, slope.disparity_px).plane);
  EXPECT_EQ(likely_ground(refused, slope, std::nullopt, {}, {}, wall).refusal, Refusal::implausible);
}

TEST(LikelyGround, ToleratesTexturedDisparitiesThatTheSearchDoesNotSample) {
  // So many that the search takes every third column, which has none.
  const Size size{320, 240};
  Image<float> textured(size, 7.0F, {});
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      if (x % 3 == 0 || (x + y) % 7 < 2) textured(x, y) = std::numeric_limits<float>::quiet_NaN();
    }
  }
  const DisparityMap wall{Image<float>(size, 7.0F, {}), Image<Reject>(size, Reject::none, {})};
  const Image<Gray> left(size, Gray{100}, {});
  const Ground refused{{}, 0, 0, Refusal::too_few_matches};
  EXPECT_FALSE(likely_ground(refused, wall, std::nullopt, {}, {}, textured, left).plane);
}

TEST(LikelyGround, IsNoneIfDisabledOrInvisible) {
  const DisparityMap floor = matches_of({.boxes = kFurniture});
  const Ground off{{}, 0, 0, Refusal::off};
  GroundConfig config;
  config.source = GroundSource::off;
  EXPECT_EQ(likely_ground(off, floor, std::nullopt, config, {}).refusal, Refusal::off);
  const DisparityMap wall = matches_of({.floor = {}, .wall_px = 11});
  const Ground refused{{}, 0, 0, Refusal::too_few_matches};
  const Ground likely = likely_ground(refused, wall, std::nullopt, {}, {});
  EXPECT_FALSE(likely.plane);
  EXPECT_EQ(likely.refusal, Refusal::implausible);
}

TEST(GroundSourceOff, SaysSo) {
  GroundConfig config;
  config.source = GroundSource::off;
  EXPECT_EQ(fit_ground(DisparityMap{}, std::nullopt, config, {}).refusal, Refusal::off);
}

TEST(GroundSourcePoints, NeedsNoDisparity) {
  GroundConfig config;
  config.source = GroundSource::points;
  config.known.points = {{0, 0, 0, 0}, {100, 0, 100, 0}, {0, 100, -10, 100}, {100, 100, 90, 100}};
  const Ground ground = fit_ground(DisparityMap{}, std::nullopt, config, {});
  EXPECT_NEAR(ground.plane->b, 0.1F, 1e-6);
}

constexpr Ground kFloorFromRow2{GroundPlane{0, 2, -4}, 1, 0,
                                Refusal::none};  // d = 0 in row 2, 2 in row 3, 4 in row 4

DisparityMap column(std::initializer_list<std::initializer_list<float>> rows) {
  DisparityMap map{grid<float, float>(rows), {}};
  map.reject = Image<Reject>(map.disparity_px.size(), Reject::none, {});
  return map;
}

TEST(BelowGround, RejectsMatchesBeyondTheFloorByMoreThanTheMargin) {
  const auto map = reject_below_ground(column({{-9}, {-9}, {-9}, {1}, {2.9F}}), kFloorFromRow2, {}, {}, {});
  EXPECT_EQ(numbers(map.reject), (std::vector<std::vector<std::int64_t>>{{0}, {0}, {0}, {0}, {32}}));
  EXPECT_TRUE(std::isnan(map.disparity_px(0, 4)));
  EXPECT_EQ(map.disparity_px(0, 3), 1.0F);
}

TEST(BelowGround, TheHorizonIsWhereTheFloorIsAtInfinity) {
  const StereoRig rig{100, 0, 0, 0.1F,
                      3};  // infinity has disparity −3: the horizon moves up by more than a row
  const auto map = reject_below_ground(column({{-9}, {-9}, {-9}, {1}, {4}}), kFloorFromRow2, rig, {}, {});
  EXPECT_EQ(numbers(map.reject), (std::vector<std::vector<std::int64_t>>{{0}, {32}, {32}, {0}, {0}}));
}

/// A table top in the lower part of the image, and beyond its edge a floor, which is `rough` from pixel to
/// pixel, down to the row `edge`.
DisparityMap table_before_a_floor(int edge, float rough_px) {
  const Size size{160, 120};
  DisparityMap map{Image<float>(size), Image<Reject>(size, Reject::none, {})};
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const float table = 0.2F * static_cast<float>(y) + 4;
      const float rough = (x + y) % 2 == 0 ? rough_px : -rough_px;
      map.disparity_px(x, y) = y < edge ? 0.4F * table + rough : table;
    }
  }
  return map;
}

int below_ground(const DisparityMap& table) {
  const Ground ground{GroundPlane{0, 0.2F, 4}, 1, 0, Refusal::none};
  const DisparityMap map =
      reject_below_ground({table.disparity_px.clone(), table.reject.clone()}, ground, {}, {}, {});
  int count = 0;
  for (int y = 0; y < map.reject.height(); ++y) {
    for (int x = 0; x < map.reject.width(); ++x) count += has(map.reject(x, y), Reject::below_ground) ? 1 : 0;
  }
  return count;
}

TEST(BelowGround, KeepsASurfaceSeenPastTheEdge) {
  EXPECT_EQ(below_ground(table_before_a_floor(40, 0)), 0);
  EXPECT_EQ(below_ground(table_before_a_floor(40, 0.05F)), 0);
}

TEST(BelowGround, RejectsTooRoughSurfaces) {
  EXPECT_EQ(below_ground(table_before_a_floor(40, 0.15F)), 40 * 160);
}

TEST(BelowGround, KeepsALevelSurfaceNearerThanTwiceTheFloor) {
  // A road behind the edge of a pavement: a share of the floor's disparity, with steps of more than 0.2 px.
  const auto steep = [](float share) {
    const Size size{160, 120};
    DisparityMap map{Image<float>(size), Image<Reject>(size, Reject::none, {})};
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x)
        map.disparity_px(x, y) = (y < 40 ? share : 1) * (0.6F * static_cast<float>(y) + 9);
    }
    const Ground ground{GroundPlane{0, 0.6F, 9}, 1, 0, Refusal::none};
    const DisparityMap judged = reject_below_ground(std::move(map), ground, {}, {}, {});
    int count = 0;
    for (int x = 0; x < size.width; ++x) count += has(judged.reject(x, 20), Reject::below_ground) ? 1 : 0;
    return count;
  };
  EXPECT_EQ(steep(0.85F), 0);
  EXPECT_EQ(steep(0.55F), 0);
  EXPECT_EQ(steep(0.45F), 160);
}

TEST(BelowGround, RejectsTooSmallSurfaces) {
  EXPECT_EQ(below_ground(table_before_a_floor(2, 0)), 2 * 160);  // of the 384 px that 2 % are
  EXPECT_EQ(below_ground(table_before_a_floor(3, 0)), 0);
}

TEST(BelowGround, WithoutGroundNothingHappens) {
  const auto map = reject_below_ground(column({{-9}, {1}}), Ground{}, {}, {}, {});
  EXPECT_EQ(numbers(map.reject), (std::vector<std::vector<std::int64_t>>{{0}, {0}}));
}

TEST(FloorUnderReflections, IsTheFloorWhereMatchesWereBelowIt) {
  const auto map = reject_below_ground(column({{-9}, {-9}, {-9}, {1}, {2.9F}}), kFloorFromRow2, {}, {}, {});
  const Image<float> seen = floor_under_reflections(map, kFloorFromRow2, {});
  for (int y = 0; y < 5; ++y) {
    const bool mirrored = has(map.reject(0, y), Reject::below_ground);
    EXPECT_EQ(mirrored, y == 4);
    if (mirrored) {
      EXPECT_EQ(seen(0, y), kFloorFromRow2.plane->disparity_px(0, static_cast<float>(y)));
    } else {
      EXPECT_EQ(seen(0, y), map.disparity_px(0, y));
    }
  }
  const Image<float> without = floor_under_reflections(map, Ground{}, {});
  EXPECT_TRUE(std::isnan(without(0, 4)));
}

TEST(LabelFloor, MarksMatchesWithinTheMarginUnderTheHorizon) {
  GroundConfig config;
  config.margin = 0.5F;
  const auto map = column({{-4}, {-2}, {0}, {2.5F}, {kNaN}, {6.6F}});
  const auto floor = label_floor(map, kFloorFromRow2, {}, config, {});
  EXPECT_EQ(numbers(floor), (std::vector<std::vector<std::int64_t>>{{0}, {0}, {0}, {255}, {0}, {0}}));
}

TEST(LabelFloor, IsEmptyWithoutGroundOrWhenSwitchedOff) {
  GroundConfig off;
  off.label_floor = false;
  EXPECT_TRUE(label_floor(column({{1}}), Ground{}, {}, {}, {}).empty());
  EXPECT_TRUE(label_floor(column({{1}}), kFloorFromRow2, {}, off, {}).empty());
}

}  // namespace
}  // namespace cairn
