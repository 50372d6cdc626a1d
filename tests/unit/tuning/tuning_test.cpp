// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <algorithm>
#include <cairn/core/error.hpp>
#include <cairn/tuning/frame_loss.hpp>
#include <cairn/tuning/search.hpp>
#include <cmath>
#include <limits>
#include <set>

namespace cairn {
namespace {

TEST(GainOfAChange, IsTheMeanDifferenceWithItsConfidenceInterval) {
  // Frames gain 1, 2, 3 and 2 of 10 each: 0.2 in the mean; s = 0.0816, t(3) = 3.182, / sqrt(4).
  const std::vector<Loss> before{{5, 10}, {6, 10}, {7, 10}, {8, 10}};
  const std::vector<Loss> after{{4, 10}, {4, 10}, {4, 10}, {6, 10}};
  const Gain gain = gain_of(before, after);
  EXPECT_NEAR(gain.mean, 0.2, 1e-12);
  EXPECT_NEAR(gain.high - gain.mean, 3.182 * 0.081650 / 2, 1e-5);
  EXPECT_NEAR(gain.mean - gain.low, gain.high - gain.mean, 1e-12);
  EXPECT_NEAR(gain_of({{5, 10}}, {{4, 10}}).mean, 0.1, 1e-12);
  EXPECT_TRUE(std::isnan(gain_of({{5, 10}}, {{4, 10}}).low));
  EXPECT_TRUE(std::isnan(gain_of({{0, 0}}, {{0, 0}}).mean));
  // A frame where nothing is scored is no sample.
  std::vector<Loss> more_before = before;
  std::vector<Loss> more_after = after;
  more_before.insert(more_before.end(), 9, Loss{});
  more_after.insert(more_after.end(), 9, Loss{});
  EXPECT_EQ(gain_of(more_before, more_after).high, gain.high);
  EXPECT_TRUE(std::isnan(gain_of({{5, 10}, {}}, {{4, 10}, {}}).low));
  // With many frames, t approaches the Gaussian quantile.
  std::vector<Loss> many_before(31, Loss{5, 10});
  std::vector<Loss> many_after(31, Loss{4, 10});
  many_after[0].sum = 0;
  const Gain of_many = gain_of(many_before, many_after);
  const double deviation =
      std::sqrt((std::pow(5 - 35.0 / 31, 2) + 30 * std::pow(1 - 35.0 / 31, 2)) / 30) / 10;
  EXPECT_NEAR(of_many.high - of_many.mean, 2.042 * deviation / std::sqrt(31), 2e-5);
}

using Strings = std::vector<std::string>;

Tunable named(const std::string& name) {
  return tunables({name}).at(0);
}

Strings names_of(const std::vector<Tunable>& all) {
  Strings names;
  for (const Tunable& tunable : all) names.push_back(tunable.name);
  return names;
}

bool has(const Strings& all, const std::string& one) {
  return std::find(all.begin(), all.end(), one) != all.end();
}

// ---- tunable options ----

TEST(Tunable, TakesItsLimitsFromTheFieldsOfItsStage) {
  const Tunable window = named("match.window_size");
  EXPECT_EQ(window.kind, TunableKind::whole_number);
  EXPECT_EQ(window.lowest, 3);
  EXPECT_EQ(window.highest, 31);
  EXPECT_TRUE(window.odd_only);
  const Tunable max_diff = named("left_right.max_diff");
  EXPECT_EQ(max_diff.kind, TunableKind::number);
  EXPECT_TRUE(max_diff.minus_one_is_off);
  EXPECT_EQ(max_diff.of_presets, (Strings{"2", "1"}));
  EXPECT_EQ(named("left_right.method").choices, (Strings{"right_winner", "vote"}));
  EXPECT_EQ(named("ground.label_floor").choices, (Strings{"false", "true"}));
}

TEST(Tunable, EveryOptionIsOne) {
  const Strings names = names_of(tunables());
  for (const OptionInfo& option : options(Config{})) EXPECT_TRUE(has(names, option.name)) << option.name;
}

TEST(Tunable, OnlyActiveOptionsAreVaried) {
  for (const std::string& preset : preset_names()) {
    const Config config = Config::preset(preset);
    for (const std::string& name : names_of(tunables(usual_tunables(config, true), config)))
      EXPECT_NO_THROW(require_active(config, name)) << preset << ", " << name;
  }
  const Strings of_match = names_of(tunables({"match.min_disparity", "semi_global.*"}, Config{}));
  EXPECT_EQ(of_match, (Strings{"match.min_disparity", "semi_global.penalty_small",
                               "semi_global.penalty_large", "semi_global.penalty_edge"}));
}

TEST(Tunable, InactiveOptionsAreVariedOnlyWithTheOptionThatActivatesThem) {
  EXPECT_FALSE(has(names_of(tunables({"texture.*"}, Config::paper())), "match.cost"));
  const Strings all = names_of(tunables({"match.*"}, Config{}));
  EXPECT_TRUE(has(all, "match.cost"));  // active with match.method=window, which is tunable
  for (const Strings& patterns : {Strings{"match.cost"}, Strings{"left_right.*", "intensity.*"}}) {
    try {
      (void)tunables(patterns, Config{});
      ADD_FAILURE() << patterns.back() << " is accepted";
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("has no effect with"), std::string::npos) << error.what();
    }
  }
}

TEST(Tunable, PatternsChooseEachOptionOnceAndInOrder) {
  EXPECT_EQ(names_of(tunables({"left_right.max_diff", "semi_global.*", "semi_global.penalty_edge"})),
            (Strings{"semi_global.penalty_small", "semi_global.penalty_large", "semi_global.penalty_edge",
                     "left_right.max_diff"}));
  EXPECT_EQ(tunables({"*"}).size(), tunables().size());
}

TEST(Tunable, APatternWithoutMatchIsRefusedWithTheNearestName) {
  try {
    (void)tunables({"match.*", "superpixels.cuont"});
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("superpixels.count"), std::string::npos) << error.what();
  }
  EXPECT_THROW((void)tunables({"no_such.*"}), Error);
}

