// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/diagnosis/correspondences.hpp>
#include <cairn/diagnosis/exposure.hpp>
#include <cairn/diagnosis/findings.hpp>
#include <cairn/diagnosis/row_alignment.hpp>
#include <cairn/diagnosis/sharpness.hpp>
#include <cairn/pipeline/segment.hpp>
#include <cairn/stereo/match.hpp>
#include <optional>
#include <string_view>
#include <vector>

namespace cairn {

/// The limits of the diagnosis. Each pair of limits is (warning, broken).
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
  float note_below_floor = 25;
};
template <class V>
void fields(DiagnosisConfig& c, V&& v) {
  v("least_points", c.least_points, "points", "fewest consistent points for any judgement", range(8, 500));
  v("least_textured", c.least_textured, "points", "number of textured points from which on images must match",
    range(8, 500));
  v("least_agreeing", c.least_agreeing, "%", "smallest share of matched points consistent with one geometry",
    range(0.0F, 100.0F));
  v("least_certain", c.least_certain, "points",
    "fewest consistent points to judge camera order, range and distances", range(8, 500));
  v("least_certain_share", c.least_certain_share, "%",
    "smallest share of consistent points, as an alternative", range(0.0F, 100.0F));
  v("warn_rows", c.warn_rows, "rows", "shift and roll at the worse side of the image: warning",
    range(0.0F, 100.0F));
  v("break_rows", c.break_rows, "rows", "shift and roll beyond the epipolar correction: broken",
    range(0.0F, 100.0F));
  v("warn_left_over", c.warn_left_over, "rows", "misalignment left after shift and roll: warning",
    range(0.0F, 100.0F));
  v("break_left_over", c.break_left_over, "rows", "misalignment left after shift and roll: broken",
    range(0.0F, 100.0F));
  v("warn_behind", c.warn_behind, "%", "points behind infinity: warning", range(0.0F, 100.0F));
  v("break_behind", c.break_behind, "%", "points behind infinity: broken", range(0.0F, 100.0F));
  v("break_swapped", c.break_swapped, "%", "points with a negative disparity: cameras swapped",
    range(0.0F, 100.0F));
  v("break_same", c.break_same, "%", "points with a disparity of 0: one image given twice",
    range(0.0F, 100.0F));
  v("warn_beyond", c.warn_beyond, "%", "points outside the disparity range: warning", range(0.0F, 100.0F));
  v("break_beyond", c.break_beyond, "%", "points outside the disparity range: broken", range(0.0F, 100.0F));
  v("warn_at_end", c.warn_at_end, "%", "disparities in the last 2 px of the range: warning",
    range(0.0F, 100.0F));
  v("least_range_use", c.least_range_use, "%", "largest disparity, as a share of a range above 64: note",
    range(0.0F, 100.0F));
  v("warn_clipped", c.warn_clipped, "%", "black or white pixels: warning", range(0.0F, 100.0F));
  v("break_clipped", c.break_clipped, "%", "black or white pixels: broken", range(0.0F, 100.0F));
  v("least_contrast", c.least_contrast, "grey levels", "smallest contrast without a warning",
    range(0.0F, 255.0F));
  v("warn_brightness", c.warn_brightness, "grey levels", "median difference of brightness: warning",
    range(0.0F, 255.0F));
  v("warn_edge", c.warn_edge, "px", "width of the sharpest quarter of the edges: warning",
    range(1.0F, 100.0F));
  v("warn_edge_ratio", c.warn_edge_ratio, "", "ratio of the edge widths of the two cameras: warning",
    range(1.0F, 100.0F));
  v("least_unequal_edge", c.least_unequal_edge, "px", "narrowest edge width for a warning about the ratio",
    range(1.0F, 100.0F));
  v("warn_baseline", c.warn_baseline, "m", "longest plausible baseline (longer: in centimetres?)",
    range(0.0F, 1e6F));
  v("warn_nearest", c.warn_nearest, "m", "nearest point that makes a baseline above 1 m implausible",
    range(0.0F, 1e6F));
  v("note_below_floor", c.note_below_floor, "%", "pixels refused as below the floor: note",
    range(0.0F, 100.0F));
}

/// All measurements of one pair.
struct PairMeasures {
  Size size;
  bool identical = false;   // both images are equal, pixel for pixel
  int textured_points = 0;  // of the left image
  RowAlignment rows;
  std::vector<float> disparities_px;  // of consistent points with similar neighbours, ascending
  // Correlation of these disparities with the row: the floor makes it positive, and negative if the cameras are
  // swapped; 0 if unknown.
  float nearer_below = 0;
  // If the points move along columns rather than rows: their median y_right − y_left.
  std::optional<float> vertical_rows;
  BrightnessDifference brightness;
  Exposure left_exposure;
  Exposure right_exposure;
  Sharpness left_sharpness;
  Sharpness right_sharpness;

  /// The disparity below which `share` of the points (0 … 1) lie; NaN without points.
  [[nodiscard]] double disparity_px(double share) const;
};
PairMeasures measure_pair(const StereoPair& pair, const Exec& exec);

/// The faults of a pair, in the order of kFindings; empty for a good pair. `range` holds the disparities to
/// be searched; without `rig` the calibration is not judged.
std::vector<Finding> diagnose(const PairMeasures& measures, const std::optional<StereoRig>& rig,
                              const MatchConfig& range, const DiagnosisConfig& config);

/// A check for which diagnose() had not enough data.
struct SkippedCheck {
  std::string_view check;
  std::string why;                // what was found, what was expected
  bool is_for_want_of_it = true;  // too little in the images; false: its input was not given
};
std::vector<SkippedCheck> not_checked(const PairMeasures& measures, const std::optional<StereoRig>& rig,
                                      const DiagnosisConfig& config);

/// diagnose() from the results of segment() for a frame, at almost no cost: rows from the epipolar
/// correction, the range from the share of disparities at its end, exposure, calibration, and why there is no
/// floor. Order, synchrony, brightness and focus are not judged. `right` is empty if the disparity was given.
std::vector<Finding> diagnose(const Frame& frame, View<const Gray> left, View<const Gray> right,
                              const std::optional<StereoRig>& rig, const Config& config,
                              const DiagnosisConfig& limits);

/// Whether a segmented frame suggests swapped cameras, a pair that is not rectified or a wrong range, so that
/// measure_pair() is worth its time: the epipolar correction found no common rows or, if it is off, fewer
/// than a quarter of the pixels have a disparity.
bool is_doubtful(const Frame& frame);

}  // namespace cairn
