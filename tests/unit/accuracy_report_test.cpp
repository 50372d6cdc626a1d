// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// What writes docs/accuracy.md: tables, plots, and the list of what is undone.
#include <gtest/gtest.h>

#include <algorithm>
#include <benchmarks/ablations.hpp>
#include <benchmarks/markdown_table.hpp>
#include <benchmarks/svg_plot.hpp>
#include <cairn/core/error.hpp>
#include <limits>
#include <set>
#include <string>

namespace cairn::report {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

int count_of(const std::string& needle, const std::string& text) {
  int count = 0;
  for (std::size_t at = text.find(needle); at != std::string::npos; at = text.find(needle, at + 1)) ++count;
  return count;
}

TEST(MarkdownTable, PutsWordsLeftAndNumbersRight) {
  MarkdownTable table({"", "found, %"});
  table.add({"default", "73.7"});
  EXPECT_EQ(table.text(),
            "|  | found, % |\n"
            "|---|---:|\n"
            "| default | 73.7 |\n");
  EXPECT_EQ(MarkdownTable({"option", "meaning"}, 2).text(), "| option | meaning |\n|---|---|\n");
}

TEST(MarkdownTable, FillsShortRowsAndKeepsABarFromEndingItsCell) {
  MarkdownTable table({"a", "b"});
  table.add({"x|y"});
  EXPECT_EQ(table.text(), "| a | b |\n|---|---:|\n| x\\|y |  |\n");
}

TEST(MarkdownTable, WritesADashForWhatIsNotANumber) {
  EXPECT_EQ(percent(0.6214), "62.1");
  EXPECT_EQ(percent(kNan), "–");
}

Plot two_values(double second) {
  return {.x_title = "noise",
          .x = {0, 8},
          .ticks = {{0, "0"}, {8, "8"}},
          .panels = {{.title = "found, %", .y_max = 100, .series = {{"default", "#f00", {100, second}}}}}};
}

TEST(SvgPlot, DrawsEachValueWhereTheAxesSay) {
  const std::string svg = svg_of(two_values(0));
  // The panel is 250 wide with margins of 38 and 12, 225 high with margins of 46 and 42.
  EXPECT_NE(svg.find("d=\"M38.0 46.0L238.0 183.0\""), std::string::npos) << svg;
  EXPECT_EQ(count_of("<circle", svg), 2);
  EXPECT_NE(svg.find(">noise</text>"), std::string::npos);
}

TEST(SvgPlot, DrawsWhatExceedsTheAxisAtItsEnd) {
  EXPECT_EQ(svg_of(two_values(250)), svg_of(two_values(100)));
}

TEST(SvgPlot, PartsALineWhereAValueIsMissing) {
  Plot plot = two_values(0);
  plot.x = {0, 1, 2, 3};
  plot.panels[0].series[0].y = {10, kNan, 30, 40};
  const std::string svg = svg_of(plot);
  EXPECT_EQ(count_of("<circle", svg), 3);
  const std::size_t path = svg.find("d=\"");
  const std::string drawn = svg.substr(path, svg.find('"', path + 3) - path);
  EXPECT_EQ(count_of("M", drawn), 2);
  EXPECT_EQ(count_of("L", drawn), 1);
}

TEST(SvgPlot, LaysNoLineBetweenKinds) {
  Plot plot = two_values(0);
  plot.connected = false;
  EXPECT_EQ(count_of("<path", svg_of(plot)), 0);
  EXPECT_EQ(count_of("<circle", svg_of(plot)), 2);
}

TEST(SvgPlot, EscapesWhatWouldEndItsText) {
  Plot plot = two_values(0);
  plot.x_title = "a < b & \"c\"";
  EXPECT_NE(svg_of(plot).find(">a &lt; b &amp; &quot;c&quot;</text>"), std::string::npos);
}

TEST(SvgPlot, IsWholeWithoutAnyValues) {
  Plot plot;
  EXPECT_TRUE(svg_of(plot).ends_with("</svg>\n"));
  plot.panels.push_back({.title = "empty"});
  const std::string svg = svg_of(plot);
  EXPECT_TRUE(svg.ends_with("</svg>\n"));
  EXPECT_EQ(count_of("nan", svg), 0);
}

TEST(SvgPlot, AxesEndAtRoundNumbers) {
  EXPECT_DOUBLE_EQ(round_up_for_axis(3.2), 5);
  EXPECT_DOUBLE_EQ(round_up_for_axis(5), 5);
  EXPECT_DOUBLE_EQ(round_up_for_axis(51), 100);
  EXPECT_DOUBLE_EQ(round_up_for_axis(0.17), 0.2);
  EXPECT_DOUBLE_EQ(round_up_for_axis(0), 1);
  EXPECT_DOUBLE_EQ(round_up_for_axis(kNan), 1);
}

bool is_like_default(const Config& config) {
  const auto ours = options(Config{});
  const auto theirs = options(config);
  return std::equal(ours.begin(), ours.end(), theirs.begin(),
                    [](const auto& a, const auto& b) { return a.value == b.value; });
}

TEST(Ablations, EachIsAValidConfigurationThatDiffersFromDefault) {
  std::set<std::string> seen;
  for (const auto& [settings, meaning] : all_ablations()) {
    const AblatedConfig row = ablated(settings);
    EXPECT_NO_THROW(validate(row.config)) << settings;
    EXPECT_TRUE(row.grey || !is_like_default(row.config)) << settings << " is what default has already";
    EXPECT_TRUE(seen.insert(settings).second) << settings << " stands there twice";
  }
}

TEST(Ablations, CoverEveryOptionOfTheRunStagesOnWhichThePresetsDisagree) {
  std::string all = " ";
  for (const auto& [settings, meaning] : all_ablations()) all += settings + " ";
  const auto ours = options(Config{});
  const auto paper = options(Config::paper());
  for (std::size_t i = 0; i < ours.size(); ++i) {
    const std::string& name = ours[i].name;
    if (ours[i].value == paper[i].value || !ours[i].active) continue;
    EXPECT_NE(all.find(" " + name + "="), std::string::npos) << name;
  }
}

TEST(Ablations, AsPrintedIsPaperWithoutFloorLabelAndThresholdsOfGradients) {
  const Config as_printed = ablated(kAsPrinted.settings).config;
  EXPECT_NO_THROW(validate(as_printed));
  EXPECT_EQ(kAsPrinted.meaning, "as printed");
  Config expected = Config::paper();
  expected.ground.label_floor = false;
  expected.intensity.gradient_threshold = 0;
  expected.disparity.gradient_threshold = 0;
  const auto theirs = options(as_printed);
  const auto wanted = options(expected);
  for (std::size_t i = 0; i < wanted.size(); ++i)
    EXPECT_EQ(theirs[i].value, wanted[i].value) << wanted[i].name;
  EXPECT_TRUE(Config::paper().ground.label_floor);
}

TEST(Ablations, AMisspeltOptionIsRefused) {
  EXPECT_THROW((void)ablated("speckle.sise=-1"), Error);
  EXPECT_THROW((void)ablated("speckle.size"), Error);
}

}  // namespace
}  // namespace cairn::report
