// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <algorithm>
#include <cairn/diagnosis/diagnose.hpp>
#include <cairn/diagnosis/synchrony.hpp>
#include <cmath>
#include <string>
#include <vector>

#include "support/noise.hpp"
#include "support/samples.hpp"
#include "support/synthetic_scene.hpp"

/// A good pair, broken in one way at a time.
namespace cairn {
namespace {

/// Transforms an image: the source position of each pixel, and the mapping of its level.
template <class Place, class Tone>
Image<Gray> made_of(View<const Gray> image, Place place, Tone tone) {
  Image<Gray> result(image.size());
  const auto level = [&](int x, int y) {
    return static_cast<double>(
        image(std::clamp(x, 0, image.width() - 1), std::clamp(y, 0, image.height() - 1)));
  };
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      const auto [from_x, from_y] = place(x, y);
      const int x0 = static_cast<int>(std::floor(from_x));
      const int y0 = static_cast<int>(std::floor(from_y));
      const double u = from_x - x0;
      const double v = from_y - y0;
      const double above = (1 - u) * level(x0, y0) + u * level(x0 + 1, y0);
      const double below = (1 - u) * level(x0, y0 + 1) + u * level(x0 + 1, y0 + 1);
      const double value = tone((1 - v) * above + v * below);
      result(x, y) = static_cast<Gray>(std::clamp(std::lround(value), 0L, 255L));
    }
  }
  return result;
}

struct Place {
  double x = 0;
  double y = 0;
};
Place same_place(int x, int y) {
  return {static_cast<double>(x), static_cast<double>(y)};
}
double same_tone(double level) {
  return level;
}

Image<Gray> toned(View<const Gray> image, double gain, double offset) {
  return made_of(image, same_place, [=](double level) { return gain * level + offset; });
}

Image<Gray> noisy(View<const Gray> image, double sigma) {
  return support::picture(image.size(), sigma, 5,
                          [&](int x, int y) { return static_cast<double>(image(x, y)); });
}

/// A box filter over 2 · radius + 1 pixels in each direction.
Image<Gray> blurred(View<const Gray> image, int radius) {
  Image<Gray> result(image.size());
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      int sum = 0;
      int count = 0;
      for (int j = std::max(0, y - radius); j <= std::min(image.height() - 1, y + radius); ++j) {
        for (int i = std::max(0, x - radius); i <= std::min(image.width() - 1, x + radius); ++i) {
          sum += image(i, j);
          ++count;
        }
      }
      result(x, y) = static_cast<Gray>(sum / count);
    }
  }
  return result;
}

class Diagnosis : public testing::Test {
 protected:
  [[nodiscard]] View<const Gray> left() const { return sample_.images.left.gray; }
  [[nodiscard]] View<const Gray> right() const { return sample_.images.right.gray; }
  [[nodiscard]] std::vector<Finding> findings(View<const Gray> l, View<const Gray> r) const {
    return diagnose(measure_pair(StereoPair::from(l, r), {}), rig_, range_, {});
  }
  [[nodiscard]] static std::string says(const std::vector<Finding>& found) {
    return found.empty() ? "" : found[0].says;
  }
  [[nodiscard]] static double value(const std::vector<Finding>& found) {
    return found.empty() ? 0.0 : found[0].value;
  }
  /// Applies the same change to both images.
  template <class Change>
  [[nodiscard]] std::vector<Finding> findings_of_both(Change change) const {
    const Image<Gray> l = change(left());
    const Image<Gray> r = change(right());
    return findings(l, r);
  }
  /// Expects this finding and no other.
  void finds(const std::vector<Finding>& found, FindingKind kind, Severity severity) const {
    ASSERT_EQ(names(found), std::string(info(kind).name));
    EXPECT_EQ(static_cast<int>(found[0].severity), static_cast<int>(severity)) << found[0].says;
    EXPECT_FALSE(found[0].says.empty());
  }
  [[nodiscard]] static std::string names(const std::vector<Finding>& found) {
    std::string all;
    for (const Finding& finding : found)
      all += (all.empty() ? "" : ", ") + std::string(info(finding.kind).name);
    return all;
  }

