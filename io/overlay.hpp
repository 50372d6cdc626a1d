// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/image.hpp>
#include <cairn/core/stereo_pair.hpp>
#include <cairn/disparity/disparity_map.hpp>
#include <cairn/objects/measure.hpp>
#include <optional>

/// Pictures to look at. Small frames are drawn enlarged by a whole factor, so that labels stay legible.
namespace cairn::io {

/// The left picture, its background faded: every object tinted, outlined and labelled with its id and
/// distance (in m; without a calibration its disparity in px), the floor (non-zero; may be empty) faintly
/// tinted. `left_rgb` may be empty.
Image<Rgb> draw_objects(View<const Gray> left, View<const Rgb> left_rgb, const Objects& objects,
                        View<const std::uint8_t> floor);

/// Disparity as colour, holes in a muted colour that tells the reason, and beside them a legend: the scale in
/// px (with a rig: and m), and each reason's share of the pixels. Where a hole has several reasons the
/// legend's order decides.
Image<Rgb> draw_disparity(const DisparityMap& map, const std::optional<StereoRig>& rig);

/// The colour that an object is drawn with: neighbouring ids differ strongly.
Rgb object_colour(ObjectId id);

}  // namespace cairn::io
