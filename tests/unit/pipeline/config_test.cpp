// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <algorithm>
#include <cairn/core/error.hpp>
#include <cairn/pipeline/config.hpp>
#include <set>
#include <string>

namespace cairn {
namespace {

TEST(ReasonsInForce, AreThoseOfTheEnabledChecks) {
  constexpr Reject kAlways = Reject::border | Reject::left_right | Reject::below_ground;
  EXPECT_EQ(reasons_in_force(Config{}), kAlways | Reject::speckle | Reject::sky);
  EXPECT_EQ(reasons_in_force(Config{}, true),
            Reject::no_data | Reject::below_ground | Reject::speckle | Reject::sky);
  Config config = Config::paper();
  EXPECT_TRUE(has(reasons_in_force(config), Reject::no_texture));
  set(config, "texture.threshold", "-1");
  set(config, "ground.source", "off");
  EXPECT_FALSE(has(reasons_in_force(config), Reject::no_texture));
  EXPECT_FALSE(has(reasons_in_force(config), Reject::below_ground));
  config.speckle.size = 0;  // no part of an image is that small
  EXPECT_FALSE(has(reasons_in_force(config), Reject::speckle));
}

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
  set(config, "subpixel.method", "none");
  EXPECT_EQ(config.match.window_size, 15);
  EXPECT_EQ(config.match.cost, Cost::sad);
  EXPECT_EQ(config.uniqueness.ratio, -1);
  EXPECT_EQ(config.subpixel.method, SubpixelMethod::none);
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

TEST(Options, RefuseValuesOutOfRangeAndNameTheRange) {
  EXPECT_NE(refusal("match.window_size", "8").find("3 … 31, odd"), std::string::npos);
  EXPECT_NE(refusal("match.window_size", "33").find("3 … 31"), std::string::npos);
  EXPECT_NE(refusal("match.num_disparities", "0").find("1 … 1024"), std::string::npos);
  EXPECT_NE(refusal("uniqueness.ratio", "-0.5").find("−1 = off, 0 … 100"), std::string::npos);
  EXPECT_NE(refusal("uniqueness.ratio", "nan").find("a number"), std::string::npos);
  EXPECT_NE(refusal("match.window_size", "9.5").find("a whole number"), std::string::npos);
  EXPECT_NE(refusal("match.window_size", "").find("a whole number"), std::string::npos);
  EXPECT_NE(refusal("match.cost", "cosine").find("sad|ssd|zsad|"), std::string::npos);
  EXPECT_NE(refusal("ground.label_floor", "maybe").find("true or false"), std::string::npos);
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

// ---- which options are read ----

const OptionInfo& named(const std::vector<OptionInfo>& all, std::string_view name) {
  return *std::find_if(all.begin(), all.end(), [&](const OptionInfo& option) { return option.name == name; });
}

TEST(ActiveOptions, AreAtMostFortyInAtMostTenUnits) {
  for (const std::string& preset : preset_names()) {
    std::set<std::string> units;
    const std::vector<OptionInfo> active = active_options(Config::preset(preset));
    for (const OptionInfo& option : active) {
      if (!option.unit.empty()) units.insert(option.unit);
    }
    EXPECT_LE(active.size(), 40U) << preset;
    EXPECT_LE(units.size(), 10U) << preset;
    RecordProperty(preset + " options", static_cast<int>(active.size()));
    RecordProperty(preset + " units", static_cast<int>(units.size()));
  }
}

TEST(ActiveOptions, DependOnExistingOptionsAndValidValues) {
  for (const OptionInfo& option : options(Config{})) {
    if (option.needs.empty()) continue;
    const std::size_t end = option.needs.find_first_of("!=");
    const std::string value = option.needs.substr(option.needs.find('=') + 1);
    Config config;
    EXPECT_NO_THROW(set(config, option.needs.substr(0, end), value)) << option.name << ": " << option.needs;
  }
}

TEST(ActiveOptions, InactiveOnesAreRefusedWithTheOptionToSetFirst) {
  for (const std::string& preset : preset_names()) {
    const Config config = Config::preset(preset);
    const std::vector<OptionInfo> all = options(config);
    int refused = 0;
    for (const OptionInfo& option : all) {
      const std::string message = message_of([&] { require_active(config, option.name); });
      EXPECT_EQ(message == "no error", option.active) << option.name << ": " << message;
      if (option.active) continue;
      ++refused;
      EXPECT_EQ(message.find(option.name + " has no effect with "), 0U) << message;
      // The option that it suggests setting is active itself, and had the value described.
      const std::string with = message.substr(message.find(" with ") + 6);
      const std::string required = with.substr(0, with.find('='));
      EXPECT_EQ(with.substr(0, with.find(';')), required + "=" + named(all, required).value) << message;
      EXPECT_NE(with.find("; set " + required), std::string::npos) << message;
      EXPECT_TRUE(named(all, required).active) << message;
    }
    EXPECT_GT(refused, 4) << preset;
  }
  EXPECT_EQ(message_of([] { require_active(Config{}, "match.cost"); }),
            "match.cost has no effect with match.method=semi_global; set match.method=window first");
  EXPECT_EQ(
      message_of([] { require_active(Config::paper(), "superpixels.count"); }),
      "superpixels.count has no effect with pipeline.method=paper; set pipeline.method=region_tree first");
  EXPECT_EQ(
      message_of([] { require_active(Config{}, "objects.max_area"); }),
      "objects.max_area has no effect with pipeline.method=region_tree; set pipeline.method=paper first");
}

TEST(ActiveOptions, OfASingleStageAreThoseOfItsOwnSections) {
  EXPECT_NO_THROW(require_active(Config{}, "intensity.deviation_max", {"intensity"}));
  EXPECT_THROW(require_active(Config{}, "match.cost", {"match", "semi_global"}), Error);
}

TEST(Validate, AcceptsThePresets) {
  for (const std::string& preset : preset_names())
    EXPECT_NO_THROW(validate(Config::preset(preset))) << preset;
}

TEST(Validate, RefusesOutOfRangeValuesSetInCode) {
  Config config;
  config.match.window_size = 4;
  EXPECT_THROW(validate(config), Error);
  config = {};
  config.match.cost = static_cast<Cost>(99);
  EXPECT_THROW(validate(config), Error);
}

TEST(Validate, RefusesToDisableRequiredParts) {
  Config config = Config::paper();
  config.match.maps = MatchMaps::winner;
  EXPECT_NE(message_of([&] { validate(config); }).find("match.maps"), std::string::npos);
}

TEST(Validate, RefusesOptionsThatDoNotFitTheImage) {
  Config config;
  EXPECT_NO_THROW(validate(config, {320, 240}, false));
  EXPECT_NE(message_of([&] {
              validate(Config::paper(), {8, 240}, false);
            }).find("window"),
            std::string::npos);
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
  config.ground.known.camera_height_m = 0.5F;
  EXPECT_NE(message_of([&] { validate(config, {320, 240}, false); }).find("calibration"), std::string::npos);
  EXPECT_NO_THROW(validate(config, {320, 240}, true));
}

TEST(Validate, RefusesAGroundFromTooFewPoints) {
  Config config;
  config.ground.source = GroundSource::points;
  EXPECT_NE(message_of([&] { validate(config); }).find("ground_points"), std::string::npos);
  config.ground.known.points = {{0, 0, 0, 0}, {10, 0, 9, 0}, {0, 10, 0, 10}};
  EXPECT_NE(message_of([&] { validate(config); }).find("ground_points"), std::string::npos);
}

}  // namespace
}  // namespace cairn
