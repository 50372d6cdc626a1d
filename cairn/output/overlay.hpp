// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cairn/core/image.hpp>
#include <cairn/core/stereo_pair.hpp>
#include <cairn/objects/ground_steps.hpp>
#include <cairn/objects/measure.hpp>
#include <cairn/stereo/disparity_map.hpp>
#include <cstdint>
#include <optional>
#include <vector>

/// Images for viewing. Small frames are enlarged by an integer factor, so that labels stay legible.
namespace cairn::output {

/// A step of the ground as a line in the left image.
struct DrawnStep {
  float from_x = 0;  // px
  float from_y = 0;
  float to_x = 0;
  float to_y = 0;
  float height_m = 0;  // negative: a step down
};
/// The lines of steps that the camera sees.
std::vector<DrawnStep> drawn_steps(const std::vector<GroundStep>& steps, const FloorFrame& floor,
                                   const StereoRig& rig);

/// The left image, its background faded: every object tinted, outlined and labelled with its id and distance
/// (in m; without a calibration its disparity in px), the floor (non-zero; may be empty) faintly tinted, steps of the
/// ground as lines labelled with their heights; with a legend below. A dark image is brightened, up to eightfold.
/// `left_rgb` may be empty.
Image<Rgb> draw_objects(View<const Gray> left, View<const Rgb> left_rgb, const Objects& objects,
                        View<const std::uint8_t> floor, const std::vector<DrawnStep>& steps = {});

/// Disparity in colours, holes in the muted colour of their reason, with a legend: the scale in px (with a
/// rig, also in m), and the share of pixels per reason `in_force`. For several reasons, the first in the
/// order of the legend is shown.
Image<Rgb> draw_disparity(const DisparityMap& map, const std::optional<StereoRig>& rig,
                          Reject in_force = Reject{0xFFFF});

/// The colour of an object: neighbouring ids differ strongly.
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

/// The pixel of a mask (non-zero) farthest from its outline, as position of a label.
struct LabelPlace {
  int x = 0;
  int y = 0;
};
LabelPlace label_place(View<const std::uint8_t> mask);

/// Positions for labels of these sizes near the wanted ones: in order, each as close as possible without
/// covering an earlier one. All are moved into the image as far as they fit; a label without free position
/// stays at the wanted one.
std::vector<Rect> place_labels(const std::vector<Rect>& wanted, Size picture);

/// The range of the colour scale: from the 1st to the 99th percentile, so that outliers do not compress it.
struct DisparitySpan {
  float low = 0;
  float high = 1;
};
DisparitySpan disparity_span(View<const float> disparity_px);
/// The colours of the scale, lowest disparity first.
std::array<Rgb, 256> disparity_colours();

}  // namespace cairn::output