  samples::Sample sample_ = samples::load("four_in_a_row");
  std::optional<StereoRig> rig_ = sample_.calibration.rig;
  MatchConfig range_ = sample_.suited().match;
};

TEST_F(Diagnosis, IsSilentOnEverySample) {
  for (const char* name : samples::kNames) {
    const samples::Sample sample = samples::load(name);
    const auto found =
        diagnose(measure_pair(sample.pair(), {}), sample.calibration.rig, sample.suited().match, {});
    EXPECT_EQ(names(found), "") << name;
  }
}

TEST_F(Diagnosis, DetectsSwappedCameras) {
  const auto found = findings(right(), left());
  finds(found, FindingKind::swapped, Severity::broken);
  EXPECT_GT(value(found), 90);
}

TEST_F(Diagnosis, DetectsIdenticalImages) {
  finds(findings(left(), left()), FindingKind::same_picture, Severity::broken);
  // After lossy compression the pixels differ, but nothing has moved.
  const auto almost = noisy(left(), 2);
  const auto found = findings(left(), almost);
  finds(found, FindingKind::same_picture, Severity::broken);
  EXPECT_GT(value(found), 95);
}

TEST_F(Diagnosis, ReportsDarkImages) {
  const auto black = toned(left(), 0, 0);
  const auto found = findings(black, black);
  EXPECT_EQ(names(found), "too little texture, clipped exposure, low contrast");
}

TEST_F(Diagnosis, DetectsSwappedCamerasIfDoffsAllowsNegativeDisparities) {
  rig_->doffs_px = 40;
  finds(findings(right(), left()), FindingKind::swapped, Severity::broken);
  range_ = {.min_disparity = -40, .num_disparities = 64};  // negative disparities are expected
  EXPECT_EQ(names(findings(right(), left())), "");
}

/// Rotated by 90 degrees: column x becomes the row x from the top, or from the bottom.
Image<Gray> rotated(View<const Gray> image, bool clockwise) {
  Image<Gray> result({image.height(), image.width()});
  for (int y = 0; y < result.height(); ++y) {
    for (int x = 0; x < result.width(); ++x)
      result(x, y) = clockwise ? image(y, image.height() - 1 - x) : image(image.width() - 1 - y, x);
  }
  return result;
}

TEST_F(Diagnosis, DetectsCamerasOneAboveTheOtherAndSaysHowToRotate) {
  rig_.reset();
  for (const char* name : samples::kNames) {
    const samples::Sample sample = samples::load(name);
    for (const bool clockwise : {false, true}) {
      const auto l = rotated(sample.images.left.gray, clockwise);
      const auto r = rotated(sample.images.right.gray, clockwise);
      const auto found = findings(l, r);
      ASSERT_FALSE(found.empty()) << name;
      EXPECT_EQ(info(found[0].kind).name, "cameras one above the other") << name << found[0].says;
      EXPECT_EQ(static_cast<int>(found[0].severity), static_cast<int>(Severity::broken));
      const char* back =
          clockwise ? "rotate both images by 90 degrees counter-clockwise" : "90 degrees clockwise";
      EXPECT_NE(says(found).find(back), std::string::npos) << says(found);
    }
  }
}

TEST_F(Diagnosis, DetectsCamerasOneAboveTheOtherBeforeAPlane) {
  rig_.reset();
  const auto lower = made_of(
      left(),
      [](int x, int y) {
        return Place{double(x), y - 8.0};
      },
      same_tone);
  finds(findings(left(), lower), FindingKind::one_above_other, Severity::broken);
}

TEST_F(Diagnosis, MatchesImagesOfVeryUnequalExposure) {
  for (const char* name : {"four_in_a_row", "overlap"}) {
    const samples::Sample sample = samples::load(name);
    rig_ = sample.calibration.rig;
    range_ = sample.suited().match;
    const auto dark_right = toned(sample.images.right.gray, 0.25, 0);
    EXPECT_EQ(names(findings(sample.images.left.gray, dark_right)).find("images do not match"),
              std::string::npos);
    const BrightnessDifference measured =
        measure_pair(StereoPair::from(sample.images.left.gray, dark_right), {}).brightness;
    EXPECT_TRUE(measured.is_measured());
    EXPECT_NEAR(static_cast<double>(measured.gain), 0.25, 0.04);
    EXPECT_NE(names(findings(sample.images.left.gray, dark_right)).find("unequal brightness"),
              std::string::npos);
    const auto dark_left = toned(sample.images.left.gray, 0.25, 0);
    EXPECT_NE(names(findings(dark_left, sample.images.right.gray)).find("unequal brightness"),
              std::string::npos);
  }
}