TEST(Tunable, TheUsualOnesTakePartInWhatTheConfigComputes) {
  for (const bool objects : {false, true}) {
    for (const std::string& preset : preset_names()) {
      const Config config = Config::preset(preset);
      const Strings names = names_of(tunables(usual_tunables(config, objects)));
      const bool semi_global = config.match.method == MatchMethod::semi_global;
      const bool has_tree = config.pipeline.method == Method::region_tree;
      EXPECT_EQ(has(names, "semi_global.penalty_small"), semi_global) << preset;
      EXPECT_EQ(has(names, "match.window_size"), !semi_global) << preset;
      EXPECT_EQ(has(names, "superpixels.count"), objects && has_tree) << preset;
      EXPECT_EQ(has(names, "intensity.deviation_max"), objects && !has_tree) << preset;
      EXPECT_FALSE(has(names, "match.num_disparities")) << preset;
      if (objects) continue;
      for (const std::string& name : names) EXPECT_TRUE(changes_disparities(name)) << name;
    }
  }
}

TEST(Neighbours, ANumberGrowsAndShrinksByTheStepToThreeDigits) {
  EXPECT_EQ(neighbours(named("ground.margin"), "1.6", 1.6), (Strings{"2.56", "1"}));
  EXPECT_EQ(neighbours(named("ground.margin"), "1.2345", 1.1), (Strings{"1.36", "1.12"}));
  EXPECT_EQ(neighbours(named("speckle.size"), "50", 1.1), (Strings{"55", "45", "-1"}));
  EXPECT_EQ(neighbours(named("background.max_walls"), "3", 1.1), (Strings{"4", "2"}));
}

TEST(Neighbours, StayWithinTheLimitsAndOdd) {
  EXPECT_EQ(neighbours(named("match.window_size"), "9", 1.1), (Strings{"11", "7"}));
  EXPECT_EQ(neighbours(named("match.window_size"), "3", 1.6), (Strings{"5"}));
  EXPECT_EQ(neighbours(named("match.window_size"), "31", 1.6), (Strings{"19"}));
  EXPECT_EQ(neighbours(named("semi_global.penalty_large"), "2.3", 1.6), (Strings{"1.44"}));
}

