// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <bit>
#include <cairn/core/target.hpp>
#include <limits>

#include "reference/checks.hpp"
#include "support/grids.hpp"
#include "support/random_input.hpp"

namespace cairn {
namespace {

using grids::numbers;
using grids::random_image;
using random_input::random_matches;
using random_input::sizes;
using random_input::threads;

constexpr float kHole = std::numeric_limits<float>::quiet_NaN();

/// Blocks of similar disparities with some noise and holes.
DisparityMap random_map(Size size, std::uint32_t seed) {
  const Image<int> blocks = random_image<int>({size.width / 5 + 1, size.height / 4 + 1}, 0, 6, seed);
  const Image<int> noise = random_image<int>(size, 0, 9, seed + 1);
  DisparityMap map{Image<float>(size), Image<Reject>(size)};
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const bool hole = noise(x, y) == 9;
      map.disparity_px(x, y) =
          hole ? kHole
               : 1.5F * static_cast<float>(blocks(x / 5, y / 4)) + 0.25F * static_cast<float>(noise(x, y));
      map.reject(x, y) = hole ? Reject::left_right : Reject::none;
    }
  }
  return map;
}

/// Smooth patches of three sizes, with holes.
DisparityMap smooth_map(Size size, std::uint32_t seed) {
  const Image<int> noise = random_image<int>(size, 0, 19, seed);
  DisparityMap map{Image<float>(size), Image<Reject>(size)};
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const bool hole = noise(x, y) == 19;
      const int patch = (x < size.width / 2 ? x / 9 : x / 23) + y / 8;
      map.disparity_px(x, y) = hole ? kHole : static_cast<float>(patch % 3) + 0.01F * static_cast<float>(x);
      map.reject(x, y) = hole ? Reject::left_right : Reject::none;
    }
  }
  return map;
}

/// Level ground below a plane, in stripes at two depths, with holes.
DisparityMap level_map(Size size, const GroundPlane& plane, float doffs_px, std::uint32_t seed) {
  const Image<int> noise = random_image<int>(size, 0, 19, seed);
  DisparityMap map{Image<float>(size), Image<Reject>(size)};
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const bool hole = noise(x, y) == 19;
      const float floor = plane.disparity_px(static_cast<float>(x), static_cast<float>(y)) + doffs_px;
      const float rough = 0.02F * static_cast<float>(noise(x, y));
      map.disparity_px(x, y) = hole ? kHole : (x % 40 < 25 ? 0.75F : 0.45F) * floor + rough - doffs_px;
      map.reject(x, y) = hole ? Reject::left_right : Reject::none;
    }
  }
  return map;
}

DisparityMap clone(const DisparityMap& map) {
  return {map.disparity_px.clone(), map.reject.clone()};
}

std::vector<std::uint32_t> bits(const Image<float>& image) {
  std::vector<std::uint32_t> all;
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      all.push_back(std::isnan(image(x, y)) ? 0x7FC00000U : std::bit_cast<std::uint32_t>(image(x, y)));
    }
  }
  return all;
}

#define EXPECT_SAME_MAP(fast, slow)                          \
  EXPECT_EQ(numbers((fast).reject), numbers((slow).reject)); \
  EXPECT_EQ(bits((fast).disparity_px), bits((slow).disparity_px))

class ChecksEquivalence : public testing::TestWithParam<int> {
 protected:
  Exec exec = threads(GetParam());
};

TEST_P(ChecksEquivalence, LeftRight) {
  for (const Size size : sizes()) {
    for (const int band : {0, 2}) {
      const Matches matches = random_matches(size, band, 11);
      for (const auto method : {LeftRightMethod::right_winner, LeftRightMethod::vote}) {
        if (method == LeftRightMethod::vote && size.area() > 2000) continue;  // the twin's time is quadratic
        for (const float max_diff : {-1.0F, 0.0F, 1.5F, 64.0F}) {
          SCOPED_TRACE(text(size) + " band " + std::to_string(band) + " max_diff " +
                       std::to_string(max_diff));
          const LeftRightConfig config{max_diff, method};
          const auto expected = numbers(reference::reject_inconsistent(matches, config));
          for (const Target target : supported_targets()) {
            exec.target = target;
            EXPECT_EQ(numbers(reject_inconsistent(matches, config, exec)), expected) << name(target);
          }
        }
      }
    }
  }
}