TEST_F(Diagnosis, DoesNotCallConvergingCamerasSwapped) {
  for (const char* name : samples::kNames) {
    const samples::Sample sample = samples::load(name);
    rig_ = sample.calibration.rig;
    range_ = sample.suited().match;
    // Turned towards each other, which moves all points of the right image to the right: all disparities are
    // negative, and doffs makes up for it.
    const int towards = range_.num_disparities + 8;
    const auto turned = made_of(
        sample.images.right.gray,
        [=](int x, int y) {
          return Place{double(x - towards), double(y)};
        },
        same_tone);
    rig_->doffs_px += static_cast<float>(towards);
    const auto found = findings(sample.images.left.gray, turned);
    EXPECT_EQ(names(found).find("cameras swapped"), std::string::npos) << name << ": " << names(found);
    EXPECT_NE(names(found).find("disparity range too small"), std::string::npos)
        << name << ": " << names(found);
  }
}

TEST_F(Diagnosis, DoesNotCallTheBlackBordersOfRectificationAFault) {
  // The border of a distorted and rotated image: a fifth of the width at the sides, less above and below.
  const auto bordered = [](View<const Gray> image) {
    Image<Gray> result(image.size());
    const double w = image.width();
    const double h = image.height();
    for (int y = 0; y < image.height(); ++y) {
      for (int x = 0; x < image.width(); ++x) {
        const double u = 2 * x / w - 1;
        const double v = 2 * y / h - 1;
        const bool is_seen = std::abs(u + 0.05 * v) < 0.72 + 0.1 * v * v && std::abs(v) < 0.9 - 0.1 * u * u;
        result(x, y) = is_seen ? std::max<Gray>(image(x, y), 2) : Gray{0};
      }
    }
    return result;
  };
  const auto found = findings_of_both(bordered);
  finds(found, FindingKind::border, Severity::note);
  const Image<Gray> image = bordered(left());
  const Exposure measured = measure_exposure(image);
  EXPECT_GT(measured.border, 0.3F);
  EXPECT_LT(measured.black, 0.03F);
  // What is dark in the scene is none.
  const auto dark = [](View<const Gray> scene) { return toned(scene, 2, -180); };
  EXPECT_NE(names(findings_of_both(dark)).find("clipped exposure"), std::string::npos);
}

TEST_F(Diagnosis, MeasuresAVerticalShift) {
  for (const double rows : {-2.0, 1.25, 3.0}) {
    const auto lower = made_of(
        right(),
        [=](int x, int y) {
          return Place{double(x), y - rows};
        },
        same_tone);
    const RowAlignment measured = measure_pair(StereoPair::from(left(), lower), {}).rows;
    EXPECT_NEAR(static_cast<double>(measured.offset_rows), rows, 0.12);
    EXPECT_NEAR(static_cast<double>(measured.rows_per_px), 0, 0.0012);
    const auto bin = static_cast<std::size_t>(RowAlignment::kMaxBins + std::lround(rows));
    EXPECT_EQ(*std::max_element(measured.histogram.begin(), measured.histogram.end()),
              measured.histogram[bin]);
    const auto found = findings(left(), lower);
    finds(found, FindingKind::rows, Severity::warning);
    EXPECT_NEAR(value(found), std::abs(rows), 0.3);
  }
}

TEST_F(Diagnosis, CallsAShiftBeyondTheCorrectionBroken) {
  const auto lower = made_of(
      right(),
      [](int x, int y) {
        return Place{double(x), y - 9.0};
      },
      same_tone);
  finds(findings(left(), lower), FindingKind::rows, Severity::broken);
}

