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

/// note: worth knowing; warning: results suffer; broken: results cannot be trusted until it is fixed.
enum class Severity : std::uint8_t { note, warning, broken };
inline constexpr std::array kSeverities{Choice<Severity>{"note", Severity::note},
                                        Choice<Severity>{"warning", Severity::warning},
                                        Choice<Severity>{"broken", Severity::broken}};

/// The faults of a rig, in the order of a report: causes before consequences.
enum class FindingKind : std::uint8_t {
  sizes,
  impossible_calibration,
  calibration,
  raw_calibration,
  no_metres,
  given_disparity,
  few_points,
  nothing_in_common,
  one_above_other,
  same_picture,
  swapped,
  synchrony,
  unknown_synchrony,
  rectification,
  rows,
  range_too_small,
  range_too_large,
  behind_infinity,
  border,
  exposure,
  dark,
  brightness,
  blur,
  no_floor,
  below_floor
};

/// The fixed texts of a kind. `number` and `unit` describe Finding::value.
struct FindingInfo {
  FindingKind kind;
  std::string_view name;
  std::string_view number;
  std::string_view unit;
  std::string_view remedy;
};
inline constexpr std::array kFindings{
    FindingInfo{FindingKind::sizes, "image sizes differ", "area of the right image over that of the left", "",
                "Set both cameras to the same resolution and binning, and rectify both to one size."},
    FindingInfo{
        FindingKind::impossible_calibration, "invalid calibration", "the impossible number", "as in the file",
        "Correct the file: focal length and baseline are positive; a negative baseline means that left "
        "and right are exchanged."},
    FindingInfo{
        FindingKind::calibration, "implausible calibration", "the implausible number", "see the message",
        "Give the calibration that was made for these images, at their size, with lengths in metres and "
        "pixels."},
    FindingInfo{FindingKind::raw_calibration, "calibration of raw cameras", "row misalignment of the images",
                "rows",
                "Rectify the images with it (cairn rectify), and use the calib.txt that is written next to "
                "them."},
    FindingInfo{
        FindingKind::no_metres, "no metres", "baseline", "m",
        "Give the calibration (--calib), with a baseline; a recording and topics need the camera_info of "
        "both cameras."},
    FindingInfo{
        FindingKind::given_disparity, "no disparity of these images",
        "points at which the given disparity fits both images", "%",
        "Give the disparities of the left image in px, not depth: in a PNG px * 256, in a PFM the lowest "
        "row first."},
    FindingInfo{
        FindingKind::few_points, "too little texture", "textured points found in both images", "points",
        "Point the cameras at a textured scene in good light, and run the doctor again: this pair does "
        "not suffice to judge rows, order and range."},
    FindingInfo{FindingKind::nothing_in_common, "images do not match", "points consistent with one geometry",
                "%",
                "Check that both images show the same scene at the same moment, neither upside down nor "
                "mirrored; then, that the pair was rectified (cairn rectify)."},
    FindingInfo{
        FindingKind::one_above_other, "cameras one above the other", "median row difference of the points",
        "rows",
        "Rotate both images as the message says, and calibrate the rotated ones; if the cameras are side "
        "by side, their images are turned, or their rows are far from rectified (cairn rectify)."},
    FindingInfo{FindingKind::same_picture, "identical images", "points with a disparity of 0", "%",
                "Give the image of each camera: check whether both names lead to one file, and whether both "
                "drivers open one camera."},
    FindingInfo{FindingKind::swapped, "cameras swapped", "points with a negative disparity", "%",
                "Exchange the two images, or the cables or names of the cameras, and calibrate again if the "
                "calibration was made like this. Both images upside down, or both mirrored, look the same: "
                "check that they are upright."},
    FindingInfo{
        FindingKind::synchrony, "not synchronised", "lag of the right camera in frames", "frames",
        "Trigger both cameras by one signal, and pair images by their time stamps, not by their order "
        "of arrival."},
    FindingInfo{FindingKind::unknown_synchrony, "synchronisation undetermined",
                "correlation of the changes in both images without lag", "%",
                "Nothing to fix: to have it checked, give a sequence with fast, uneven motion (wave a hand "
                "before both cameras)."},
    FindingInfo{FindingKind::rectification, "not rectified",
                "row error exceeded by 1 in 10 points, without shift and roll", "rows",
                "Rectify the pair with its calibration (cairn rectify); if it is rectified, calibrate again "
                "(cairn calibrate): a lens or a mount has moved."},
    FindingInfo{
        FindingKind::rows, "rows misaligned", "row misalignment of the right image at its worse side", "rows",
        "Rectify the pair with its calibration (cairn rectify); if it is rectified, calibrate again (cairn "
        "calibrate) and tighten the mounts. The preset default corrects shift and roll up to "
        "epipolar_correction.max_rows, at some cost per frame."},
    FindingInfo{FindingKind::range_too_small, "disparity range too small", "points outside the range", "%",
                "Widen the range: set match.min_disparity and match.num_disparities (or ndisp in the "
                "calibration) as the message says."},
    FindingInfo{FindingKind::range_too_large, "disparity range too large", "used share of the range", "%",
                "Narrow the range: it costs time and invites false matches. Leave it if nearer objects are "
                "expected."},
    FindingInfo{
        FindingKind::behind_infinity, "points behind infinity", "points with d + doffs below -1 px", "%",
        "Check doffs in the calibration (cx of the right camera minus cx of the left one), and whether the "
        "rectification shifts one image."},
    FindingInfo{
        FindingKind::border, "black borders", "pixels of the border", "%",
        "Nothing to fix: rectification leaves them where the camera saw nothing. A smaller field of view, "
        "or cropping both images alike, saves the time that they cost."},
    FindingInfo{
        FindingKind::exposure, "clipped exposure", "pixels at the first or last grey level", "%",
        "Shorten (white) or lengthen (black) the exposure, or lower the gain: clipped areas cannot be "
        "matched."},
    FindingInfo{FindingKind::dark, "low contrast", "grey levels between the 1st and the 99th percentile",
                "grey levels",
                "Lengthen the exposure or add light; noise and rounding are as strong as texture here."},
    FindingInfo{FindingKind::brightness, "unequal brightness", "median difference of the right image",
                "grey levels", "Lock exposure, gain and white balance of both cameras to the same values."},
    FindingInfo{FindingKind::blur, "blurred", "width of an edge", "px",
                "Focus the camera, clean its lens, or shorten the exposure if it moves."},
    FindingInfo{FindingKind::no_floor, "no floor", "pixels with a disparity", "%",
                "If the image shows a floor, state in the calibration how the camera is mounted and set "
                "ground.source=pose, or add light; otherwise there is nothing to fix."},
    FindingInfo{
        FindingKind::below_floor, "much below the floor", "pixels refused as below the floor", "%",
        "Look at floor.png and reject.png: a mirroring floor, or a table's edge, needs nothing; if the "
        "plane is no floor, set ground.source=pose, points or off."}};

constexpr const FindingInfo& info(FindingKind kind) {
  return kFindings[static_cast<std::size_t>(kind)];
}

/// The camera at fault; pair: both or neither.
enum class Camera : std::uint8_t { pair, left, right };

/// One fault.
struct Finding {
  FindingKind kind = FindingKind::sizes;
  Severity severity = Severity::note;
  double value = 0;                   // see FindingInfo::number and unit
  std::string says;                   // one sentence with the numbers, without a full stop
  std::vector<std::size_t> frames{};  // indices of the pairs with this fault
  Camera camera = Camera::pair;
};

/// The findings of many pairs by kind, in the order of kFindings, each with severity, number and sentence of
/// the first pair with the highest severity, and all pairs with it. If the fault is with one camera there and
/// with the other in other pairs, the sentence says so. A range is too large only if it is so for every pair
/// that could tell.
std::vector<Finding> united(const std::vector<std::vector<Finding>>& of_pairs);

}  // namespace cairn
