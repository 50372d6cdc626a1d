// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cairn/core/fields.hpp>
#include <cairn/core/left_image.hpp>
#include <cairn/core/stereo_pair.hpp>
#include <cairn/regions/region_graph.hpp>
#include <cairn/stereo/disparity_map.hpp>
#include <optional>
#include <vector>

namespace cairn {

struct ObjectsConfig {
  float min_area = 0.1F;        // % of the image, 0 … 100; lower finds smaller objects, and more false ones
  float max_area = 30.0F;       // % of the image, 0 … 100; higher for objects close to the camera
  float min_confidence = 0.0F;  // 0 … 1; higher: fewer objects, more of them correct
};
template <class V>
void fields(ObjectsConfig& c, V&& v) {
  v("min_area", c.min_area, "% of the image", "smallest area of an object", range(0.0F, 100.0F));
  v("max_area", c.max_area, "% of the image", "largest area of an object", range(0.0F, 100.0F),
    when("pipeline.method", "paper"));
  v("min_confidence", c.min_confidence, "", "smallest confidence of an object", range(0.0F, 1.0F));
}

/// From `low` to `high`; may be infinite.
struct Interval {
  float low = 0;
  float high = 0;
};

/// An upright box on the floor around the visible part of an object, aligned with it, in the floor frame (x
/// forward, y left, z up from the floor below the camera): see floor_frame().
struct FloorBox {
  Vec3 centre_in_floor_m;
  Vec3 size_m;        // longer side, shorter side, height
  float yaw_rad = 0;  // −π/2 < yaw ≤ π/2: of the longer side, counter-clockwise from x as seen from above
  /// Covariance of the centre, m²: xx, xy, xz, yy, yz, zz in the floor frame.
  std::array<float, 6> centre_covariance_m2{};
};

/// An object in front of the background.
struct Object {
  ObjectId id = ObjectId::none;
  Rect box_px;
  int pixel_count = 0;
  float disparity_px = 0;  // median of its valid pixels; refine_objects() refines it
  float valid_share = 0;   // 0 … 1: share of the mask with a disparity
  Rgb mean_colour;         // of the mask, rounded; grey if the input had no colour
  float edge_share = 0;    // 0 … 1: share of the outline on image edges
  float cut_share = 0;     // 0 … 1: share of the outline at the image border
  float confidence = 0;    // 0 … 1: probability that it matches a true object (IoU ≥ 0.5)

  // Set by locate(). Metres need a rig and a finite depth.
  float disparity_sigma_px = 0;              // standard deviation of disparity_px
  std::optional<Vec3> position_in_camera_m;  // centroid of the mask, at the depth of disparity_px
  std::optional<Interval> depth_interval_m;  // 95 % interval of the z of its position
  std::optional<Vec3> extent_in_camera_m;    // of the main part, without outliers
  std::optional<FloorBox> box_on_floor;      // also needs a ground
};

/// The objects of a frame. labels: ObjectId per pixel, none = no object. list[i].id = i + 1, nearest first
/// (ties of disparity: raster order of the first pixel).
struct Objects {
  Image<ObjectId> labels;
  std::vector<Object> list;
};

/// Makes objects of candidates, without their position, which locate() adds. The candidates are regions 0 …
/// is_background.size()−1 that partition the image: fused regions or groups. Excluded are: known background,
/// such as the floor; regions that cover more than max_area of the image or touch three of its borders
/// (background); regions smaller than min_area; regions without valid pixel; regions with a confidence below
/// min_confidence (beyond the paper).
///
/// Confidence is a logistic function of the logarithm of the mask's share of the image, of edge_share and of
/// cut_share; a valid_share below one half also lowers it. Its four numbers were fitted to objects of the
/// default preset; see docs/stages/objects.md. Edges are steps above the noise of `left`.
Objects measure(View<const RegionId> candidates, const std::vector<bool>& is_background,
                const DisparityMap& disparity, const LeftImage& left, const ObjectsConfig& config,
                const Exec& exec);

/// The same for chosen regions: region i is an object of confidence scores[i], whatever its size and
/// position, unless that is 0 or the region has no valid pixel.
Objects measure(View<const RegionId> chosen, const std::vector<float>& scores, const DisparityMap& disparity,
                const LeftImage& left, const Exec& exec);

}  // namespace cairn
