// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/core/error.hpp>
#include <cairn/pipeline/config.hpp>
#include <set>
#include <string>

namespace cairn {
namespace {

std::string message_of(const auto& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

std::string refusal(std::string_view name, std::string_view value) {
  return message_of([&] {
    Config config;
    set(config, name, value);
  });
}

TEST(Options, AreSetByTheirFullName) {
  Config config;
  set(config, "match.window_size", "15");
  set(config, "match.cost", "sad");
  set(config, "uniqueness.ratio", "-1");
  set(config, "subpixel.enabled", "false");
  set(config, "ground.points", "1,2,3,4;5,6,7,8.5");
  EXPECT_EQ(config.match.window_size, 15);
  EXPECT_EQ(config.match.cost, Cost::sad);
  EXPECT_EQ(config.uniqueness.ratio, -1);
  EXPECT_FALSE(config.subpixel.enabled);
  ASSERT_EQ(config.ground.points.size(), 2U);
  EXPECT_EQ(config.ground.points[1], (PointPair{5, 6, 7, 8.5F}));
}

TEST(Options, ReadBackWhatTheyWrite) {
  for (const std::string& preset : preset_names()) {
    const Config config = Config::preset(preset);
    Config copy;
    for (const OptionInfo& option : options(config)) set(copy, option.name, option.value);
    const auto a = options(config);
    const auto b = options(copy);
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i].value, b[i].value) << a[i].name;
  }
}

TEST(Options, HaveUniqueNamesHelpAndADomain) {
  std::set<std::string> names;
  for (const OptionInfo& option : options(Config{})) {
    EXPECT_TRUE(names.insert(option.name).second) << option.name;
    EXPECT_FALSE(option.help.empty()) << option.name;
    EXPECT_FALSE(option.domain.empty()) << option.name;
  }
  EXPECT_TRUE(names.contains("left_right.max_diff"));
}

TEST(Options, RefuseWhatIsOutOfRangeAndNameTheRange) {
  EXPECT_NE(refusal("match.window_size", "8").find("3 … 31, odd"), std::string::npos);
  EXPECT_NE(refusal("match.window_size", "33").find("3 … 31"), std::string::npos);
  EXPECT_NE(refusal("match.num_disparities", "0").find("1 … 1024"), std::string::npos);
  EXPECT_NE(refusal("uniqueness.ratio", "-0.5").find("−1 = off, 0 … 100"), std::string::npos);
  EXPECT_NE(refusal("uniqueness.ratio", "nan").find("a number"), std::string::npos);
  EXPECT_NE(refusal("match.window_size", "9.5").find("a whole number"), std::string::npos);
  EXPECT_NE(refusal("match.window_size", "").find("a whole number"), std::string::npos);
  EXPECT_NE(refusal("match.cost", "ncc").find("sad|ssd|zsad|"), std::string::npos);
  EXPECT_NE(refusal("subpixel.enabled", "maybe").find("true or false"), std::string::npos);
  EXPECT_NE(refusal("ground.points", "1,2,3").find("x_left,y_left,x_right,y_right"), std::string::npos);
  EXPECT_NE(refusal("ground.points", "1,2,3,inf").find("x_left"), std::string::npos);
}

TEST(Options, NameTheNearestKnownOneForAnUnknown) {
  EXPECT_NE(refusal("match.windowsize", "9").find("did you mean 'match.window_size'"), std::string::npos);
  EXPECT_NE(message_of([] { (void)Config::preset("papr"); }).find("'paper'"), std::string::npos);
}

TEST(Options, KeepTheirValueWhenTheNewOneIsRefused) {
  Config config;
  EXPECT_THROW(set(config, "match.window_size", "10"), Error);
  EXPECT_EQ(config.match.window_size, Config{}.match.window_size);
}

TEST(Validate, AcceptsThePresets) {
  for (const std::string& preset : preset_names())
    EXPECT_NO_THROW(validate(Config::preset(preset))) << preset;
}

TEST(Validate, RefusesValuesThatCodeHasSetOutOfRange) {
  Config config;
  config.match.window_size = 4;
  EXPECT_THROW(validate(config), Error);
  config = {};
  config.match.cost = static_cast<Cost>(99);
  EXPECT_THROW(validate(config), Error);
}

TEST(Validate, RefusesChecksThatTheKeptEvidenceCannotFeed) {
  Config config = Config::paper();
  config.match.evidence = Evidence::winner;
  EXPECT_NE(message_of([&] { validate(config); }).find("match.evidence"), std::string::npos);
  config.uniqueness.ratio = -1;
  config.flatness.threshold = -1;
  config.left_right.method = LeftRightMethod::vote;
  EXPECT_NO_THROW(validate(config));
}

TEST(Validate, TakesUniquenessButNotFlatnessWithTheMinimumsEvidence) {
  Config config = Config::paper();
  config.match.evidence = Evidence::minimum;
  config.left_right.method = LeftRightMethod::vote;
  EXPECT_NE(message_of([&] { validate(config); }).find("flatness.threshold"), std::string::npos);
  config.flatness.threshold = -1;
  EXPECT_NO_THROW(validate(config));
  config.left_right.method = LeftRightMethod::true_;
  EXPECT_NE(message_of([&] { validate(config); }).find("left_right.method"), std::string::npos);
}

TEST(Validate, RefusesWhatDoesNotFitTheImage) {
  Config config;
  EXPECT_NO_THROW(validate(config, {320, 240}, false));
  EXPECT_NE(message_of([&] { validate(config, {8, 240}, false); }).find("window"), std::string::npos);
  EXPECT_NE(message_of([&] {
              validate(config, {32, 32}, false);
            }).find("num_disparities"),
            std::string::npos);
  config.match.min_disparity = 400;
  EXPECT_NE(message_of([&] {
              validate(config, {320, 240}, false);
            }).find("min_disparity"),
            std::string::npos);
  config = {};
  config.ground.source = GroundSource::pose;
  EXPECT_NE(message_of([&] { validate(config, {320, 240}, false); }).find("calibration"), std::string::npos);
  EXPECT_NO_THROW(validate(config, {320, 240}, true));
}

TEST(Validate, RefusesAGroundFromTooFewPoints) {
  Config config;
  config.ground.source = GroundSource::points;
  set(config, "ground.points", "0,0,0,0;10,0,9,0;0,10,0,10");
  EXPECT_NE(message_of([&] { validate(config); }).find("ground.points"), std::string::npos);
}

}  // namespace
}  // namespace cairn
