// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/tuning/tune.hpp>

#include <gtest/gtest.h>

#include <cairn/core/error.hpp>
#include <cmath>

#include "support/synthetic_scene.hpp"

namespace cairn {
namespace {

/// Boards in front of a wall, with known disparities; the start refuses more than necessary.
class Tuned : public ::testing::Test {
 protected:
  [[nodiscard]] TuningFrame frame(const synthetic::Scene& scene, const std::string& name) const {
    TuningFrame made{name, scene.pair(), {}, config_};
    made.truth_px = scene.disparity_px;
    made.hidden = scene.hidden;
    return made;
  }
  [[nodiscard]] std::vector<TuningFrame> frames() const {
    return {frame(one_, "one"), frame(other_, "other")};
  }

  static Config spoilt() {
    Config config;
    config.match.num_disparities = 16;
    config.left_right.max_diff = 0;
    return config;
  }

  Config config_ = spoilt();
  synthetic::Scene one_ = synthetic::make_scene({.boxes = {{{30, 20, 30, 24}, 9}}});
  synthetic::Scene other_ = synthetic::make_scene({.boxes = {{{20, 10, 24, 30}, 11}}, .seed = 7});
};

TEST_F(Tuned, TheSameEvaluationsGiveTheSameResultOnAnyNumberOfThreads) {
  const TuneConfig wanted{.options = {"left_right.*", "speckle.*"}, .budget_s = 600, .evaluations = 8};
  const Tuning one = tune(frames(), wanted, Exec{});
  const Tuning three = tune(frames(), wanted, Exec::with_threads(3));
  EXPECT_EQ(one.goal, TuningGoal::disparities);
  EXPECT_EQ(one.search.best, three.search.best);
  EXPECT_EQ(mean_loss(losses_of(one.after)), mean_loss(losses_of(three.after)));
  EXPECT_LE(mean_loss(losses_of(one.after)), mean_loss(losses_of(one.before)));
  EXPECT_EQ(&one.settings(), one.kept_because.empty() ? &one.search.best : &one.search.start);
}

TEST_F(Tuned, FramesOfOneNameAreHeldOutTogether) {
  std::vector<TuningFrame> four = frames();
  for (const TuningFrame& again : frames()) four.push_back(again);
  const Tuning tuning =
      tune(four, {.options = {"left_right.max_diff"}, .evaluations = 1, .holdout = 0.5}, Exec{});
  EXPECT_EQ(tuning.held_out[0], tuning.held_out[2]);
  EXPECT_EQ(tuning.held_out[1], tuning.held_out[3]);
  EXPECT_NE(tuning.held_out[0], tuning.held_out[1]);
  EXPECT_EQ(tuning.before.size(), 2U);
  EXPECT_EQ(tuning.held_out_before.size(), 2U);
}

TEST_F(Tuned, StoppedItKeepsTheBestSoFarOrHasNone) {
  std::vector<TuneProgress> reports;
  const TuneHooks after_three{[&] { return reports.size() > 3; },
                              [&](const TuneProgress& now) { reports.push_back(now); }};
  const Tuning some = tune(frames(), {.options = {"*"}, .budget_s = 600}, Exec{}, after_three);
  EXPECT_EQ(some.end, TuneEnd::interrupted);
  EXPECT_EQ(some.search.evaluations, 3);
  EXPECT_FALSE(reports[0].best.has_value());
  EXPECT_EQ(reports[1].best, reports[1].before);
  const Tuning none = tune(frames(), {}, Exec{}, {[] { return true; }, {}});
  EXPECT_EQ(none.end, TuneEnd::interrupted);
  EXPECT_TRUE(none.before.empty());
}

TEST_F(Tuned, ExceptionsOfAHookReachTheCaller) {
  struct Own {};
  EXPECT_THROW(tune(frames(), {}, Exec{}, {{}, [](const TuneProgress&) { throw Own(); }}), Own);
  EXPECT_THROW(tune(frames(), {}, Exec{}, {[]() -> bool { throw Own(); }, {}}), Own);
}

TEST_F(Tuned, RefusesInvalidRequests) {
  EXPECT_THROW(tune({}, {}, Exec{}), Error);
  EXPECT_THROW(tune(frames(), {.budget_s = 0}, Exec{}), Error);
  EXPECT_THROW(tune(frames(), {.budget_s = std::nan("")}, Exec{}), Error);
  EXPECT_THROW(tune(frames(), {.evaluations = -1}, Exec{}), Error);
  EXPECT_THROW(tune(frames(), {.holdout = 1}, Exec{}), Error);
  EXPECT_THROW(tune({frames()[0]}, {.holdout = 0.5}, Exec{}), Error);
  EXPECT_THROW(tune(frames(), {.options = {"superpixels.*"}}, Exec{}), Error);  // no true objects to judge by
  config_.match.window_size = 8;
  EXPECT_THROW(tune(frames(), {}, Exec{}), Error);
}

}  // namespace
}  // namespace cairn
