// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/objects/ground_steps.hpp>
#include <cairn/pipeline/segment.hpp>
#include <cairn/regions/watershed.hpp>
#include <cairn/scene/floor_frame.hpp>
#include <cairn/stereo/gradient.hpp>

#include "value_class.hpp"

/// The members of the results of stages.
namespace cairn::python {

CAIRN_NAMES(EpipolarOutcome, kEpipolarOutcomes)
CAIRN_NAMES(Refusal, kRefusals)
CAIRN_NAMES(RejectionReason, kLeftOutReasons)

CAIRN_MEMBERS(EpipolarOffset, rows, rows_per_px, points, agreeing, outcome)
CAIRN_MEMBERS(EpipolarCorrection, offset, right)
CAIRN_MEMBERS(Matches, best, best_right, row_offset, cost, runner_up, mean_cost, cost_before, cost_after)
CAIRN_MEMBERS(DisparityMap, disparity_px, reject)
CAIRN_MEMBERS(GroundPlane, a, b, c)
CAIRN_MEMBERS(Ground, plane, support, residual_px, refusal)
CAIRN_MEMBERS(FloorFrame, _forward, _left, _up, camera_height_m)
CAIRN_MEMBERS(Background, planes, has_floor)
CAIRN_MEMBERS(Region, pixel_count, valid_count, box, mean, variance, is_floor, is_background)
CAIRN_MEMBERS(Segmentation, labels, regions)
CAIRN_MEMBERS(Basins, labels, count)
CAIRN_MEMBERS(RegionGraph::Node, _pixels, _valid, _sum, _squares, _first_pixel, _box, _is_floor)
CAIRN_MEMBERS(RegionGraph, _nodes, _first_arc, _arcs)
CAIRN_MEMBERS(Superpixels, labels, count, _edges)
CAIRN_MEMBERS(Origin, _same_thing, _least_same_thing, _larger_part)
CAIRN_MEMBERS(MergeNode, _part_a, _part_b, _whole, _area, _origin, _features)
CAIRN_MEMBERS(PlaneMoments, _n, _x, _y, _xx, _xy, _yy, _d, _xd, _yd, _dd)
CAIRN_MEMBERS(Heights, _n, _sum, _squares, _behind, _on)
CAIRN_MEMBERS(HintSums, _object, _outline, _weight, _x, _y, _xx, _yy, _size)
CAIRN_MEMBERS(RegionCues, _area, _x, _y, _xx, _xy, _yy, _left, _top, _right, _bottom, _at_image_border,
              _colour, _colour_squares, _histogram, _texture, _perimeter, _matched, _textured, _above_ground,
              _textured_above_ground, _before_background, _textured_before_background, _hints)
CAIRN_MEMBERS(ContactCues, _a, _b, _length, _edge_sum, _weak, _x2, _y2, _outline, _near_n, _near_sum,
              _near_abs, _far_n, _far_sum, _far_abs, _nearer, _farther, _level)
CAIRN_MEMBERS(RegionGraphCues, _regions, _contacts)
CAIRN_MEMBERS(MergeTree, superpixels, _nodes, _superpixel_cues)
CAIRN_MEMBERS(ChosenObjects, object_of, scores, likeliest)
CAIRN_MEMBERS(RefinedDisparity, disparity_px, confidence)
CAIRN_MEMBERS(Fusion, labels, parts, disparity_region, is_floor)
CAIRN_MEMBERS(FloorBox, centre_in_floor_m, size_m, yaw_rad, _centre_covariance)
CAIRN_MEMBERS(Object, id, box_px, pixel_count, disparity_px, valid_share, mean_colour, edge_share, cut_share,
              confidence, disparity_sigma_px, position_in_camera_m, depth_interval_m, extent_in_camera_m,
              box_on_floor)
CAIRN_MEMBERS(Objects, labels, _all)
CAIRN_MEMBERS(StereoResult, disparity_map, ground, floor, epipolar, confidence)
CAIRN_MEMBERS(RejectedObstacle, reason, box_px, pixel_count, disparity_px, position_in_camera_m, confidence)
CAIRN_MEMBERS(GroundStep, from_m, to_m, height_m)
CAIRN_MEMBERS(ObstacleScan, angle_min_rad, angle_increment_rad, range_max_m, _ranges)
CAIRN_MEMBERS(ObstacleGrid, cell_size_m, _width, _height, _origin_x, _origin_y, _cells)
/// A frame has the members of its stereo result, too.
template <>
struct Members<Frame> {
  static constexpr std::string_view kNames =
      "disparity_map, ground, floor, epipolar, confidence, by_intensity, by_disparity, fusion, superpixels, "
      "groups, refined, objects, space, left_out";
  template <class Value>
  static auto of(Value& value) {
    return std::tie(value.disparity, value.ground, value.floor, value.epipolar, value.confidence,
                    value.by_intensity, value.by_disparity, value.fusion, value.superpixels, value.groups,
                    value.refined, value.objects, value.space, value.left_out);
  }
};

}  // namespace cairn::python
