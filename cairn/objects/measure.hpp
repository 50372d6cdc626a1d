// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

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

/// Something that stands or hangs in front of the background.
struct Object {
  ObjectId id = ObjectId::none;
  Rect box_px;
  int pixel_count = 0;
  float disparity_px = 0;  // median of its valid pixels (even number: mean of the middle two)
  float valid_share = 0;   // 0 … 1: pixels of the mask that have a disparity
  Rgb mean_colour;         // of the mask, rounded; grey where the input had no colour
  std::optional<Vec3>
      position_in_camera_m;  // mean of its valid points; needs a rig and a point before infinity
  std::optional<Vec3>
      extent_in_camera_m;  // size of the box around its points, 2nd to 98th percentile per axis
  float edge_share = 0;    // 0 … 1: of its outline, where the picture shows an edge
  float cut_share = 0;     // 0 … 1: of its outline, what lies at the image's border
  float confidence = 0;    // 0 … 1: how likely it covers a true object by more than half (IoU ≥ 0.5)
};

/// The objects of a frame. labels: ObjectId per pixel, none = no object. list[i].id = i + 1, nearest first
/// (ties of disparity: raster order of the first pixel).
struct Objects {
  Image<ObjectId> labels;
  std::vector<Object> list;
};

/// Turns candidates into objects: regions 0 … is_background.size()−1 that divide the image among them, fused
/// ones or groups. No objects are: what is known to be background, such as the floor; what covers more than
/// max_area of the image or touches three of its borders (background); what is smaller than min_area; what
/// has no valid pixel; what would have a confidence below min_confidence (beyond the paper).
///
/// Confidence is a logistic function of the logarithm of the mask's share of the image, of edge_share and of
/// cut_share; below a valid_share of one half it falls with that, too: what has no disparity is a guess. Its
/// four numbers were fitted on objects found with the default preset; see docs/stages/objects.md.
/// `noise_sigma`: of the left image; a step that stands out of it is an edge.
Objects measure(View<const RegionId> candidates, const std::vector<bool>& is_background,
                const DisparityMap& disparity, View<const Gray> left, View<const Rgb> left_rgb,
                float noise_sigma, const std::optional<StereoRig>& rig, const ObjectsConfig& config,
                const Exec& exec);

/// The same of regions that were chosen to be objects: region i is one with the confidence scores[i], however
/// large it is and wherever it lies, unless that is 0 or the region has no valid pixel.
Objects measure(View<const RegionId> chosen, const std::vector<float>& scores, const DisparityMap& disparity,
                View<const Gray> left, View<const Rgb> left_rgb, float noise_sigma,
                const std::optional<StereoRig>& rig, const Exec& exec);

}  // namespace cairn
