// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/core/error.hpp>
#include <cairn/diagnosis/given_disparity.hpp>
#include <cairn/io/disparity_files.hpp>
#include <cmath>
#include <string>

#include "support/samples.hpp"

namespace cairn {
namespace {

/// The true disparities of a sample, changed.
class GivenDisparity : public testing::TestWithParam<const char*> {
 protected:
  /// `value` makes the map's value at (x, y) of the truth.
  template <class Value>
  [[nodiscard]] std::optional<Finding> judged(Value value) const {
    Image<float> map(truth_.size());
    for (int y = 0; y < map.height(); ++y) {
      for (int x = 0; x < map.width(); ++x) map(x, y) = value(x, y);
    }
    return check_given_disparity(map, sample_.pair(), rig_, {});
  }
  /// Expects that the map is certainly wrong, for this reason.
  template <class Value>
  void refuses(const std::string& reason, Value value) const {
    const auto found = judged(value);
    ASSERT_TRUE(found) << reason;
    EXPECT_EQ(info(found->kind).name, "no disparity of these images");
    EXPECT_EQ(static_cast<int>(found->severity), static_cast<int>(Severity::broken)) << found->says;
    EXPECT_NE(found->says.find(reason), std::string::npos) << found->says;
  }

  samples::Sample sample_ = samples::load(GetParam());
  std::optional<StereoRig> rig_ = sample_.calibration.rig;
  Image<float> truth_ = io::load_disparity(samples::folder(GetParam()) / "disp_left.png");
};

TEST_P(GivenDisparity, IsBelievedWhereItIsTrue) {
  const auto found = judged([&](int x, int y) { return truth_(x, y); });
  EXPECT_FALSE(found) << found->says;
  // Sparse, as from a laser.
  const auto sparse = judged([&](int x, int y) { return (x + y) % 3 == 0 ? truth_(x, y) : std::nanf(""); });
  EXPECT_FALSE(sparse) << sparse->says;
}

TEST_P(GivenDisparity, IsRefusedWhereItIsDepth) {
  const auto depth_m = [&](int x, int y) {
    return rig_->focal_px * rig_->baseline_m / (truth_(x, y) + rig_->doffs_px);
  };
  refuses("it looks like depth in mm (which fits", [&](int x, int y) { return 1000 * depth_m(x, y); });
  refuses("it looks like depth in mm", [&](int x, int y) { return std::round(1000 * depth_m(x, y)) / 256; });
}

TEST_P(GivenDisparity, IsRefusedWhereItIsScaled) {
  refuses("times the disparity: px * 16?", [&](int x, int y) { return 16 * truth_(x, y); });
  refuses("times the disparity: a PNG of px * 16, not px * 256?",
          [&](int x, int y) { return truth_(x, y) / 16; });
}

TEST_P(GivenDisparity, IsRefusedUpsideDownAndWithTheOtherSign) {
  refuses("it looks upside down", [&](int x, int y) { return truth_(x, truth_.height() - 1 - y); });
  refuses("it has the opposite sign", [&](int x, int y) { return -truth_(x, y); });
  refuses("it fits both images at 0 %", [](int, int) { return 0.0F; });
}

TEST_P(GivenDisparity, IsNotJudgedByAFewPoints) {
  const auto found = judged([&](int x, int) { return x < 16 ? 0.0F : std::nanf(""); });
  EXPECT_FALSE(found) << found->says;
  const Image<float> small(Size{4, 4});
  EXPECT_THROW((void)check_given_disparity(small, sample_.pair(), rig_, {}), Error);
}

INSTANTIATE_TEST_SUITE_P(Samples, GivenDisparity, testing::ValuesIn(samples::kNames),
                         [](const auto& test) { return std::string(test.param); });

}  // namespace
}  // namespace cairn
