// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include <cairn/sequence/follower.hpp>
#include "support/samples.hpp"

namespace cairn {
namespace {

constexpr Size kSize{320, 240};

std::vector<std::string> values(const Config& config) {
  std::vector<std::string> all;
  for (const OptionInfo& option : options(config)) all.push_back(option.value);
  return all;
}

CandidateScore score(std::vector<float> of_candidate, std::vector<float> of_present,
                     const std::string& value = "1") {
  return {{"superpixels.count", value}, std::move(of_candidate), std::move(of_present)};
}

TEST(Options, AreFewEnoughToRead) {
  EXPECT_LE(options(FollowConfig{}).size(), 50U);
}

TEST(Arms, AreReadByTheirConfigurationAndChangeIt) {
  const Config config;
  const std::vector<OptionCandidate> candidates = option_candidates(config, kSize);
  ASSERT_GE(candidates.size(), 8U);
  for (const OptionCandidate& candidate : candidates) {
    Config changed = config;
    set(changed, candidate.option, candidate.value);
    EXPECT_NO_THROW(validate(changed, kSize, true)) << candidate.option;
    EXPECT_NO_THROW(require_active(config, candidate.option));
    const auto now = options(config);
    EXPECT_NE(std::ranges::find(now, candidate.option, &OptionInfo::name)->value, candidate.value)
        << candidate.option;
  }
  EXPECT_EQ(candidates, option_candidates(config, kSize));
}

TEST(Arms, OmitChangesWithoutEffectOrOutOfRange) {
  Config config;
  config.match.method = MatchMethod::window;
  config.objects.min_area = 80;
  const auto has = [&](const std::string& option, const std::string& value) {
    const std::vector<OptionCandidate> candidates = option_candidates(config, kSize);
    return std::ranges::find(candidates, OptionCandidate{option, value}) != candidates.end();
  };
  EXPECT_FALSE(has("semi_global.penalty_large", "1.1"));
  EXPECT_FALSE(has("objects.min_area", "160"));
  EXPECT_TRUE(has("objects.min_area", "40"));
  EXPECT_TRUE(has("match.method", "semi_global"));
  EXPECT_TRUE(has("match.num_disparities", "128"));
  EXPECT_FALSE(has("match.method", "window"));
}

TEST(LeadOfAnArm, IsTheMeanOfPairedDifferencesOverThePresentsMean) {
  const CandidateGain gain = gain_of(score({1.2F, 2.2F, 3.2F}, {1, 2, 3}));
  EXPECT_NEAR(gain.mean, 0.1, 1e-6);
  EXPECT_NEAR(gain.low, 0.1, 1e-6);  // a constant lead
  const CandidateGain unsure = gain_of(score({2, 2, 2.6F}, {1, 2, 3}));
  EXPECT_NEAR(unsure.mean, 0.1, 1e-6);
  EXPECT_LT(unsure.low, 0);
  EXPECT_EQ(gain_of(score({5}, {1})).mean, -1);  // one frame is no evidence
}

TEST(LeadOfAnArm, IsDefinedIfTheCurrentSettingsFindNothing) {
  EXPECT_GT(gain_of(score({1, 1}, {0, 0})).mean, 100);
}

TEST(Halving, KeepsTheLeadingHalfAndNoMarginalLead) {
  const std::vector<CandidateScore> round{score({1.3F, 1.3F}, {1, 1}, "1"), score({1.5F, 1.5F}, {1, 1}, "2"),
                                          score({0.9F, 0.9F}, {1, 1}, "3"), score({1.3F, 1.3F}, {1, 1}, "4"),
                                          score({1.1F, 1.1F}, {1, 1}, "5")};
  const std::vector<CandidateScore> left = halved(round, 10);
  ASSERT_EQ(left.size(), 3U);
  EXPECT_EQ(left[0].candidate.value, "2");
  EXPECT_EQ(left[1].candidate.value, "1");  // a tie keeps the earlier one
  EXPECT_EQ(left[2].candidate.value, "4");
  EXPECT_TRUE(halved({score({1.04F, 1.04F}, {1, 1})}, 10).empty());
  EXPECT_EQ(halved({score({1.06F, 1.06F}, {1, 1})}, 10).size(), 1U);
  EXPECT_TRUE(halved({score({1, 1}, {1, 1})}, 0).empty());  // no effect
}

TEST(ABetterArm, LeadsSignificantlyOnEnoughFrames) {
  ControlConfig config;
  config.window = 4;
  EXPECT_TRUE(is_better(score({1.2F, 1.1F, 1.2F, 1.1F}, {1, 1, 1, 1}), config));
  EXPECT_FALSE(is_better(score({1.2F, 1.1F, 1.2F}, {1, 1, 1}), config));             // too few
  EXPECT_FALSE(is_better(score({1.05F, 1.1F, 1.05F, 1.1F}, {1, 1, 1, 1}), config));  // too little
  EXPECT_FALSE(is_better(score({3, 0.2F, 0.2F, 2}, {1, 1, 1, 1}), config));          // insignificant
}

struct Seen {
  std::vector<ControlEvent> events;
  std::vector<int> frames;  // of the events
  Image<TrackId> ids;
  FollowConfig config;  // after the last frame
};

Seen play(const samples::Sample& sample, const FollowConfig& config, int frames, int threads = 1) {
  Follower follower(config, sample.calibration.rig, Exec::with_threads(threads));
  Seen seen;
  for (int k = 0; k < frames; ++k) {
    TrackedFrame step = follower.next(sample.pair(), {k * std::int64_t{100'000'000}});
    if (step.control) seen.events.push_back(*step.control);
    if (step.control) seen.frames.push_back(k);
    seen.ids = std::move(step.ids);
  }
  seen.config = follower.config();
  return seen;
}

FollowConfig too_large(const samples::Sample& sample, ControlMethod method) {
  FollowConfig config;
  config.segmentation = sample.suited();
  config.segmentation.objects.min_area = 60;  // % of the image: there are no objects
  config.control.method = method;
  config.control.budget = 1;
  config.control.window = 3;
  config.control.cooldown = 1;
  return config;
}

TEST(Controller, OffItDoesNothing) {
  const samples::Sample sample = samples::load("four_in_a_row");
  EXPECT_TRUE(play(sample, too_large(sample, ControlMethod::off), 12).events.empty());
}

/// One of the scene's objects is found only if the minimum area is halved.
FollowConfig slightly_too_large(const samples::Sample& sample, ControlMethod method) {
  FollowConfig config = too_large(sample, method);
  FollowConfig usual = config;
  usual.control.method = ControlMethod::off;
  usual.segmentation.objects.min_area = Config{}.objects.min_area;
  const Seen seen = play(sample, usual, 3);
  std::map<TrackId, int> areas;
  for (int y = 0; y < seen.ids.height(); ++y)
    for (int x = 0; x < seen.ids.width(); ++x) ++areas[seen.ids(x, y)];
  areas.erase(TrackId::none);
  int smallest = seen.ids.width() * seen.ids.height();
  for (const auto& [id, area] : areas) smallest = std::min(smallest, area);
  config.segmentation.objects.min_area =
      1.5F * 100.0F * static_cast<float>(smallest) / static_cast<float>(sample.pair().size().area());
  return config;
}

TEST(Controller, NamesTheOptionThatRestoresObjectsReproducibly) {
  // Not four_in_a_row: there, other superpixels recover more of its stool, and come first.
  const samples::Sample sample = samples::load("glossy_floor");
  const FollowConfig config = slightly_too_large(sample, ControlMethod::watch);
  const Seen seen = play(sample, config, 30);
  ASSERT_FALSE(seen.events.empty());
  EXPECT_EQ(seen.events[0].candidate.option, "objects.min_area");
  EXPECT_GT(seen.events[0].gain, 0.1);
  const Seen again = play(sample, config, 30);
  ASSERT_EQ(again.events.size(), seen.events.size());
  for (std::size_t i = 0; i < seen.events.size(); ++i)
    EXPECT_EQ(again.events[i].candidate, seen.events[i].candidate);
}

TEST(Controller, WatchingChangesNothing) {
  const samples::Sample sample = samples::load("four_in_a_row");
  const FollowConfig config = slightly_too_large(sample, ControlMethod::watch);
  const Seen seen = play(sample, config, 30);
  ASSERT_FALSE(seen.events.empty());
  FollowConfig off = config;
  off.control.method = ControlMethod::off;
  const Seen without = play(sample, off, 30);
  for (int y = 0; y < seen.ids.height(); ++y)
    for (int x = 0; x < seen.ids.width(); ++x) ASSERT_EQ(seen.ids(x, y), without.ids(x, y));
}

TEST(RestoringArms, AreTheKnownValuesOfOptionsThatDiffer) {
  const Config known;
  EXPECT_TRUE(restoring_candidates(known, known, kSize).empty());
  Config config;
  config.superpixels.count = 40;
  config.background.max_walls = 0;
  config.uniqueness.ratio = 5;
  const std::vector<OptionCandidate> candidates = restoring_candidates(config, known, kSize);
  EXPECT_EQ(candidates, (std::vector<OptionCandidate>{{"uniqueness.ratio", "-1", true},
                                                      {"background.max_walls", "3", true},
                                                      {"superpixels.count", "150", true}}));
}

TEST(RestoringArms, RespectWhatTheUserKnowsOfTheScene) {
  const auto of = [](Config config) { return restoring_candidates(config, Config{}, kSize); };
  Config config;
  config.match.num_disparities = 128;
  config.match.min_disparity = 4;
  EXPECT_TRUE(of(config).empty());
  config.match.num_disparities = 16;
  EXPECT_EQ(of(config), (std::vector<OptionCandidate>{{"match.num_disparities", "64", false}}));
  Config pose;
  pose.ground.source = GroundSource::pose;
  pose.ground.known.camera_height_m = 1;
  EXPECT_TRUE(of(pose).empty());
  const auto has_ground = [](const std::vector<OptionCandidate>& candidates) {
    return std::ranges::find(candidates, "ground.source", &OptionCandidate::option) != candidates.end();
  };
  EXPECT_FALSE(has_ground(option_candidates(pose, kSize)));
  pose.ground.source = GroundSource::off;
  EXPECT_TRUE(has_ground(of(pose)));
  EXPECT_TRUE(has_ground(option_candidates(pose, kSize)));
  Config robot;
  robot.obstacles.range = 10;
  EXPECT_TRUE(of(robot).empty());
}

TEST(Differences, LeadBackToTheStart) {
  Config start;
  start.ground.source = GroundSource::off;
  start.match.num_disparities = 16;
  Config now;  // everything set
  EXPECT_EQ(differences(now, start),
            (std::vector<OptionCandidate>{{"match.num_disparities", "16"}, {"ground.source", "off"}}));
  start.match.method = MatchMethod::window;
  start.match.window_size = 15;  // not read by `now`
  EXPECT_EQ(differences(now, start).size(), 3U);
}

TEST(RestoringArms, BelongToThePresetWithFewestDifferences) {
  EXPECT_EQ(values(nearest_preset(Config{})), values(Config{}));
  Config config = Config::paper();
  config.uniqueness.ratio = 50;
  EXPECT_EQ(values(nearest_preset(config)), values(Config::paper()));
}

TEST(RestoringArms, NeedASignificantLeadButNoLargeOne) {
  ControlConfig config;
  config.window = 3;
  CandidateScore little = score({1.05F, 1.02F, 1.04F}, {1, 1, 1});
  EXPECT_FALSE(is_better(little, config));
  EXPECT_TRUE(halved({little}, 10).empty());
  little.candidate.restores = true;
  EXPECT_TRUE(is_better(little, config));
  EXPECT_EQ(halved({little}, 10).size(), 1U);
  CandidateScore unsure = score({1.3F, 0.8F, 1.0F}, {1, 1, 1});
  unsure.candidate.restores = true;
  EXPECT_FALSE(is_better(unsure, config));
}

TEST(Controller, TuningSetsTheOptionFromTheNextFrameOn) {
  const samples::Sample sample = samples::load("four_in_a_row");
  FollowConfig config = too_large(sample, ControlMethod::tune);
  config.control.min_gain = 100;  // nothing but the preset's value
  const Seen seen = play(sample, config, 30);
  ASSERT_FALSE(seen.events.empty());
  EXPECT_EQ(seen.events[0].candidate.option, "objects.min_area");
  EXPECT_EQ(seen.events[0].before, "60");
  EXPECT_TRUE(seen.events[0].is_set);
  EXPECT_EQ(seen.config.segmentation.objects.min_area, Config{}.objects.min_area);
  FollowConfig usual = config;
  usual.segmentation.objects.min_area = Config{}.objects.min_area;
  usual.control.method = ControlMethod::off;
  const Image<TrackId> expected = play(sample, usual, 30).ids;
  for (int y = 0; y < expected.height(); ++y) {
    for (int x = 0; x < expected.width(); ++x)
      ASSERT_EQ(seen.ids(x, y) == TrackId::none, expected(x, y) == TrackId::none);
  }
}

TEST(Controller, TuningLeavesThePresetWithoutAClearLead) {
  const samples::Sample sample = samples::load("four_in_a_row");
  FollowConfig config = too_large(sample, ControlMethod::tune);
  config.control.min_gain = 100;
  config.segmentation.objects.min_area = Config{}.objects.min_area;
  const Seen seen = play(sample, config, 60);
  EXPECT_TRUE(seen.events.empty());
  EXPECT_EQ(values(seen.config.segmentation), values(config.segmentation));
}

TEST(Controller, TuningIsReproducibleForAnyNumberOfThreadsAndKeepsTheHold) {
  const samples::Sample sample = samples::load("four_in_a_row");
  FollowConfig config = too_large(sample, ControlMethod::tune);
  config.control.min_gain = 1;
  config.control.cooldown = 25;
  const Seen seen = play(sample, config, 70);
  const Seen again = play(sample, config, 70, 3);
  ASSERT_GE(seen.events.size(), 1U);
  EXPECT_EQ(seen.frames, again.frames);
  EXPECT_EQ(values(seen.config.segmentation), values(again.config.segmentation));
  for (std::size_t i = 1; i < seen.frames.size(); ++i) EXPECT_GE(seen.frames[i] - seen.frames[i - 1], 25);
}

TEST(Controller, WatchingReportsAValueOnce) {
  const samples::Sample sample = samples::load("four_in_a_row");
  FollowConfig config = too_large(sample, ControlMethod::watch);
  config.segmentation.objects.min_area = 1;
  config.segmentation.ground.source = GroundSource::off;
  config.control.min_gain = 0;
  const Seen seen = play(sample, config, 120);
  std::set<std::pair<std::string, std::string>> reported;
  for (const ControlEvent& event : seen.events)
    EXPECT_TRUE(reported.emplace(event.candidate.option, event.candidate.value).second)
        << event.candidate.option;
  EXPECT_EQ(values(seen.config.segmentation), values(config.segmentation));
}

TEST(Controller, SurvivesAGapAndAMoveDuringASearch) {
  const samples::Sample sample = samples::load("four_in_a_row");
  const FollowConfig config = too_large(sample, ControlMethod::tune);
  Follower follower(config, sample.calibration.rig);
  bool is_set = false;
  for (int k = 0; k < 40 && !is_set; ++k) {
    if (k == 6) follower.forget();
    if (k == 8) follower = Follower(std::move(follower));
    is_set = follower.next(sample.pair(), {k * std::int64_t{100'000'000}}).control.has_value();
  }
  EXPECT_TRUE(is_set);
}

TEST(Follower, WithAnotherConfigurationItGoesOnFromACopy) {
  const samples::Sample sample = samples::load("four_in_a_row");
  FollowConfig config;
  config.segmentation = sample.suited();
  Follower follower(config, sample.calibration.rig);
  Follower same(config, sample.calibration.rig);
  Stamp stamp;
  for (int k = 0; k < 4; ++k, stamp.ns += 100'000'000) {
    follower.next(sample.pair(), stamp);
    same.next(sample.pair(), stamp);
  }
  FollowConfig wrong = config;
  wrong.segmentation.objects.min_area = 60;
  Follower other = follower.with(wrong);
  const TrackedFrame tried = other.next(sample.pair(), stamp);
  EXPECT_EQ(tried.index, 4);
  EXPECT_LT(tried.frame.objects.list.size(), 2U);
  const TrackedFrame step = follower.next(sample.pair(), stamp);
  const TrackedFrame expected = same.next(sample.pair(), stamp);
  for (int y = 0; y < step.ids.height(); ++y)
    for (int x = 0; x < step.ids.width(); ++x) ASSERT_EQ(step.ids(x, y), expected.ids(x, y));
}

TEST(Controller, AnotherConfigurationBeginsTheSearchAnew) {
  const samples::Sample sample = samples::load("four_in_a_row");
  FollowConfig config = too_large(sample, ControlMethod::tune);
  Follower follower(config, sample.calibration.rig);
  int frames = 0;
  const auto until_set = [&] {
    for (int k = 0; k < 30; ++k) {
      const TrackedFrame step = follower.next(sample.pair(), {++frames * std::int64_t{100'000'000}});
      if (step.control) return step.control->candidate.option;
    }
    return std::string("none");
  };
  EXPECT_EQ(until_set(), "objects.min_area");
  config.segmentation.objects.min_area = Config{}.objects.min_area;
  config.segmentation.superpixels.count = 4;
  follower.set_config(config);
  EXPECT_EQ(until_set(), "superpixels.count");
}

}  // namespace
}  // namespace cairn
