// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/core/statistics.hpp>
#include <cairn/timing/drawn_pair.hpp>
#include <cairn/timing/frame_times.hpp>
#include <cmath>
#include <cstdlib>

namespace cairn::timing {
namespace {

/// Grey-level difference of the two images at points that the disparity relates.
double mean_difference(const DrawnPair& drawn, float shift_px) {
  double sum = 0;
  int count = 0;
  for (int y = 0; y < drawn.left.height(); ++y) {
    for (int x = 0; x < drawn.left.width(); ++x) {
      const auto x_right =
          static_cast<int>(std::lround(static_cast<float>(x) - drawn.disparity_px(x, y) - shift_px));
      if (drawn.hidden(x, y) != 0 || x_right < 0 || x_right >= drawn.right.width()) continue;
      sum += std::abs(int{drawn.left(x, y)} - int{drawn.right(x_right, y)});
      ++count;
    }
  }
  return sum / count;
}

TEST(DrawnPair, HasCorrespondingPointsAtTheTrueDisparity) {
  const DrawnPair drawn = draw_pair({320, 240}, 40);
  EXPECT_LT(mean_difference(drawn, 0), 0.6 * mean_difference(drawn, 2));
  EXPECT_LT(mean_difference(drawn, 0), 0.6 * mean_difference(drawn, -2));
}

TEST(DrawnPair, HidesTheWallOnOneSideOfABoxOnly) {
  const DrawnPair drawn = draw_pair({320, 240}, 40);
  int hidden = 0;
  int left_of_a_step = 0;
  for (int y = 0; y < 240; ++y) {
    for (int x = 41; x < 319; ++x) {
      if (drawn.hidden(x, y) == 0 || drawn.hidden(x + 1, y) != 0) continue;
      ++hidden;  // the last of a run: next to its occluder
      left_of_a_step += drawn.disparity_px(x + 1, y) > drawn.disparity_px(x, y) ? 1 : 0;
    }
  }
  EXPECT_GT(hidden, 100);
  EXPECT_GT(left_of_a_step, hidden * 95 / 100);
}

TEST(DrawnPair, DisparitiesSpanTheRequestedRange) {
  const DrawnPair drawn = draw_pair({160, 120}, 24);
  float most = 0;
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 160; ++x) most = std::max(most, drawn.disparity_px(x, y));
  }
  EXPECT_LE(most, 24);
  EXPECT_GT(most, 22);
}

TEST(FrameTimes, CountsFramesAndAddsUpStages) {
  const DrawnPair drawn = draw_pair({96, 72}, 10);
  Config config = Config::paper();
  config.match.num_disparities = 16;
  const FrameTimes times = time_frames(drawn.pair(), drawn.rig, config, {}, {.frames = 5});
  EXPECT_EQ(times.frames(), 5);
  EXPECT_EQ(times.disparity_px.size(), (Size{96, 72}));
  EXPECT_EQ(times.later_allocations, 0);
  for (std::size_t i = 0; i < 5; ++i) {
    double all = 0;
    double for_disparity = 0;
    for (const StageTimes& stage : times.stages) {
      all += stage.times.wall_ms.at(i);
      if (stage.for_disparity) for_disparity += stage.times.wall_ms.at(i);
    }
    EXPECT_LE(all, times.frame.wall_ms[i]);
    EXPECT_NEAR(for_disparity, times.disparity.wall_ms[i], 1e-9);
  }
}

TEST(FrameTimes, OneFrameIsEnoughIfOneIsRequested) {
  const DrawnPair drawn = draw_pair({96, 72}, 10);
  Config config;
  config.match.num_disparities = 16;
  EXPECT_EQ(time_frames(drawn.pair(), drawn.rig, config, {}, {.frames = 1}).frames(), 1);
  EXPECT_EQ(time_frames(drawn.pair(), drawn.rig, config, {}, {.seconds = 0}).frames(), 3);
}

TEST(Statistics, APercentileIsTheLeastValueThatTheShareDoesNotExceed) {
  const std::vector<double> values{5, 1, 4, 2, 3, std::nan("")};
  EXPECT_EQ(percentile(values, 0), 1);
  EXPECT_EQ(percentile(values, 0.5), 3);
  EXPECT_EQ(percentile(values, 0.99), 5);
  EXPECT_TRUE(std::isnan(percentile({}, 0.5)));
}

}  // namespace
}  // namespace cairn::timing
