// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/diagnosis/correspondences.hpp>
#include <cairn/diagnosis/exposure.hpp>
#include <cairn/diagnosis/findings.hpp>
#include <cairn/diagnosis/row_alignment.hpp>
#include <cairn/diagnosis/sharpness.hpp>
#include <cairn/matching/match.hpp>
#include <cairn/pipeline/segment.hpp>
#include <optional>
#include <string_view>
#include <vector>

namespace cairn {

/// From which number on something is found. Each pair of limits is (warning, broken).
struct DiagnosisConfig {
  int least_points = 8;
  int least_textured = 60;
  float least_agreeing = 40;
  int least_certain = 30;
  float least_certain_share = 80;
  float warn_rows = 0.75F;
  float break_rows = 4.5F;
  float warn_left_over = 1;
  float break_left_over = 2.5F;
  float warn_behind = 10;
  float break_behind = 60;
  float break_swapped = 60;
  float break_same = 95;
  float warn_beyond = 4;
  float break_beyond = 50;
  float warn_at_end = 5;
  float least_range_use = 20;
  float warn_clipped = 20;
  float break_clipped = 60;
  float least_contrast = 40;
  float warn_brightness = 12;
  float warn_edge = 4.5F;
  float warn_edge_ratio = 1.6F;
  float least_unequal_edge = 3.5F;
  float warn_baseline = 3;
  float warn_nearest = 30;
};
template <class V>
void fields(DiagnosisConfig& c, V&& v) {
  v("least_points", c.least_points, "points", "fewer that agree on one geometry judge nothing",
    range(8, 500));
  v("least_textured", c.least_textured, "points", "so many textured points must give that many",
    range(8, 500));
  v("least_agreeing", c.least_agreeing, "%", "points found that must agree on one geometry",
    range(0.0F, 100.0F));
  v("least_certain", c.least_certain, "points",
    "so many that agree are enough to judge order, range and distances", range(8, 500));
  v("least_certain_share", c.least_certain_share, "%", "so large a share of the points found is enough, too",
    range(0.0F, 100.0F));
  v("warn_rows", c.warn_rows, "rows", "shift and roll, at the worse side, from which on it is a warning",
    range(0.0F, 100.0F));
  v("break_rows", c.break_rows, "rows", "the same, broken: beyond what the epipolar correction takes back",
    range(0.0F, 100.0F));
  v("warn_left_over", c.warn_left_over, "rows", "what shift and roll leave, from which on it is a warning",
    range(0.0F, 100.0F));
  v("break_left_over", c.break_left_over, "rows", "the same, broken", range(0.0F, 100.0F));
  v("warn_behind", c.warn_behind, "%", "points behind infinity, from which on it is a warning",
    range(0.0F, 100.0F));
  v("break_behind", c.break_behind, "%", "the same, broken", range(0.0F, 100.0F));
  v("break_swapped", c.break_swapped, "%", "points with a negative disparity that mean swapped cameras",
    range(0.0F, 100.0F));
  v("break_same", c.break_same, "%", "points with a disparity of 0 that mean one picture given twice",
    range(0.0F, 100.0F));
  v("warn_beyond", c.warn_beyond, "%", "points outside the disparity range, from which on it is a warning",
    range(0.0F, 100.0F));
  v("break_beyond", c.break_beyond, "%", "the same, broken", range(0.0F, 100.0F));
  v("warn_at_end", c.warn_at_end, "%",
    "disparities of a segmented frame in the last 2 px of the range that are a warning", range(0.0F, 100.0F));
  v("least_range_use", c.least_range_use, "%",
    "largest disparity, of a range of more than 64, that is a note", range(0.0F, 100.0F));
  v("warn_clipped", c.warn_clipped, "%", "black or white pixels, from which on it is a warning",
    range(0.0F, 100.0F));
  v("break_clipped", c.break_clipped, "%", "the same, broken", range(0.0F, 100.0F));
  v("least_contrast", c.least_contrast, "grey levels", "less contrast is a warning", range(0.0F, 255.0F));
  v("warn_brightness", c.warn_brightness, "grey levels",
    "difference of brightness, in the middle, from which on it is a warning", range(0.0F, 255.0F));
  v("warn_edge", c.warn_edge, "px", "width of the sharpest quarter of the edges that is a warning",
    range(1.0F, 100.0F));
  v("warn_edge_ratio", c.warn_edge_ratio, "", "of one camera's edges to the other's that is a warning",
    range(1.0F, 100.0F));
  v("least_unequal_edge", c.least_unequal_edge, "px", "narrower edges are none, whatever the other camera's",
    range(1.0F, 100.0F));
  v("warn_baseline", c.warn_baseline, "m", "a longer baseline is a warning: in centimetres?",
    range(0.0F, 1e6F));
  v("warn_nearest", c.warn_nearest, "m", "points no nearer, with a baseline of 1 m or more, are the same",
    range(0.0F, 1e6F));
}

/// All that is measured of one pair.
struct PairMeasures {
  Size size;
  bool identical = false;   // the right image is the left one, pixel for pixel
  int textured_points = 0;  // of the left image
  RowAlignment rows;
  std::vector<float> disparities_px;  // of the points that agree and are not alone with it, ascending
  BrightnessDifference brightness;
  Exposure left_exposure;
  Exposure right_exposure;
  Sharpness left_sharpness;
  Sharpness right_sharpness;

  /// The disparity that `share` of the points (0 … 1) stay below; NaN without points.
  [[nodiscard]] double disparity_px(double share) const;
};
PairMeasures measure_pair(const StereoPair& pair, const Exec& exec);

/// What is wrong with a pair, in the order of kFindings; nothing for a good one. `range` says which
/// disparities would be tried; without `rig` nothing is said of a calibration.
std::vector<Finding> diagnose(const PairMeasures& measures, const std::optional<StereoRig>& rig,
                              const MatchConfig& range, const DiagnosisConfig& config);

/// A check that diagnose() could not do.
struct NotChecked {
  std::string_view check;
  std::string why;                // what was found, what was expected
  bool is_for_want_of_it = true;  // the pictures show too little; false: what it checks was not given
};
std::vector<NotChecked> not_checked(const PairMeasures& measures, const std::optional<StereoRig>& rig,
                                    const DiagnosisConfig& config);

/// diagnose() from what segment() has computed of a frame, for nearly no time: rows from the epipolar
/// correction, the range from the share of disparities at its end, exposure, calibration, and why there is no
/// floor. Order, synchrony, brightness and focus are not judged. `right` is empty where the disparity was
/// given.
std::vector<Finding> diagnose(const Frame& frame, View<const Gray> left, View<const Gray> right,
                              const std::optional<StereoRig>& rig, const Config& config,
                              const DiagnosisConfig& limits);

/// Whether a segmented frame looks as if the cameras were swapped, the pair not rectified or the range wrong,
/// so that measure_pair() is worth its time: the epipolar correction found no common rows or, where that is
/// off, fewer than a quarter of the pixels have a disparity.
bool is_doubtful(const Frame& frame);

}  // namespace cairn
