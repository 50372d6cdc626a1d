// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/stereo/match.hpp>
#include <string>
#include <vector>

#include "support/synthetic_scene.hpp"

namespace {

using namespace cairn;

template <class Function>
Image<Gray> mapped(const Image<Gray>& image, Function grey) {
  Image<Gray> out(image.size());
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) out(x, y) = static_cast<Gray>(grey(image(x, y)));
  }
  return out;
}

Image<Gray> mirrored(const Image<Gray>& image) {
  Image<Gray> out(image.size());
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) out(x, y) = image(image.width() - 1 - x, y);
  }
  return out;
}

/// Dots of 40 … 103, so gains and offsets do not saturate.
synthetic::Scene dim_scene() {
  auto scene = synthetic::box_before_wall({72, 40}, 3, 11, 7);
  scene.left = mapped(scene.left, [](int grey) { return 40 + grey / 4; });
  scene.right = mapped(scene.right, [](int grey) { return 40 + grey / 4; });
  return scene;
}

std::vector<Cost> all_costs() {
  std::vector<Cost> all;
  for (const auto& [name, cost] : kCosts) all.push_back(cost);
  return all;
}

class MatchProperty : public testing::TestWithParam<Cost> {
 protected:
  [[nodiscard]] static MatchConfig config() {
    return {.cost = GetParam(), .window_size = 5, .num_disparities = 16};
  }
};

class ZeroMeanProperty : public MatchProperty {};

TEST_P(ZeroMeanProperty, AnOffsetBetweenTheCamerasChangesNothing) {
  const auto scene = dim_scene();
  const auto brighter = mapped(scene.right, [](int grey) { return grey + 100; });
  const Matches expected = match_windows(scene.pair(), config(), {});
  const Matches got = match_windows(StereoPair::from(scene.left, brighter), config(), {});
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 72; ++x) {
      ASSERT_EQ(got.best(x, y), expected.best(x, y)) << x << ", " << y;
      ASSERT_EQ(got.cost(x, y), expected.cost(x, y)) << x << ", " << y;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Costs, ZeroMeanProperty, testing::Values(Cost::zsad, Cost::zssd, Cost::zncc));

TEST(ZnccProperty, AGainBetweenTheCamerasChangesNothing) {
  const auto scene = dim_scene();
  const auto brighter = mapped(scene.right, [](int grey) { return 2 * grey + 20; });
  const MatchConfig config{.window_size = 5, .num_disparities = 16};
  const Matches expected = match_windows(scene.pair(), config, {});
  const Matches got = match_windows(StereoPair::from(scene.left, brighter), config, {});
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 72; ++x) {
      ASSERT_EQ(got.best(x, y), expected.best(x, y)) << x << ", " << y;
      ASSERT_NEAR(got.cost(x, y), expected.cost(x, y), 1e-6) << x << ", " << y;
    }
  }
}

TEST(NssdProperty, AGainCommonToBothImagesChangesNothing) {
  const auto scene = dim_scene();
  const auto twice = [](int grey) { return 2 * grey; };
  const auto left = mapped(scene.left, twice);
  const auto right = mapped(scene.right, twice);
  const MatchConfig config{.cost = Cost::nssd, .window_size = 5, .num_disparities = 16};
  const Matches expected = match_windows(scene.pair(), config, {});
  const Matches got = match_windows(StereoPair::from(left, right), config, {});
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 72; ++x) ASSERT_NEAR(got.cost(x, y), expected.cost(x, y), 1e-6) << x << ", " << y;
  }
}

TEST_P(MatchProperty, TheMirroredAndSwappedPairHasTheRightImagesDisparities) {
  // Mirrored, the right image's view is that of a left image.
  const auto scene = synthetic::box_before_wall({72, 40}, 3, 11, 5);
  const auto left = mirrored(scene.right);
  const auto right = mirrored(scene.left);
  const Matches straight = match_windows(scene.pair(), config(), {});
  const Matches swapped = match_windows(StereoPair::from(left, right), config(), {});
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 72; ++x) {
      ASSERT_EQ(swapped.best(x, y), straight.best_right(71 - x, y)) << x << ", " << y;
      ASSERT_EQ(swapped.best_right(x, y), straight.best(71 - x, y)) << x << ", " << y;
    }
  }
}

TEST_P(MatchProperty, RecoversARandomDotStereogramExactly) {
  // If a whole window is on one surface visible to both cameras, its cost is that of a perfect match.
  const auto scene = synthetic::box_before_wall({96, 64}, 4, 12);
  const Matches matches = match_windows(scene.pair(), config(), {});
  int checked = 0;
  for (int y = 2; y < 62; ++y) {
    for (int x = 2; x < 94; ++x) {
      bool one_surface = true;
      for (int v = y - 2; v <= y + 2; ++v) {
        for (int u = x - 2; u <= x + 2; ++u) {
          one_surface &= scene.hidden(u, v) == 0 && scene.disparity_px(u, v) == scene.disparity_px(x, y);
        }
      }
      if (!one_surface) continue;
      ++checked;
      ASSERT_EQ(matches.best(x, y), scene.disparity_px(x, y)) << x << ", " << y;
      // The means of zsad are over windows that extend beyond this one, onto other surfaces.
      if (GetParam() != Cost::zsad) {
        ASSERT_NEAR(matches.cost(x, y), 0.0F, 1e-6) << x << ", " << y;
      }
      ASSERT_EQ(matches.best_right(x - matches.best(x, y), y), matches.best(x, y)) << x << ", " << y;
    }
  }
  EXPECT_GT(checked, 3000);
}

TEST_P(MatchProperty, TheWinnerIsTheSameWithAndWithoutFullEvidence) {
  const auto scene = synthetic::box_before_wall();
  auto winner = config();
  winner.maps = MatchMaps::winner;
  const Matches full = match_windows(scene.pair(), config(), {});
  const Matches alone = match_windows(scene.pair(), winner, {});
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 96; ++x) {
      ASSERT_EQ(alone.best(x, y), full.best(x, y));
      ASSERT_EQ(alone.cost(x, y), full.cost(x, y));
    }
  }
}

TEST_P(MatchProperty, NoOtherCandidateBeatsTheWinner) {
  const auto scene = synthetic::box_before_wall();
  const Matches matches = match_windows(scene.pair(), config(), {});
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 96; ++x) {
      const float least = matches.cost(x, y);
      ASSERT_GE(least, 0.0F);
      ASSERT_GT(matches.cost_before(x, y), least);  // a tie would have selected it
      ASSERT_GE(matches.cost_after(x, y), least);
      ASSERT_GE(matches.runner_up(x, y), least);
      ASSERT_GE(matches.mean_cost(x, y), least * (1 - 1e-6F));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(AllCosts, MatchProperty, testing::ValuesIn(all_costs()), [](const auto& cost) {
  return std::string(kCosts[static_cast<std::size_t>(cost.param)].name);
});

}  // namespace