TEST_F(Diagnosis, MeasuresARoll) {
  const double tangent = 0.015;
  const double middle = 0.5 * (right().width() - 1);
  const auto rolled = made_of(
      right(),
      [=](int x, int y) {
        return Place{double(x), y - tangent * (x - middle)};
      },
      same_tone);
  EXPECT_NEAR(static_cast<double>(measure_pair(StereoPair::from(left(), rolled), {}).rows.rows_per_px),
              tangent, 0.0015);
  finds(findings(left(), rolled), FindingKind::rows, Severity::warning);
}

TEST_F(Diagnosis, DetectsAnUnrectifiedPair) {
  // Lens distortion, and different focal lengths.
  const double middle_x = 0.5 * (right().width() - 1);
  const double middle_y = 0.5 * (right().height() - 1);
  const auto scaled = made_of(
      right(),
      [=](int x, int y) {
        return Place{double(x), middle_y + (y - middle_y) * 1.04};
      },
      same_tone);
  const auto scaled_found = findings(left(), scaled);
  finds(scaled_found, FindingKind::rectification, Severity::broken);
  const auto keystone = made_of(
      right(),
      [=](int x, int y) {
        return Place{double(x), y + 5 * (x - middle_x) / middle_x * (y - middle_y) / middle_y};
      },
      same_tone);
  EXPECT_NE(names(findings(left(), keystone)).find("not rectified"), std::string::npos);
}

TEST_F(Diagnosis, DetectsImagesOfDifferentScenes) {
  const samples::Sample other = samples::load("overlap");
  finds(findings(left(), other.images.right.gray), FindingKind::nothing_in_common, Severity::broken);
}

TEST_F(Diagnosis, DetectsAnImageUpsideDown) {
  const auto turned = made_of(
      right(),
      [&](int x, int y) {
        return Place{double(right().width() - 1 - x), double(right().height() - 1 - y)};
      },
      same_tone);
  finds(findings(left(), turned), FindingKind::nothing_in_common, Severity::broken);
}

TEST_F(Diagnosis, ReportsTooFewPoints) {
  const auto plain = support::picture(left().size(), 1, 1, [](int x, int) { return 60 + 0.3 * x; });
  const auto other = support::picture(left().size(), 1, 2, [](int x, int) { return 60 + 0.3 * x; });
  finds(findings(plain, other), FindingKind::few_points, Severity::note);
}

TEST_F(Diagnosis, DetectsATooSmallRangeAndNamesASuitableOne) {
  range_.num_disparities = 14;
  auto found = findings(left(), right());
  finds(found, FindingKind::range_too_small, Severity::warning);
  EXPECT_NE(says(found).find("match.num_disparities=32"), std::string::npos) << says(found);
  range_.num_disparities = 4;
  found = findings(left(), right());
  finds(found, FindingKind::range_too_small, Severity::broken);
  range_ = {.min_disparity = 12, .num_disparities = 32};
  found = findings(left(), right());
  finds(found, FindingKind::range_too_small, Severity::warning);
  EXPECT_NE(says(found).find("match.min_disparity=3"), std::string::npos) << says(found);
}

TEST_F(Diagnosis, DetectsATooLargeRange) {
  range_.num_disparities = 256;
  const auto found = findings(left(), right());
  finds(found, FindingKind::range_too_large, Severity::note);
  EXPECT_NE(says(found).find("match.num_disparities=32"), std::string::npos) << says(found);
}

TEST_F(Diagnosis, DetectsPointsBeyondInfinity) {
  rig_->doffs_px = -14;
  finds(findings(left(), right()), FindingKind::behind_infinity, Severity::warning);
  rig_->doffs_px = -50;  // nothing is left before it
  finds(findings(left(), right()), FindingKind::behind_infinity, Severity::broken);
}

TEST_F(Diagnosis, MeasuresGainAndOffset) {
  const auto darker = toned(right(), 0.7, 5);
  const BrightnessDifference before = measure_pair(StereoPair::from(left(), right()), {}).brightness;
  const BrightnessDifference after = measure_pair(StereoPair::from(left(), darker), {}).brightness;
  EXPECT_NEAR(static_cast<double>(after.gain), 0.7 * static_cast<double>(before.gain), 0.02);
  EXPECT_NEAR(static_cast<double>(after.offset), 0.7 * static_cast<double>(before.offset) + 5, 2);
  finds(findings(left(), darker), FindingKind::brightness, Severity::warning);
}

