// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cairn/core/fields.hpp>
#include <cairn/core/stereo_pair.hpp>
#include <cairn/disparity/disparity_map.hpp>
#include <cairn/regions/region_graph.hpp>
#include <optional>
#include <vector>

namespace cairn {

struct ObjectsConfig {
  float min_area = 0.1F;   // % of the image, 0 … 100; less finds smaller objects, and more that are none
  float max_area = 30.0F;  // % of the image, 0 … 100; more for objects close to the camera
  float min_confidence = 0.0F;  // 0 … 1; more: fewer objects, of which more are right
};
template <class V>
void fields(ObjectsConfig& c, V&& v) {
  v("min_area", c.min_area, "% of the image", "smaller regions are no objects", range(0.0F, 100.0F));
  v("max_area", c.max_area, "% of the image", "larger regions are background", range(0.0F, 100.0F),
    when("fusion.method", "overlap"));
  v("min_confidence", c.min_confidence, "", "regions less likely than this to be an object are none",
    range(0.0F, 1.0F));
}

/// From `low` to `high`, which may be infinite.
struct Interval {
  float low = 0;
  float high = 0;
};

/// A box about what is seen of an object, upright on the floor and turned as it is. In the floor's frame (x
/// forward, y left, z up from the floor below the camera): see floor_frame().
struct FloorBox {
  Vec3 centre_in_floor_m;
  Vec3 size_m;        // along its longer side, along its shorter one, up
  float yaw_rad = 0;  // −π/2 < yaw ≤ π/2: of the longer side, counter-clockwise from x as seen from above
  /// Of the centre, m²: xx, xy, xz, yy, yz, zz in the floor's frame.
  std::array<float, 6> centre_covariance_m2{};
};

/// Something that stands or hangs in front of the background.
struct Object {
  ObjectId id = ObjectId::none;
  Rect box_px;
  int pixel_count = 0;
  float disparity_px = 0;  // median of its valid pixels (even number: mean of the middle two)
  float valid_share = 0;   // 0 … 1: pixels of the mask that have a disparity
  Rgb mean_colour;         // of the mask, rounded; grey where the input had no colour
  float edge_share = 0;    // 0 … 1: of its outline, where the picture shows an edge
  float cut_share = 0;     // 0 … 1: of its outline, what lies at the image's border
  float confidence = 0;    // 0 … 1: how likely it covers a true object by more than half (IoU ≥ 0.5)

  // By locate(). What is in metres needs a rig, and a disparity before infinity.
  float disparity_sigma_px = 0;              // standard deviation of disparity_px
  std::optional<Vec3> position_in_camera_m;  // in the middle of its main part, at the depth of disparity_px
  std::optional<Interval> depth_interval_m;  // 95 %: where the z of its position lies
  std::optional<Vec3> extent_in_camera_m;    // of its main part, without wild points
  std::optional<FloorBox> box_on_floor;      // needs a ground, too
};

/// The objects of a frame. labels: ObjectId per pixel, none = no object. list[i].id = i + 1, nearest first
/// (ties of disparity: raster order of the first pixel).
struct Objects {
  Image<ObjectId> labels;
  std::vector<Object> list;
};

/// Turns candidates into objects, but for where they are, which locate() says: regions 0 …
/// is_background.size()−1 that divide the image among them, fused ones or groups. No objects are: what is
/// known to be background, such as the floor; what covers more than max_area of the image or touches three of
/// its borders (background); what is smaller than min_area; what has no valid pixel; what would have a
/// confidence below min_confidence (beyond the paper).
///
/// Confidence is a logistic function of the logarithm of the mask's share of the image, of edge_share and of
/// cut_share; below a valid_share of one half it falls with that, too: what has no disparity is a guess. Its
/// four numbers were fitted on objects found with the default preset; see docs/stages/objects.md.
/// `noise_sigma`: of the left image; a step that stands out of it is an edge.
Objects measure(View<const RegionId> candidates, const std::vector<bool>& is_background,
                const DisparityMap& disparity, View<const Gray> left, View<const Rgb> left_rgb,
                float noise_sigma, const ObjectsConfig& config, const Exec& exec);

/// The same of regions that were chosen to be objects: region i is one with the confidence scores[i], however
/// large it is and wherever it lies, unless that is 0 or the region has no valid pixel.
Objects measure(View<const RegionId> chosen, const std::vector<float>& scores, const DisparityMap& disparity,
                View<const Gray> left, View<const Rgb> left_rgb, float noise_sigma, const Exec& exec);

}  // namespace cairn
