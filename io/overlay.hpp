// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cairn/core/image.hpp>
#include <cairn/core/stereo_pair.hpp>
#include <cairn/disparity/disparity_map.hpp>
#include <cairn/objects/measure.hpp>
#include <cstdint>
#include <optional>
#include <vector>

/// Pictures to look at. Small frames are drawn enlarged by a whole factor, so that labels stay legible.
namespace cairn::io {

/// The left picture, its background faded: every object tinted, outlined and labelled with its id and
/// distance (in m; without a calibration its disparity in px), the floor (non-zero; may be empty) faintly
/// tinted; below it a legend. A dim picture is brightened, up to eightfold. `left_rgb` may be empty.
Image<Rgb> draw_objects(View<const Gray> left, View<const Rgb> left_rgb, const Objects& objects,
                        View<const std::uint8_t> floor);

/// Disparity as colour, holes in a muted colour that tells the reason, and beside them a legend: the scale in
/// px (with a rig: and m), and the share of the pixels of each reason `in_force`. Where a hole has several
/// reasons the legend's order decides.
Image<Rgb> draw_disparity(const DisparityMap& map, const std::optional<StereoRig>& rig,
                          Reject in_force = Reject{0xFFFF});

/// The colour that an object is drawn with: neighbouring ids differ strongly.
Rgb object_colour(ObjectId id);

/// The pixels of one id within `box`, as 255.
template <class Id>
Image<std::uint8_t> mask_of(View<const Id> labels, Id id, Rect box) {
  Image<std::uint8_t> mask({box.width, box.height});
  for (int y = 0; y < box.height; ++y) {
    for (int x = 0; x < box.width; ++x) mask(x, y) = labels(box.x + x, box.y + y) == id ? 255 : 0;
  }
  return mask;
}

/// The pixel of a mask (non-zero) that lies farthest from its outline: a place for a label.
struct LabelPlace {
  int x = 0;
  int y = 0;
};
LabelPlace label_place(View<const std::uint8_t> mask);

/// Where labels of these sizes go that would like to be at these places: earlier ones first, each as near as
/// it can be to its own without covering another. All are moved into the picture as far as they fit; one that
/// finds no free place stays at its own.
std::vector<Rect> place_labels(const std::vector<Rect>& wanted, Size picture);

/// The disparities that the scale of colours spans: from the 1st to the 99th percentile, so that a few wrong
/// matches do not take the colours from the rest.
struct DisparitySpan {
  float low = 0;
  float high = 1;
};
DisparitySpan disparity_span(View<const float> disparity_px);
/// The scale's colours, the lowest disparity first.
std::array<Rgb, 256> disparity_colours();

}  // namespace cairn::io