TEST_F(Diagnosis, JudgesASegmentedFrameByTheResultsOfItsStages) {
  Config config = sample_.suited();
  const Frame frame = segment(sample_.pair(), rig_, config, {});
  const auto in_passing = [&](const Frame& f) { return diagnose(f, left(), right(), rig_, config, {}); };
  EXPECT_EQ(names(in_passing(frame)), "");
  EXPECT_FALSE(is_doubtful(frame));
  EXPECT_TRUE(is_doubtful(segment(StereoPair::from(right(), left()), rig_, config, {})));

  const auto lower = made_of(
      right(),
      [](int x, int y) {
        return Place{double(x), y - 2.0};
      },
      same_tone);
  finds(in_passing(segment(StereoPair::from(left(), lower), rig_, config, {})), FindingKind::rows,
        Severity::warning);

  config.match.num_disparities = 17;
  const auto found = in_passing(segment(sample_.pair(), rig_, config, {}));
  finds(found, FindingKind::range_too_small, Severity::warning);
  EXPECT_NE(says(found).find("match.num_disparities=48"), std::string::npos) << says(found);
}

TEST_F(Diagnosis, NotesThatMuchLiesBelowTheFloor) {
  const Config config = sample_.suited();
  Frame frame = segment(sample_.pair(), rig_, config, {});
  ASSERT_TRUE(frame.ground.plane);
  const auto below = [&](int rows) {
    for (int y = 0; y < rows; ++y) {
      std::fill_n(frame.disparity.reject.row(y), frame.disparity.reject.width(), Reject::below_ground);
    }
    return diagnose(frame, left(), right(), rig_, config, {});
  };
  EXPECT_EQ(names(below(frame.disparity.reject.height() / 8)), "");
  const auto found = below(frame.disparity.reject.height() / 2);
  finds(found, FindingKind::below_floor, Severity::note);
  frame.ground.plane.reset();  // there is nothing to be below of
  frame.ground.refusal = Refusal::unlikely;
  finds(below(0), FindingKind::no_floor, Severity::note);
}

TEST_F(Diagnosis, DetectsWhichCameraIsBlurred) {
  const auto soft = blurred(right(), 2);
  const auto soft_left = blurred(left(), 2);
  auto found = findings(left(), soft);
  finds(found, FindingKind::blur, Severity::warning);
  EXPECT_NE(says(found).find("in the right image"), std::string::npos) << says(found);
  found = findings(soft_left, right());
  finds(found, FindingKind::blur, Severity::warning);
  EXPECT_NE(says(found).find("in the left image"), std::string::npos) << says(found);
  found = findings_of_both([](View<const Gray> image) { return blurred(image, 3); });
  finds(found, FindingKind::blur, Severity::warning);
  EXPECT_NE(says(found).find("in both images"), std::string::npos) << says(found);
}

TEST_F(Diagnosis, DoesNotBlameASharpCameraForTheOthersNoise) {
  const auto between = [](int x, int y) { return Place{x + 0.5, y + 0.5}; };
  const auto soft_left = made_of(left(), between, same_tone);  // as with most lenses
  const auto soft_right = made_of(right(), between, same_tone);
  int tempting = 0;
  for (const double sigma : {4.0, 8.0, 16.0}) {
    const auto noisy_right = noisy(soft_right, sigma);
    const PairMeasures measured = measure_pair(StereoPair::from(soft_left, noisy_right), {});
    tempting += measured.left_sharpness.edge_px > 1.6F * measured.right_sharpness.edge_px ? 1 : 0;
    EXPECT_EQ(names(findings(soft_left, noisy_right)).find("blurred"), std::string::npos) << sigma;
    const auto noisy_left = noisy(soft_left, sigma);
    EXPECT_EQ(names(findings(noisy_left, soft_right)).find("blurred"), std::string::npos) << sigma;
  }
  EXPECT_GT(tempting, 0);
}

TEST_F(Diagnosis, DoesNotJudgeBrightnessByAFewPoints) {
  const BrightnessDifference measured = measure_pair(StereoPair::from(left(), right()), {}).brightness;
  EXPECT_TRUE(measured.is_measured());
  const auto plain = support::picture(left().size(), 1, 1, [](int x, int) { return 60 + 0.3 * x; });
  EXPECT_FALSE(measure_pair(StereoPair::from(plain, plain), {}).brightness.is_measured());
}