TEST(Neighbours, FromOffOrZeroThePresetsValuesAreTried) {
  EXPECT_EQ(neighbours(named("uniqueness.ratio"), "-1", 1.6), (Strings{"10"}));
  EXPECT_EQ(neighbours(named("uniqueness.ratio"), "5", 2), (Strings{"10", "2.5", "-1"}));
  EXPECT_EQ(neighbours(named("objects.min_confidence"), "0", 1.6), (Strings{"0.35"}));
  EXPECT_EQ(neighbours(named("left_right.method"), "right_winner", 1.6), (Strings{"vote"}));
}

TEST(Neighbours, EveryValueOfEveryOptionIsAccepted) {
  for (const Config& start : {Config{}, Config::paper()}) {
    const auto all = tunables();
    const auto settings = settings_of(start, all);
    for (std::size_t i = 0; i < all.size(); ++i) {
      std::string value = settings[i].value;
      // Up to the upper limit, then down to the lower one.
      for (const std::size_t way : {std::size_t{0}, std::size_t{1}}) {
        for (int n = 0; n < 40; ++n) {
          const Strings around = neighbours(all[i], value, 1.6);
          for (const std::string& other : around) {
            EXPECT_NE(other, value) << all[i].name;
            Config config = start;
            EXPECT_NO_THROW(set(config, all[i].name, other)) << all[i].name << "=" << other;
          }
          if (way >= around.size()) break;
          value = around[way];
        }
      }
    }
  }
}

// ---- the search ----

double value_of(const std::vector<Setting>& settings, const std::string& option) {
  for (const Setting& setting : settings) {
    if (setting.option == option) return std::stod(setting.value);
  }
  ADD_FAILURE() << option;
  return 0;
}

double log_square(double value, double best) {
  return std::pow(std::log(value / best), 2);
}

/// A quadratic bowl in the logarithms of two options, the same for two frames, and a choice.
std::vector<Loss> bowl(const std::vector<Setting>& settings) {
  double loss = 1 + log_square(value_of(settings, "semi_global.penalty_edge"), 4) +
                log_square(value_of(settings, "speckle.size"), 20);
  for (const Setting& setting : settings) {
    if (setting.option == "left_right.method" && setting.value == "right_winner") loss += 1;
  }
  return {{loss, 1}, {loss, 1}};
}

const std::vector<Tunable>& bowl_tunables() {
  static const auto all =
      tunables({"semi_global.penalty_edge", "speckle.size", "left_right.method", "ground.margin"});
  return all;
}

SearchResult search_bowl(const SearchConfig& config) {
  const auto& all = bowl_tunables();
  return search(all, settings_of(Config{}, all), bowl, config);
}

TEST(Search, FindsTheMinimumOfABowlAndAChoice) {
  const SearchResult found = search_bowl({});
  EXPECT_EQ(found.end, SearchEnd::converged);
  EXPECT_NEAR(value_of(found.best, "semi_global.penalty_edge"), 4, 0.6);
  EXPECT_NEAR(value_of(found.best, "speckle.size"), 20, 3);
  EXPECT_TRUE(std::find(found.best.begin(), found.best.end(), Setting{"left_right.method", "vote"}) !=
              found.best.end());
  EXPECT_LT(mean_loss(found.best_losses), 1.03);
  EXPECT_GT(mean_loss(found.start_losses), 2);
  EXPECT_EQ(value_of(found.best, "ground.margin"), value_of(found.start, "ground.margin"));
}

TEST(Search, IsReproducibleForASeedAndANumberOfEvaluations) {
  std::vector<std::vector<Setting>> ways;
  for (const std::uint32_t seed : {1U, 1U, 2U}) {
    const auto& all = bowl_tunables();
    std::vector<Setting> tried;
    (void)search(all, settings_of(Config{}, all),
                 [&](const std::vector<Setting>& settings) {
                   tried.insert(tried.end(), settings.begin(), settings.end());
                   return bowl(settings);
                 },
                 {.evaluations = 12, .seed = seed});
    EXPECT_EQ(tried.size(), 12 * all.size());
    ways.push_back(tried);
  }
  EXPECT_EQ(ways[0], ways[1]);
  EXPECT_NE(ways[0], ways[2]);
}

