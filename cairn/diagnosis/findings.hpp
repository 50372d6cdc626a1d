// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cairn/core/fields.hpp>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace cairn {

/// note: worth knowing; warning: results suffer; broken: no result can be trusted before it is mended.
enum class Severity : std::uint8_t { note, warning, broken };
inline constexpr std::array kSeverities{Choice<Severity>{"note", Severity::note},
                                        Choice<Severity>{"warning", Severity::warning},
                                        Choice<Severity>{"broken", Severity::broken}};

/// What may be wrong with a rig. The order is that of a report: a cause before what follows from it.
enum class FindingKind : std::uint8_t {
  sizes,
  impossible_calibration,
  calibration,
  raw_calibration,
  few_points,
  nothing_in_common,
  same_picture,
  swapped,
  synchrony,
  unknown_synchrony,
  rectification,
  rows,
  range_too_small,
  range_too_large,
  behind_infinity,
  exposure,
  dark,
  brightness,
  blur,
  no_floor
};

/// What is known of a kind beforehand. The number's meaning and unit are those of Finding::value.
struct FindingInfo {
  FindingKind kind;
  std::string_view name;
  std::string_view number;
  std::string_view unit;
  std::string_view remedy;
};
inline constexpr std::array kFindings{
    FindingInfo{FindingKind::sizes, "sizes", "the right picture's area over the left one's", "",
                "Set both cameras to the same resolution and binning, and rectify both to one size."},
    FindingInfo{
        FindingKind::impossible_calibration, "impossible calibration", "the number that cannot be",
        "as the file says",
        "Correct the file: focal length and baseline are positive; a negative baseline means that left "
        "and right stand in the wrong order."},
    FindingInfo{
        FindingKind::calibration, "calibration contradicts the picture", "the number that cannot be",
        "see the sentence",
        "Give the calibration that was made for these pictures, at their size, with lengths in metres "
        "and pixels."},
    FindingInfo{FindingKind::raw_calibration, "calibration of raw cameras", "rows that the pictures are off",
                "rows",
                "Rectify the pictures with it (cairn rectify), and use the calib.txt that is written beside "
                "them."},
    FindingInfo{FindingKind::few_points, "too little to see", "textured points found in both pictures",
                "points",
                "Point the cameras at something with texture, in good light, and run the doctor again: it "
                "cannot judge rows, order and range on this."},
    FindingInfo{FindingKind::nothing_in_common, "pictures do not match", "points that agree on one geometry",
                "%",
                "See whether both pictures show the same scene at the same moment, neither upside down nor "
                "mirrored; then whether the pair was rectified at all (cairn rectify)."},
    FindingInfo{FindingKind::same_picture, "the two pictures are the same", "points with a disparity of 0",
                "%",
                "Give each camera's own picture: see whether both names lead to one file, and whether both "
                "drivers open one camera."},
    FindingInfo{FindingKind::swapped, "cameras swapped", "points with a negative disparity", "%",
                "Exchange the two pictures, or the cameras' cables or names, and calibrate anew if the "
                "calibration was made like this. Both pictures upside down, or both mirrored, look the same: "
                "see that they stand upright."},
    FindingInfo{FindingKind::synchrony, "not synchronised", "frames that the right camera lags behind",
                "frames",
                "Trigger both cameras by one signal, and pair pictures by their time stamps, not by their "
                "order of arrival."},
    FindingInfo{FindingKind::unknown_synchrony, "synchrony not seen",
                "correlation of the changes in both pictures as they are", "%",
                "Nothing to mend: to have it checked, give a sequence in which something moves fast and not "
                "evenly (wave a hand before both cameras)."},
    FindingInfo{FindingKind::rectification, "not rectified",
                "rows that 1 in 10 points is still off once shift and roll are taken back", "rows",
                "Rectify the pair with its calibration (cairn rectify); if it is rectified, calibrate anew "
                "(cairn calibrate): a lens or a mount has moved."},
    FindingInfo{
        FindingKind::rows, "rows misaligned", "rows that the right picture is off, at the worse side", "rows",
        "Rectify the pair with its calibration (cairn rectify); if it is rectified, calibrate anew (cairn "
        "calibrate) and tighten the mounts. Up to epipolar_correction.max_rows the preset default takes "
        "shift "
        "and roll back by itself, for some time per frame."},
    FindingInfo{FindingKind::range_too_small, "disparity range too small", "points outside the range", "%",
                "Widen the range: set match.min_disparity and match.num_disparities (or ndisp in the "
                "calibration) as the sentence says."},
    FindingInfo{FindingKind::range_too_large, "disparity range too large", "the range's use", "%",
                "Narrow the range: it costs time and invites false matches. Leave it where nearer things are "
                "still to come."},
    FindingInfo{
        FindingKind::behind_infinity, "points behind infinity", "points with d + doffs below -1 px", "%",
        "Check doffs in the calibration (cx of the right camera less cx of the left one), and whether "
        "the rectification shifts one picture."},
    FindingInfo{FindingKind::exposure, "clipped exposure", "pixels at the first or last grey level", "%",
                "Shorten (white) or lengthen (black) the exposure, or lower the gain: nothing can be matched "
                "where the level does not change."},
    FindingInfo{FindingKind::dark, "little contrast",
                "grey levels between the darkest and the brightest hundredth", "grey levels",
                "Lengthen the exposure or add light; noise and rounding are as strong as texture here."},
    FindingInfo{FindingKind::brightness, "cameras see unequal brightness",
                "how much the right picture differs, in the middle", "grey levels",
                "Lock exposure, gain and white balance of both cameras to the same values."},
    FindingInfo{FindingKind::blur, "blurred", "pixels that an edge takes", "px",
                "Focus the camera, clean its lens, or shorten the exposure if it moves."},
    FindingInfo{FindingKind::no_floor, "no floor", "pixels with a disparity", "%",
                "Where the picture shows a floor, say in the calibration how the camera is mounted and set "
                "ground.source=pose, or add light; where it shows none, nothing needs mending."}};

constexpr const FindingInfo& info(FindingKind kind) {
  return kFindings[static_cast<std::size_t>(kind)];
}

/// Whose picture shows it; both or neither: it is said of the pair.
enum class Camera : std::uint8_t { pair, left, right };

/// One thing that is wrong.
struct Finding {
  FindingKind kind = FindingKind::sizes;
  Severity severity = Severity::note;
  double value = 0;                   // see FindingInfo::number and unit
  std::string says;                   // one sentence with the numbers, without a full stop
  std::vector<std::size_t> frames{};  // indices of the pairs that show it
  Camera camera = Camera::pair;
};

/// The findings of many pairs by kind, in the order of kFindings, each with the severity, number and sentence
/// of the pair where it is worst, and all pairs that show it; where it is one camera there and the other one
/// in other pairs, the sentence says so. A range is too large only where it is so for every pair that could
/// tell.
std::vector<Finding> united(const std::vector<std::vector<Finding>>& of_pairs);

}  // namespace cairn