TEST_F(Diagnosis, NamesBothCamerasWhereBothAreAtFault) {
  const auto bright = toned(left(), 1.9, 25);
  const auto dark = toned(right(), 2, -180);
  const auto clipped = findings(bright, dark);
  const auto of = [](const std::vector<Finding>& found, FindingKind kind) {
    for (const Finding& finding : found) {
      if (finding.kind == kind) return finding.says;
    }
    return std::string();
  };
  EXPECT_NE(of(clipped, FindingKind::exposure).find("in the left image"), std::string::npos);
  EXPECT_NE(of(clipped, FindingKind::exposure).find("white (254, 255), in the right one"), std::string::npos)
      << of(clipped, FindingKind::exposure);
  EXPECT_NE(of(clipped, FindingKind::exposure).find("black (0, 1)"), std::string::npos);
  const auto dim = [](View<const Gray> image) { return toned(image, 0.15, 3); };
  const std::string levels = of(findings_of_both(dim), FindingKind::dark);
  EXPECT_NE(levels.find("the levels of the left image"), std::string::npos) << levels;
  EXPECT_NE(levels.find("those of the right one"), std::string::npos) << levels;
  const Image<Gray> dim_right = dim(right());
  EXPECT_EQ(of(findings(left(), dim_right), FindingKind::dark).find("the levels of the right image"), 0U);
}

TEST_F(Diagnosis, DetectsClippedExposure) {
  const auto bright = [](View<const Gray> image) { return toned(image, 1.9, 25); };
  auto found = findings_of_both(bright);
  finds(found, FindingKind::exposure, Severity::warning);
  EXPECT_NE(says(found).find("white"), std::string::npos) << says(found);
  const auto dark = [](View<const Gray> image) { return toned(image, 2, -180); };
  found = findings_of_both(dark);
  ASSERT_FALSE(found.empty());
  EXPECT_NE(found.back().says.find("black"), std::string::npos) << found.back().says;
}

TEST_F(Diagnosis, DetectsLowContrast) {
  const auto dim = [](View<const Gray> image) { return toned(image, 0.15, 3); };
  const auto found = findings_of_both(dim);
  EXPECT_NE(names(found).find("low contrast"), std::string::npos) << names(found);
}

TEST_F(Diagnosis, DetectsACalibrationInTheWrongUnits) {
  const StereoRig good = *rig_;
  rig_->baseline_m = 1000 * good.baseline_m;
  finds(findings(left(), right()), FindingKind::calibration, Severity::broken);
  rig_->baseline_m = 0.001F * good.baseline_m;
  finds(findings(left(), right()), FindingKind::calibration, Severity::broken);
  rig_ = good;
  rig_->focal_px = 4;  // millimetres
  EXPECT_EQ(names(findings(left(), right())).find("implausible calibration"), 0U);
}

TEST_F(Diagnosis, SuspectsABaselineInCentimetres) {
  const float good = rig_->baseline_m;
  rig_->baseline_m = 100 * good;
  auto found = findings(left(), right());
  finds(found, FindingKind::calibration, Severity::warning);
  EXPECT_NE(says(found).find("centimetres"), std::string::npos) << says(found);
  rig_->baseline_m = 2;  // implausible for a short one; the distances show it
  rig_->focal_px *= 2;
  found = findings(left(), right());
  finds(found, FindingKind::calibration, Severity::warning);
}

TEST_F(Diagnosis, DetectsACalibrationForAnotherImageSize) {
  rig_->focal_px *= 2;
  rig_->cx_px *= 2;
  rig_->cy_px *= 2;
  finds(findings(left(), right()), FindingKind::calibration, Severity::broken);
}

TEST_F(Diagnosis, AcceptsTheSmallestImages) {
  for (const Size size : {Size{1, 1}, Size{3, 200}, Size{200, 2}, Size{9, 9}, Size{17, 12}}) {
    const auto picture = synthetic::random_dots(size, 1);
    const auto measures = measure_pair(StereoPair::from(picture, picture), {});
    EXPECT_EQ(measures.size, size);
    (void)diagnose(measures, rig_, range_, {});
  }
}

