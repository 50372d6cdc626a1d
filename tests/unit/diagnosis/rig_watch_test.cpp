// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <algorithm>
#include <cairn/diagnosis/rig_watch.hpp>
#include <string>

#include "support/samples.hpp"

namespace cairn {
namespace {

/// A run over a sample, as it is or with the cameras swapped.
class Watched : public testing::Test {
 protected:
  /// What `frames` more frames report; `first_`: the one with the first report.
  std::vector<FindingChange> after(int frames, bool is_swapped, bool has_rig = true) {
    const auto& left = sample_.images.left;
    const auto& right = sample_.images.right;
    std::vector<FindingChange> all;
    first_ = -1;
    for (int i = 0; i < frames; ++i) {
      for (FindingChange& change :
           watch_.next(is_swapped ? right.gray : left.gray, is_swapped ? left.gray : right.gray,
                       has_rig ? sample_.calibration.rig : std::nullopt, sample_.suited().match, {})) {
        if (all.empty()) first_ = i;
        all.push_back(std::move(change));
      }
    }
    return all;
  }
  static std::string names(const std::vector<FindingChange>& changes) {
    std::string text;
    for (const FindingChange& change : changes)
      text += (change.is_gone ? "-" : "+") + std::string(info(change.finding.kind).name);
    return text;
  }

  samples::Sample sample_ = samples::load("overlap");
  RigWatch watch_;
  int first_ = -1;
};

TEST_F(Watched, IsSilentOnAGoodRig) {
  EXPECT_EQ(names(after(2 * RigWatch::kEvery + 1, false)), "");
  EXPECT_TRUE(watch_.findings().empty());
}

TEST_F(Watched, ReportsAFaultOnceWithTheFirstFrame) {
  EXPECT_EQ(names(after(RigWatch::kEvery + 1, true)), "+cameras swapped");
  EXPECT_EQ(first_, 0);
  ASSERT_EQ(watch_.findings().size(), 1U);
}

TEST_F(Watched, ReportsWhatChangesLater) {
  EXPECT_EQ(names(after(50, false)), "");
  EXPECT_EQ(names(after(60, true)), "+cameras swapped");
  EXPECT_EQ(first_, RigWatch::kEvery - 50 + RigWatch::kFrames - 1);  // after a whole series
  EXPECT_EQ(names(after(RigWatch::kEvery + 10, false)), "-cameras swapped");
  EXPECT_TRUE(watch_.findings().empty());
}

TEST_F(Watched, IgnoresASingleOddFrame) {
  EXPECT_EQ(names(after(RigWatch::kEvery, false)), "");
  EXPECT_EQ(names(after(1, true)), "");
  EXPECT_EQ(names(after(RigWatch::kEvery, false)), "");
}

TEST_F(Watched, SaysThatThereAreNoMetres) {
  const auto changes = after(1, false, false);
  ASSERT_EQ(names(changes), "+no metres");
  EXPECT_EQ(static_cast<int>(changes[0].finding.severity), static_cast<int>(Severity::note));
}

TEST_F(Watched, ComparesGivenDisparitiesWithThePair) {
  const auto& left = sample_.images.left;
  const auto& right = sample_.images.right;
  const Size size = left.gray.size();
  Image<float> wrong(size);
  for (int y = 0; y < size.height; ++y) std::fill_n(wrong.row(y), size.width, static_cast<float>(y % 29));
  const auto next = [&](View<const Gray> other) {
    return names(watch_.next(left.gray, other, sample_.calibration.rig, sample_.suited().match, {}, wrong));
  };
  EXPECT_EQ(next({}), "");  // nothing to compare with
  watch_ = {};
  EXPECT_NE(next(right.gray), "");
  EXPECT_EQ(next(right.gray), "");  // said once
}

}  // namespace
}  // namespace cairn
