// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cairn/core/exec.hpp>
#include <cairn/core/fields.hpp>
#include <cairn/core/stereo_pair.hpp>
#include <cairn/matching/match.hpp>
#include <cstdint>

namespace cairn {

struct EpipolarCorrectionConfig {
  float max_rows = -1;  // rows, 0.5 … 8, −1 = off; the largest misalignment looked for: more for a shaky rig
};
template <class V>
void fields(EpipolarCorrectionConfig& c, V&& v) {
  v("max_rows", c.max_rows, "rows",
    "largest misalignment of the right image's rows that is looked for and taken back (vibration)",
    off_or(0.5F, 8.0F));
}

/// What became of a frame's epipolar correction.
enum class EpipolarOutcome : std::uint8_t { off, few_points, no_agreement, aligned, corrected };
inline constexpr std::array kEpipolarOutcomes{
    Choice<EpipolarOutcome>{"off", EpipolarOutcome::off},
    Choice<EpipolarOutcome>{"too few textured points", EpipolarOutcome::few_points},
    Choice<EpipolarOutcome>{"the points do not agree", EpipolarOutcome::no_agreement},
    Choice<EpipolarOutcome>{"aligned", EpipolarOutcome::aligned},
    Choice<EpipolarOutcome>{"corrected", EpipolarOutcome::corrected}};

/// How far the right image's rows are off: what the left image shows in row y stands in column x of the right
/// one at row y + rows + rows_per_px·(x − (width − 1)/2). A vertical offset, and a roll by atan(rows_per_px).
struct EpipolarOffset {
  float rows = 0;  // in the middle column
  float rows_per_px = 0;
  int points = 0;    // textured points that were found again in the right image
  int agreeing = 0;  // those of them within half a row of this offset
  EpipolarOutcome outcome = EpipolarOutcome::off;
};

/// Finds the frame's offset from a sparse set of textured points all over the image. They are looked for at
/// half resolution, over all disparities of `range` and config.max_rows up and down, then placed between the
/// pixels there and in the full images (Lucas & Kanade 1981; Baker & Matthews 2004). A line is laid through
/// their rows by medians (Theil 1950, Sen 1968), then by least squares through those that agree with it. The
/// roll is kept only where it is certain and matters; an offset that moves no column by kEpipolarLeastRows is
/// `aligned`. Too few points, or less than half of them in agreement: no offset.
/// (docs/stages/epipolar_correction.md)
EpipolarOffset find_epipolar_offset(const StereoPair& pair, const MatchConfig& range,
                                    const EpipolarCorrectionConfig& config, const Exec& exec);

/// Rows; to move an image by less gains nothing, and blurs it.
inline constexpr float kEpipolarLeastRows = 0.25F;

/// The right image moved back by `offset`, so that its rows are the left one's. Column x takes, at every y,
/// what stands at y + rows + rows_per_px·(x − (width − 1)/2), to 1/64 row, through the cubic of four rows
/// (Keys 1981, a = −3/4: a sharp one), its weights in 1/64 with the second making up what rounding leaves.
/// Rows beyond the border repeat it.
Image<Gray> shift_rows(View<const Gray> right, const EpipolarOffset& offset, const Exec& exec);

struct EpipolarCorrection {
  EpipolarOffset offset;
  Image<Gray> right;  // moved; empty where the pair is to be matched as it is
};

/// Both: compensates a small misalignment of the two cameras, as vibration makes them, before the matching.
EpipolarCorrection correct_epipolar(const StereoPair& pair, const MatchConfig& range,
                                    const EpipolarCorrectionConfig& config, const Exec& exec);

}  // namespace cairn