TEST_F(Diagnosis, IsTheSameOnAnyNumberOfThreads) {
  const auto pair = StereoPair::from(left(), right());
  const auto one = measure_pair(pair, {});
  const auto three = measure_pair(pair, Exec::with_threads(3));
  EXPECT_EQ(one.disparities_px, three.disparities_px);
  EXPECT_EQ(one.rows.offset_rows, three.rows.offset_rows);
  EXPECT_EQ(one.rows.histogram, three.rows.histogram);
  EXPECT_EQ(one.brightness.gain, three.brightness.gain);
}

TEST(FindingKinds, AreDescribedInTheirOrder) {
  for (std::size_t i = 0; i < kFindings.size(); ++i) {
    EXPECT_EQ(static_cast<std::size_t>(kFindings[i].kind), i);
    EXPECT_FALSE(kFindings[i].remedy.empty());
  }
}

TEST(United, KeepsTheWorstOfAKindAndAllItsFrames) {
  const Finding light{FindingKind::rows, Severity::warning, 1, "light"};
  const Finding heavy{FindingKind::rows, Severity::broken, 9, "heavy"};
  const Finding large{FindingKind::range_too_large, Severity::note, 5, "large"};
  const auto all = united({{light, large}, {}, {heavy, large}});
  ASSERT_EQ(all.size(), 1U);  // the second pair needs the whole range
  EXPECT_EQ(all[0].says, "heavy");
  EXPECT_EQ(all[0].frames, (std::vector<std::size_t>{0, 2}));
}

TEST(United, NamesTheOtherCameraOfOtherPairs) {
  const Finding left{FindingKind::blur, Severity::warning, 5, "left", {}, Camera::left};
  const Finding right{FindingKind::blur, Severity::warning, 6, "right", {}, Camera::right};
  EXPECT_EQ(united({{left}, {left}})[0].says, "left");
  EXPECT_EQ(united({{left}, {right}})[0].says, "left; the right one's in other pairs");
}

// ---- sequences ----

/// A textured board that jumps in front of a textured wall, rendered for both cameras.
class Sequence {
 public:
  explicit Sequence(int frames, bool moves = true) {
    support::Noise noise(7);
    for (int i = 0; i < frames; ++i) {
      const int x = moves ? 30 + static_cast<int>(90 * noise.uniform()) : 60;
      const int y = moves ? 10 + static_cast<int>(60 * noise.uniform()) : 40;
      left_.push_back(drawn({x, y}, 0));
      right_.push_back(drawn({x - 12, y}, 4));
    }
  }
  /// The right images are `late` frames late.
  [[nodiscard]] std::vector<StereoPair> pairs(int late) const {
    std::vector<StereoPair> all;
    const int count = static_cast<int>(left_.size());
    for (int i = std::max(0, late); i < std::min(count, count + late); ++i) {
      all.push_back(
          StereoPair::from(left_[static_cast<std::size_t>(i)], right_[static_cast<std::size_t>(i - late)]));
    }
    return all;
  }

 private:
  Image<Gray> drawn(Point board, int wall_disparity) {
    Image<Gray> image(kSize);
    for (int y = 0; y < kSize.height; ++y) {
      for (int x = 0; x < kSize.width; ++x) {
        const int u = x - board.x;
        const int v = y - board.y;
        const bool is_board = u >= 0 && v >= 0 && u < 40 && v < 30;
        image(x, y) = is_board ? board_(u, v) : wall_(x + wall_disparity, y);
      }
    }
    return image;
  }

  static constexpr Size kSize{160, 100};
  static Image<Gray> texture(Size size, std::uint32_t seed) {
    const Image<Gray> dots = synthetic::random_dots(size, seed);
    return blurred(dots, 1);
  }
  Image<Gray> wall_ = texture({kSize.width + 8, kSize.height}, 1);
  Image<Gray> board_ = texture({40, 30}, 2);
  std::vector<Image<Gray>> left_;
  std::vector<Image<Gray>> right_;
};

