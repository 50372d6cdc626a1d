// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/io/config_files.hpp>

#include "support/temporary_folder.hpp"

namespace cairn {
namespace {

namespace fs = std::filesystem;
using support::has;
using support::refusal;
using support::survives_damage;
using support::TemporaryFolder;

std::vector<std::string> values_of(const Config& config) {
  std::vector<std::string> values;
  for (const OptionInfo& option : options(config)) values.push_back(option.name + "=" + option.value);
  return values;
}

class ConfigFiles : public testing::Test {
 protected:
  [[nodiscard]] Config read(std::string_view yaml, Config config = Config::paper()) const {
    io::load_config(folder_.with("options.yaml", yaml), config);
    return config;
  }
  [[nodiscard]] std::string refused(std::string_view yaml) const {
    const fs::path path = folder_.with("options.yaml", yaml);
    Config config = Config::paper();
    config.match.window_size = 13;
    std::string message = refusal([&] { io::load_config(path, config); });
    EXPECT_TRUE(message.starts_with(path.string() + ": ")) << message;
    Config before = Config::paper();
    before.match.window_size = 13;
    EXPECT_EQ(values_of(config), values_of(before)) << "a refused file changes nothing";
    return message;
  }
  TemporaryFolder folder_;
};

TEST_F(ConfigFiles, SectionsAndFlatNamesAreEquivalent) {
  EXPECT_EQ(read("match:\n  window_size: 7\n").match.window_size, 7);
  EXPECT_EQ(read("match.window_size: 7\n").match.window_size, 7);
  EXPECT_EQ(read("{\"match\": {\"window_size\": 7}, \"left_right.max_diff\": -1}").match.window_size, 7);
}

TEST_F(ConfigFiles, OptionsMissingInTheFileKeepTheirValues) {
  Config before;
  before.match.window_size = 13;
  const Config after = read("left_right:\n  max_diff: 2.5\n", before);
  EXPECT_EQ(after.match.window_size, 13);
  EXPECT_EQ(after.left_right.max_diff, 2.5F);
}

TEST_F(ConfigFiles, AnEmptyFileSetsNothing) {
  for (const char* yaml : {"", "# only a comment\n", "match:\n  # window_size: 9\n", "---\n"}) {
    EXPECT_EQ(values_of(read(yaml, {})), values_of({})) << yaml;
  }
}

TEST_F(ConfigFiles, APresetIsWhereTheOptionsStart) {
  const Config read_config = read("preset: paper\nmatch.window_size: 11\n", {});
  Config expected = Config::paper();
  expected.match.window_size = 11;
  EXPECT_EQ(values_of(read_config), values_of(expected));
  EXPECT_TRUE(has(refused("match.window_size: 11\npreset: paper\n"), {"line 2", "preset", "first"}));
  EXPECT_TRUE(has(refused("preset: papre\n"), {"line 1", "papre", "paper"}));
  EXPECT_TRUE(has(refused("preset: [paper]\n"), {"preset"}));
}

std::vector<std::string> active_values_of(const Config& config) {
  std::vector<std::string> values;
  for (const OptionInfo& option : active_options(config)) values.push_back(option.name + "=" + option.value);
  return values;
}

TEST_F(ConfigFiles, EveryPresetIsReadBackAsWritten) {
  for (const std::string& name : preset_names()) {
    for (const std::string& other : preset_names()) {
      const Config config = Config::preset(name);
      const std::string yaml = io::config_yaml(config);
      EXPECT_EQ(active_values_of(read(yaml, Config::preset(other))), active_values_of(config)) << name;
    }
  }
}

TEST_F(ConfigFiles, OnlyActiveOptionsAreWritten) {
  EXPECT_EQ(io::config_yaml({}).find("window_size"), std::string::npos) << io::config_yaml({});
  EXPECT_NE(io::config_yaml({}).find("penalty_edge"), std::string::npos);
  EXPECT_EQ(io::config_yaml(Config::paper()).find("penalty_edge"), std::string::npos);
  EXPECT_NE(io::config_yaml(Config::paper()).find("window_size"), std::string::npos);
}

TEST_F(ConfigFiles, AnOptionWithoutEffectIsRefusedWhateverTheOrder) {
  EXPECT_EQ(read("match.cost: sad\nmatch.method: window\n", {}).match.cost, Cost::sad);
  EXPECT_EQ(read("match: {method: window, cost: sad}\n", {}).match.cost, Cost::sad);
  EXPECT_TRUE(has(refused("left_right.max_diff: 1\nsemi_global.penalty_edge: 1\n"),
                  {"line 2",
                   "semi_global.penalty_edge has no effect with match.method=window; set "
                   "match.method=semi_global first"}));
  const fs::path path = folder_.with("options.yaml", "match.cost: sad\n");
  Config config;
  io::load_config(path, config, Config::preset, [](Config& c) { set(c, "match.method", "window"); });
  EXPECT_EQ(config.match.cost, Cost::sad) << "what comes on top gives it an effect";
  // A complete file stays valid if an override disables some of its options.
  const fs::path whole = folder_.with("whole.yaml", io::config_yaml({}));
  EXPECT_NO_THROW(
      io::load_config(whole, config, Config::preset, [](Config& c) { set(c, "match.method", "window"); }));
}

TEST_F(ConfigFiles, ErrorsNameLineKeyAndTheNearestKnownOne) {
  EXPECT_TRUE(has(refused("match:\n  cost: sad\n  windowsize: 9\n"),
                  {"line 3", "match.windowsize", "match.window_size"}));
  EXPECT_TRUE(has(refused("mtch.window_size: 9\n"), {"line 1", "mtch.window_size", "match.window_size"}));
  EXPECT_TRUE(has(refused("match.window_size: 8\n"), {"line 1", "match.window_size", "8", "odd"}));
  EXPECT_TRUE(has(refused("match.window_size: nine\n"), {"match.window_size", "nine"}));
  EXPECT_TRUE(has(refused("match.window_size: 9999999999999999999\n"), {"match.window_size"}));
  EXPECT_TRUE(has(refused("left_right.max_diff: .nan\n"), {"left_right.max_diff"}));
  EXPECT_TRUE(has(refused("left_right.max_diff: nan\n"), {"left_right.max_diff"}));
}

TEST_F(ConfigFiles, RefusesOtherShapes) {
  EXPECT_TRUE(has(refused("just words\n"), {"map of options"}));
  EXPECT_TRUE(has(refused("- a\n- b\n"), {"map of options"}));
  EXPECT_TRUE(has(refused("match:\n  window_size:\n    deep: 9\n"), {"line", "section"}));
  EXPECT_TRUE(has(refused("match:\n  window_size:\n"), {"line", "value"}));
  EXPECT_TRUE(has(refused("match: 9\n"), {"match"}));
  EXPECT_TRUE(has(refused("? [a, b]\n: 9\n"), {"key"}));
  EXPECT_TRUE(has(refused("match: {window_size: 9\n"), {"line", "not YAML"}));
  EXPECT_TRUE(has(refused("match:\n\twindow_size: 9\n"), {"not YAML"}));
  EXPECT_TRUE(has(refused("a: *nobody\n"), {"not YAML"}));
  EXPECT_TRUE(has(refused("match.window_size: 9\n---\nmatch.window_size: 7\n"), {"2 documents"}));
  EXPECT_TRUE(has(refused(std::string("\0\0\0", 3)), {"not text"}));
}

TEST_F(ConfigFiles, RefusesBombs) {
  EXPECT_TRUE(has(refused(std::string((1U << 20) + 1, '#')), {"more than"}));
  EXPECT_TRUE(has(refused(std::string(100000, '[')), {""}));
  EXPECT_TRUE(has(refused("match.cost: " + std::string(10000, '[') + std::string(10000, ']')), {""}));
  std::string laughs = "a: &a [1,1,1,1,1,1,1,1,1]\n";
  for (char c = 'b'; c < 'k'; ++c) {
    laughs += std::string(1, c) + ": &" + c + " [";
    for (int i = 0; i < 9; ++i) laughs += std::string(i == 0 ? "*" : ",*") + static_cast<char>(c - 1);
    laughs += "]\n";
  }
  EXPECT_TRUE(has(refused(laughs), {""}));
  EXPECT_TRUE(has(refused("preset: default\nmatch.cost: &p [[1,2,3,4], *p]\n"), {""})) << "a list in itself";
  EXPECT_TRUE(has(refused("match: &m\n  window_size: *m\n"), {""}));
}

TEST_F(ConfigFiles, AShortFileContainsChangesFromThePresetAndReadsBack) {
  for (const std::string& preset : preset_names()) {
    Config config = Config::preset(preset);
    config.left_right.max_diff = 3;
    const std::string yaml = io::changed_config_yaml(preset, config, {"match.num_disparities"});
    EXPECT_EQ(values_of(read(yaml)), values_of(config)) << yaml;
    EXPECT_NE(yaml.find("num_disparities"), std::string::npos) << yaml;
    EXPECT_EQ(yaml.find("penalty_small"), std::string::npos) << yaml;
    EXPECT_EQ(io::changed_config_yaml(preset, Config::preset(preset)), "preset: " + preset + "\n");
  }
}

TEST_F(ConfigFiles, RefusesMissingFilesAndFolders) {
  Config config;
  EXPECT_TRUE(has(refusal([&] { io::load_config(folder_.path() / "none.yaml", config); }),
                  {"none.yaml", "No such file"}));
  EXPECT_TRUE(has(refusal([&] { io::load_config(folder_.path(), config); }), {"is a folder"}));
}

TEST_F(ConfigFiles, DamagedFilesCauseNothingWorseThanAnError) {
  const auto read = [](const fs::path& path) {
    Config config;
    io::load_config(path, config);
  };
  const std::string yaml =
      "preset: paper\nmatch: {window_size: 9, cost: sad}\nground:\n  margin: 2\nleft_right.max_diff: 1\n";
  survives_damage(folder_, "options.yaml", yaml, read);
}

}  // namespace
}  // namespace cairn