TEST_P(ChecksEquivalence, Texture) {
  for (const Size size : sizes()) {
    for (const int levels : {3, 255}) {
      const auto image = random_image<Gray>(size, 0, levels, 14);
      for (const int window : {3, 9, 31}) {
        if (window == 31 && size.area() > 2000) continue;
        for (const float threshold : {-1.0F, 0.0F, 2.0F, 2.37F, 10922.5F, 65025.0F}) {
          SCOPED_TRACE(text(size) + " window " + std::to_string(window) + " threshold " +
                       std::to_string(threshold));
          const TextureConfig config{window, threshold};
          EXPECT_EQ(numbers(reject_textureless(image, config, exec)),
                    numbers(reference::reject_textureless(image, config)));
        }
      }
    }
  }
}

TEST_P(ChecksEquivalence, TextureOfTheStrongestContrast) {
  Image<Gray> image({40, 53});
  for (int y = 0; y < 53; ++y) {
    for (int x = 0; x < 40; ++x) image(x, y) = (x / 2 + y / 2) % 2 == 0 ? Gray{0} : Gray{255};
  }
  for (const float threshold : {32512.0F, 32513.0F, 65025.0F}) {
    const TextureConfig config{31, threshold};
    EXPECT_EQ(numbers(reject_textureless(image, config, exec)),
              numbers(reference::reject_textureless(image, config)));
  }
}

TEST_P(ChecksEquivalence, TextureOfAPartOfALargerImage) {
  const auto image = random_image<Gray>({90, 60}, 0, 4, 15);
  const auto part = image.view().sub({7, 3, 61, 43});
  EXPECT_EQ(numbers(reject_textureless(part, {5, 2.0F}, exec)),
            numbers(reference::reject_textureless(part, {5, 2.0F})));
}

TEST_P(ChecksEquivalence, Combine) {
  for (const Size size : sizes()) {
    const DisparityMap some = random_map(size, 16);
    const auto one = random_image<Reject>(size, 0, 3, 17);
    const auto two = random_image<Reject>(size, 0, 2, 18);
    SCOPED_TRACE(text(size));
    EXPECT_SAME_MAP(combine(some.disparity_px.clone(), {one, two}, exec),
                    reference::combine(some.disparity_px, {one, two}));
  }
}

TEST_P(ChecksEquivalence, BelowGroundAndFloor) {
  for (const Size size : sizes()) {
    for (const float doffs : {0.0F, 3.0F}) {
      const GroundPlane plane{0.05F, 0.3F, -2.0F};
      std::vector<DisparityMap> maps;
      maps.push_back(random_map(size, 19));
      maps.push_back(smooth_map(size, 19));
      maps.push_back(level_map(size, plane, doffs, 19));
      for (const DisparityMap& map : maps) {
        const Ground ground{plane, 1.0F, 0.0F, Refusal::none};
        const StereoRig rig{100, 10, 10, 0.1F, doffs};
        for (const float margin : {0.0F, 1.0F, 64.0F}) {
          SCOPED_TRACE(text(size) + " doffs " + std::to_string(doffs) + " margin " + std::to_string(margin));
          GroundConfig config;
          config.margin = margin;
          EXPECT_SAME_MAP(reject_below_ground(clone(map), ground, rig, config, exec),
                          reference::reject_below_ground(map, plane, doffs, margin));
          EXPECT_EQ(numbers(label_floor(map, ground, rig, config, exec)),
                    numbers(reference::label_floor(map, plane, doffs, margin)));
        }
      }
    }
  }
}

TEST_P(ChecksEquivalence, Speckle) {
  for (const Size size : sizes()) {
    const DisparityMap map = random_map(size, 20);
    for (const int largest : {-1, 0, 1, 6, 40, 1000000}) {
      for (const float range : {0.0F, 0.5F, 1.0F, 64.0F}) {
        SCOPED_TRACE(text(size) + " size " + std::to_string(largest) + " range " + std::to_string(range));
        EXPECT_SAME_MAP(reject_speckles(clone(map), {largest, range}, exec),
                        reference::reject_speckles(map, {largest, range}));
      }
    }
  }
}

TEST(LevelMap, HasGroundThatOnlyTheRuleForLevelSurfacesKeeps) {
  const GroundPlane plane{0.05F, 0.3F, -2.0F};
  const DisparityMap map = level_map({130, 97}, plane, 3, 19);
  const DisparityMap kept = reference::reject_below_ground(map, plane, 3, 1);
  int count = 0;
  for (int x = 0; x < 130; ++x) count += x % 40 < 25 && !std::isnan(kept.disparity_px(x, 90)) ? 1 : 0;
  EXPECT_GT(count, 60);
}

INSTANTIATE_TEST_SUITE_P(Threads, ChecksEquivalence, testing::Values(1, 2, 3),
                         [](const auto& test) { return std::to_string(test.param); });

}  // namespace
}  // namespace cairn