TEST(Search, MeasuresNothingTwice) {
  const auto& all = bowl_tunables();
  std::set<std::string> seen;
  const SearchResult found = search(all, settings_of(Config{}, all),
                                    [&](const std::vector<Setting>& settings) {
                                      std::string key;
                                      for (const Setting& setting : settings) key += setting.value + " ";
                                      EXPECT_TRUE(seen.insert(key).second) << key;
                                      return bowl(settings);
                                    },
                                    {});
  EXPECT_EQ(static_cast<std::size_t>(found.evaluations), seen.size());
}

TEST(Search, EndsWithTheNumberOfEvaluations) {
  const SearchResult found = search_bowl({.evaluations = 5});
  EXPECT_EQ(found.end, SearchEnd::evaluations);
  EXPECT_EQ(found.evaluations, 5);
  const SearchResult start_only = search_bowl({.evaluations = 1});
  EXPECT_EQ(start_only.best, start_only.start);
  EXPECT_FALSE(start_only.best_losses.empty());
}

TEST(Search, StoppedAtAnyTimeItReturnsTheBestSoFar) {
  const auto& all = bowl_tunables();
  const auto start = settings_of(Config{}, all);
  double least = std::numeric_limits<double>::infinity();
  for (const int allowed : {0, 1, 7, 20}) {
    int measured = 0;
    std::vector<Setting> reported;
    const SearchResult found = search(
        all, start,
        [&](const std::vector<Setting>& settings) -> std::optional<std::vector<Loss>> {
          if (measured == allowed) return std::nullopt;
          ++measured;
          return bowl(settings);
        },
        {}, [&](const std::vector<Setting>& settings) { reported = settings; });
    EXPECT_EQ(found.end, SearchEnd::stopped);
    EXPECT_EQ(found.evaluations, allowed);
    if (allowed == 0) {
      EXPECT_TRUE(found.start_losses.empty());
      EXPECT_TRUE(reported.empty());
      continue;
    }
    EXPECT_EQ(reported, found.best);
    EXPECT_EQ(mean_loss(found.best_losses), mean_loss(bowl(found.best)));
    EXPECT_LE(mean_loss(found.best_losses), least);
    least = mean_loss(found.best_losses);
  }
}

TEST(Search, KeepsNothingWithMoreFaultsThanTheStart) {
  const auto all = tunables({"semi_global.penalty_edge"});
  const SearchResult found = search(all, settings_of(Config{}, all),
                                    [](const std::vector<Setting>& settings) -> std::vector<Loss> {
                                      const double least = value_of(settings, "semi_global.penalty_edge");
                                      return {{log_square(least, 4), 1, least > 3 ? 2 : 1}};
                                    },
                                    {});
  EXPECT_GT(value_of(found.best, "semi_global.penalty_edge"), 2.5);
  EXPECT_LE(value_of(found.best, "semi_global.penalty_edge"), 3);
}

TEST(Search, SkipsContradictorySettings) {
  const auto all = tunables({"semi_global.penalty_edge"});
  const SearchResult found =
      search(all, settings_of(Config{}, all),
             [](const std::vector<Setting>& settings) -> std::vector<Loss> {
               const double least = value_of(settings, "semi_global.penalty_edge");
               const double loss = least > 2 ? std::numeric_limits<double>::infinity() : log_square(least, 1);
               return {{loss, 1}};
             },
             {});
  EXPECT_NEAR(value_of(found.best, "semi_global.penalty_edge"), 1, 0.1);
}