TEST(SynchronyOfASequence, HasNoFindingsForSynchronousCameras) {
  const Sequence sequence(14);
  const Synchrony measured = measure_synchrony(sequence.pairs(0), {});
  EXPECT_EQ(measured.lag(), 0);
  EXPECT_FALSE(measured.change);
  EXPECT_FALSE(diagnose(measured));
}

TEST(SynchronyOfASequence, IsANoteIfUndetermined) {
  const Sequence still(14, false);
  for (const int late : {0, 1}) {
    const Synchrony measured = measure_synchrony(still.pairs(late), {});
    EXPECT_FALSE(measured.tells());
    const auto finding = diagnose(measured);
    ASSERT_TRUE(finding);
    EXPECT_EQ(info(finding->kind).name, "synchronisation undetermined");
    EXPECT_EQ(static_cast<int>(finding->severity), static_cast<int>(Severity::note));
  }
  EXPECT_FALSE(diagnose(measure_synchrony(Sequence(7, false).pairs(0), {})));  // too short for a sequence
}

TEST(SynchronyOfASequence, MayBeLostFromAFrameOn) {
  const Sequence sequence(34);
  for (const int late : {-2, -1, 1}) {
    for (const int from : {12, 20}) {
      // First in step, then the right images `late` frames late.
      std::vector<StereoPair> pairs = sequence.pairs(0);
      const std::vector<StereoPair> out_of_step = sequence.pairs(late);
      const auto shift = static_cast<std::size_t>(std::max(0, late));
      pairs.resize(out_of_step.size() + shift, pairs.front());
      for (std::size_t i = static_cast<std::size_t>(from); i < pairs.size(); ++i)
        pairs[i] = out_of_step[i - shift];
      const Synchrony measured = measure_synchrony(pairs, {});
      ASSERT_TRUE(measured.change) << late << " from " << from;
      const int named = measured.change->from;
      EXPECT_LE(std::abs(named - from), 1) << late;
      EXPECT_EQ(measured.change->before, 0);
      EXPECT_EQ(measured.change->after, late);
      const auto finding = diagnose(measured);
      ASSERT_TRUE(finding);
      EXPECT_EQ(static_cast<int>(finding->severity), static_cast<int>(Severity::broken));
      EXPECT_EQ(finding->value, late);
      EXPECT_EQ(finding->frames.front(), static_cast<std::size_t>(named));
      EXPECT_EQ(finding->frames.back(), pairs.size() - 1);
      EXPECT_NE(finding->says.find("from frame " + std::to_string(named) + " on"), std::string::npos);
    }
  }
}

TEST(SynchronyOfASequence, NamesTheFrameWhereItIsLost) {
  Synchrony measured;
  measured.frames = 3;
  measured.change = LagChange{1, 0, 1, 0.9};
  const std::array<std::string, 3> names{"a", "b", "c"};
  EXPECT_NE(diagnose(measured, names)->says.find("from frame b on"), std::string::npos);
}

TEST(SynchronyOfASequence, IsLostByAsManyFramesAsItSays) {
  const Sequence sequence(16);
  for (const int late : {-2, -1, 1, 2}) {
    const Synchrony measured = measure_synchrony(sequence.pairs(late), {});
    EXPECT_EQ(measured.lag(), late);
    const auto finding = diagnose(measured);
    ASSERT_TRUE(finding);
    EXPECT_EQ(static_cast<int>(finding->severity), static_cast<int>(Severity::broken));
    EXPECT_EQ(finding->value, late);
  }
}

TEST(SynchronyOfASequence, DetectsACameraThatRepeatsItsImage) {
  const Sequence sequence(14);
  std::vector<StereoPair> pairs = sequence.pairs(0);
  pairs[5] = StereoPair::from(pairs[5].left(), pairs[4].right());
  const Synchrony measured = measure_synchrony(pairs, {});
  EXPECT_EQ(measured.right_repeats, 1);
  EXPECT_EQ(measured.left_repeats, 0);
  EXPECT_TRUE(diagnose(measured));
}

TEST(SynchronyOfASequence, NeedsNoSequence) {
  EXPECT_FALSE(diagnose(measure_synchrony({}, {})));
  const Sequence one(1);
  EXPECT_FALSE(diagnose(measure_synchrony(one.pairs(0), {})));
}

}  // namespace
}  // namespace cairn
