// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// The search for parameters on the fit set: lab/option_search.hpp.
#include <gtest/gtest.h>

#include <cmath>
#include <lab/option_search.hpp>

namespace cairn::lab {
namespace {

const std::vector<Knob> kTwo{{"a", {"1", "2", "3"}}, {"b", {"1", "2", "3"}}};

/// The settings tried by search_knobs(), as "23" for a=2, b=3; + marks those kept.
struct Tried {
  std::vector<std::string> settings;
  Values best;
};

Tried search(const Values& start, int rounds, const std::function<double(int, int)>& score) {
  Tried tried;
  tried.best =
      search_knobs(kTwo, start,
                   {.rounds = rounds,
                    .score = [&](const Values& v) { return score(std::stoi(v[0]), std::stoi(v[1])); },
                    .tried = [&](std::size_t, const Values& v, double,
                                 bool kept) { tried.settings.push_back(v[0] + v[1] + (kept ? "+" : "")); }});
  return tried;
}

TEST(SearchKnobs, KeepsHigherScoresAtOnceAndEndsAfterARoundWithoutGain) {
  const Tried tried = search({"1", "1"}, 9, [](int a, int b) { return 10 * a + b; });
  EXPECT_EQ(tried.settings, (std::vector<std::string>{"21+", "31+", "32+", "33+", "13", "23", "31", "32"}));
  EXPECT_EQ(tried.best, (Values{"3", "3"}));
}

TEST(SearchKnobs, KeepsTheFirstOfTies) {
  const Tried tried = search({"2", "2"}, 9, [](int, int) { return 1; });
  EXPECT_EQ(tried.settings, (std::vector<std::string>{"12", "32", "21", "23"}));
  EXPECT_EQ(tried.best, (Values{"2", "2"}));
}

TEST(SearchKnobs, EndsAfterItsRounds) {
  // a only matters with b = 3, which the first round finds last.
  const auto score = [](int a, int b) { return b == 3 ? 10 * a : b; };
  EXPECT_EQ(search({"1", "1"}, 1, score).best, (Values{"1", "3"}));
  EXPECT_EQ(search({"1", "1"}, 2, score).best, (Values{"3", "3"}));
}

TEST(SearchKnobs, AcceptsAStartOutsideTheValues) {
  const Tried tried = search({"7", "1"}, 9, [](int a, int b) { return a - b; });
  EXPECT_EQ(tried.settings, (std::vector<std::string>{"11", "21", "31", "72", "73"}));
  EXPECT_EQ(tried.best, (Values{"7", "1"}));
}

}  // namespace
}  // namespace cairn::lab
