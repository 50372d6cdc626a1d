// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cairn/core/exec.hpp>
#include <cairn/core/fields.hpp>
#include <cairn/core/stereo_pair.hpp>
#include <cairn/stereo/match.hpp>
#include <cstdint>

namespace cairn {

struct EpipolarCorrectionConfig {
  float max_rows = -1;  // rows, 0.5 … 8, −1 = off; largest misalignment searched: more for a shaky rig
};
template <class V>
void fields(EpipolarCorrectionConfig& c, V&& v) {
  v("max_rows", c.max_rows, "rows",
    "largest vertical misalignment of the right image that is corrected (vibration)", off_or(0.5F, 8.0F));
}

/// The outcome of the epipolar correction of a frame.
enum class EpipolarOutcome : std::uint8_t { off, few_points, no_agreement, aligned, corrected };
inline constexpr std::array kEpipolarOutcomes{
    Choice<EpipolarOutcome>{"off", EpipolarOutcome::off},
    Choice<EpipolarOutcome>{"too few textured points", EpipolarOutcome::few_points},
    Choice<EpipolarOutcome>{"the points do not agree", EpipolarOutcome::no_agreement},
    Choice<EpipolarOutcome>{"aligned", EpipolarOutcome::aligned},
    Choice<EpipolarOutcome>{"corrected", EpipolarOutcome::corrected}};

/// The row offset of the right image: a point in row y of the left image is at column x and row
///     y + rows + rows_per_px·(x − (width − 1)/2)
/// of the right one. A vertical offset, and a roll by atan(rows_per_px).
struct EpipolarOffset {
  float rows = 0;  // at the centre column
  float rows_per_px = 0;
  int points = 0;    // textured points matched in the right image
  int agreeing = 0;  // matched points within half a row of this offset
  EpipolarOutcome outcome = EpipolarOutcome::off;
};

/// Estimates the row offset of a frame from sparse textured points of the whole image. The points are matched
/// at half resolution, over all disparities of `range` and ± config.max_rows rows, then refined to subpixel
/// accuracy at half and full resolution (Lucas & Kanade 1981; Baker & Matthews 2004). A line is fitted to
/// their row offsets by medians (Theil 1950, Sen 1968), then by least squares to the inliers. The roll is
/// kept only if it is significant and matters; an offset below kEpipolarLeastRows in every column is
/// `aligned`. Too few points, or fewer than half of them inliers: no offset.
/// (docs/stages/epipolar_correction.md)
EpipolarOffset find_epipolar_offset(const StereoPair& pair, const MatchConfig& range,
                                    const EpipolarCorrectionConfig& config, const Exec& exec);

/// Rows. A smaller shift of the image has no benefit and blurs it.
inline constexpr float kEpipolarLeastRows = 0.25F;

/// The right image shifted by `offset`, so that its rows match those of the left image. The pixel in column
/// x, row y is interpolated at row
///     y + rows + rows_per_px·(x − (width − 1)/2)
/// to 1/64 row, by the cubic through four rows (Keys 1981, a = −3/4, a sharp one) with weights in 1/64; the
/// second weight absorbs the rounding. Rows beyond the border are replicated.
Image<Gray> shift_rows(View<const Gray> right, const EpipolarOffset& offset, const Exec& exec);

struct EpipolarCorrection {
  EpipolarOffset offset;
  Image<Gray> right;  // shifted; empty if the pair needs no correction
};

/// Estimates and corrects a small misalignment of the two cameras, as vibration causes it, before matching.
EpipolarCorrection correct_epipolar(const StereoPair& pair, const MatchConfig& range,
                                    const EpipolarCorrectionConfig& config, const Exec& exec);

}  // namespace cairn