TEST(ClearlyBetter, RequiresMoreThanTheGainOfOneFrame) {
  const std::vector<Loss> before{{1, 1}, {1, 1}, {1, 1}, {1, 1}};
  EXPECT_FALSE(clearly_better(before, {{0, 1}, {1, 1}, {1, 1}, {1, 1}}, {}));
  EXPECT_TRUE(clearly_better(before, {{0.5, 1}, {0.5, 1}, {1, 1}, {1, 1}}, {}));
  EXPECT_FALSE(clearly_better(before, {{0.5, 1}, {0.5, 1}, {1, 1}, {1, 1}}, {.standard_errors = 2}));
  EXPECT_TRUE(clearly_better(before, {{0.5, 1}, {0.4, 1}, {0.5, 1}, {0.4, 1}}, {.standard_errors = 2}));
  EXPECT_FALSE(clearly_better(before, {{0, 1}, {1.9, 1}, {1, 1}, {1, 1}}, {}));
  EXPECT_FALSE(clearly_better(before, before, {.least_share = 0}));
  EXPECT_TRUE(clearly_better({{1, 1}}, {{0.5, 1}}, {}));
  EXPECT_TRUE(clearly_better({{1, 1}, {}}, {{0.5, 1}, {}}, {.standard_errors = 2})) << "one scored frame";
  EXPECT_FALSE(clearly_better({{1, 1}}, {{0.95, 1}}, {.least_share = 0.1}));
}

TEST(MeanLoss, IsTheMeanOverObjectsNotFrames) {
  EXPECT_EQ(mean_loss({{1, 1}, {0, 3}}), 0.25);
  EXPECT_TRUE(std::isinf(mean_loss({})));
  EXPECT_TRUE(std::isinf(mean_loss({{1, 0}})));
}

// ---- the loss of a frame ----

TEST(FrameLoss, IsTheCappedErrorWithWrongObjectsAsFaults) {
  FrameObjects frame;
  frame.errors.truth.resize(2);
  frame.errors.truth[0].iou = 0.5;  // E = 1
  frame.errors.truth[1].iou = 0.1;  // E = 9, counts 2
  frame.errors.ours.resize(3);
  frame.errors.ours[0].iou = 0.5;
  frame.errors.ours[2].mostly_dont_care = true;
  const Loss loss = loss_of(frame);
  EXPECT_DOUBLE_EQ(loss.sum, 3);
  EXPECT_EQ(loss.weight, 2);
  EXPECT_EQ(loss.faults, 1);
  frame.partial = true;
  EXPECT_EQ(loss_of(frame).faults, 0);
}

TEST(FrameLoss, AHoleCostsHalfOfAWrongDisparity) {
  DisparityErrors errors;
  errors.known = 100;
  errors.matched = 80;
  errors.bad = {30, 10, 5, 1};
  EXPECT_DOUBLE_EQ(mean_loss({loss_of(errors)}), 0.2);
}

TEST(FrameLoss, AddsUnsteadinessGivenAPreviousFrame) {
  Consistency pixels;
  pixels.pixels = 10;
  pixels.matched = 6;
  pixels.confirmed = 5;
  pixels.photometric_sum = 1;
  const double alone = mean_loss({loss_of(pixels, std::nullopt)});
  EXPECT_DOUBLE_EQ(alone, 0.3);
  EXPECT_DOUBLE_EQ(mean_loss({loss_of(pixels, Steadiness{})}), alone);
  Steadiness steady;
  steady.pixels = steady.still = steady.seen = 10;
  steady.unsteady = 4;
  EXPECT_DOUBLE_EQ(mean_loss({loss_of(pixels, steady)}), alone + kUnsteadyWeight * 0.4);
}

TEST(HeldOut, IsTheRequestedShareDrawnOrTheEndOfASequence) {
  const auto count = [](const std::vector<bool>& out) { return std::count(out.begin(), out.end(), true); };
  EXPECT_EQ(count(held_out(10, 0.3, false, 1)), 3);
  EXPECT_EQ(held_out(10, 0.3, false, 1), held_out(10, 0.3, false, 1));
  EXPECT_NE(held_out(10, 0.3, false, 1), held_out(10, 0.3, false, 2));
  EXPECT_EQ(held_out(4, 0.5, true, 1), (std::vector<bool>{false, false, true, true}));
  EXPECT_EQ(count(held_out(2, 0.01, false, 1)), 1);
  EXPECT_EQ(count(held_out(2, 0.9, false, 1)), 1);
  EXPECT_EQ(count(held_out(1, 0.5, false, 1)), 0);
  EXPECT_TRUE(held_out(0, 0.5, false, 1).empty());
}

}  // namespace
}  // namespace cairn
