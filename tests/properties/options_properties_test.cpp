// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// Each option has a condition under which it is read; if it does not hold, the option has no effect.
#include <gtest/gtest.h>

#include <cairn/pipeline/segment.hpp>
#include <cairn/tuning/tunable.hpp>

#include "support/first_difference.hpp"
#include "support/grids.hpp"
#include "support/synthetic_scene.hpp"

namespace cairn {
namespace {

using grids::numbers;

const synthetic::Scene& scene() {
  static const synthetic::Scene kScene = synthetic::make_scene(
      {.size = {96, 64}, .background_px = 3, .boxes = {{{20, 16, 24, 30}, 9}, {{60, 10, 20, 40}, 14}}});
  return kScene;
}

Frame frame_of(Config config) {
  config.match.num_disparities = 20;
  return segment(scene().pair(), StereoRig{100, 48, 32, 0.1F, 0}, config, {});
}

void expect_same(const Frame& now, const Frame& before) {
  EXPECT_EQ(first_difference(now.disparity.disparity_px, before.disparity.disparity_px), "");
  EXPECT_TRUE(numbers(now.disparity.reject) == numbers(before.disparity.reject));
  EXPECT_EQ(first_difference(now.confidence, before.confidence), "");
  EXPECT_EQ(first_difference(now.floor, before.floor), "");
  EXPECT_TRUE(numbers(now.objects.labels) == numbers(before.objects.labels));
}

/// The presets, and settings that make the other options inactive.
std::vector<Config> starts() {
  std::vector<Config> all;
  for (const std::string& preset : preset_names()) {
    const Config config = Config::preset(preset);
    all.push_back(config);
    for (const auto& [option, value] :
         {std::pair{"subpixel.method", "none"}, std::pair{"left_right.max_diff", "-1"},
          std::pair{"speckle.size", "-1"}, std::pair{"ground.source", "off"},
          std::pair{"match.method", "window"}, std::pair{"match.method", "semi_global"}}) {
      all.push_back(config);
      set(all.back(), option, value);
    }
  }
  return all;
}

TEST(OptionsThatAreNotRead, ChangeNothing) {
  for (const Config& start : starts()) {
    Config other = start;
    std::string changed;
    for (const OptionInfo& option : options(start)) {
      if (option.active) continue;
      const std::vector<std::string> around = neighbours(tunables({option.name}).at(0), option.value, 1.6);
      set(other, option.name, around.empty() ? "1" : around[0]);  // empty for unbounded integers
      changed += option.name + " ";
    }
    SCOPED_TRACE(changed);
    expect_same(frame_of(other), frame_of(start));
  }
}

}  // namespace
}  // namespace cairn
