// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/scene/floor_frame.hpp>
#include <optional>
#include <string>

#include "../tracking/follower.hpp"
#include "messages.hpp"

/// What is found in a frame, as messages of ROS. All places are in the left camera's optical frame (x right,
/// y down, z forward), but for the grid, which lies in the floor's.
namespace cairn::ros {

/// The names of frames: the left camera's, the floor's, and the map's.
struct FrameNames {
  std::string camera = "cairn_camera";
  std::string floor = "cairn_floor";
  std::string map = "cairn_map";
};
/// These names with the camera's as given, unless that is empty.
FrameNames frame_names(const std::string& camera);
/// The frame_id of an image that says which camera took it; empty where it is the name that cairn gives by
/// itself, so that a recording gives no more than its source did.
std::string camera_of(const Header& header);

Header header_of(Stamp stamp, const std::string& frame_id);

Image image_of(const Header& header, View<const Gray> image);   // mono8
Image image_of(const Header& header, View<const Rgb> image);    // rgb8
Image image_of(const Header& header, View<const float> image);  // 32FC1

enum class Side : std::uint8_t { left, right };
/// P says all of a rectified rig (docs/install.md, "With OpenCV"); there is no distortion.
CameraInfo camera_info_of(const Header& header, const StereoRig& rig, Size size, Side side);
/// The rig of two cameras' P. Throws Error where they are not those of one rectified rig.
StereoRig rig_of(const CameraInfo& left, const CameraInfo& right);

/// 32FC1 with NaN for holes, or `hole_px` where it is given: many nodes of ROS expect min_disparity − 1.
/// Disparities count from the principal points, so that depth = f·t / disparity whatever rig.doffs_px is.
/// Without a rig f and t are 0.
DisparityImage disparity_image_of(const Header& header, const Frame& frame,
                                  const std::optional<StereoRig>& rig, const MatchConfig& config,
                                  std::optional<float> hole_px = std::nullopt);

/// mono16: which track each pixel shows (from 65536 on they begin again at 1), or which object where no
/// tracks were looked for; 0 = none.
Image labels_of(const Header& header, const Step& step);
/// mono16: the bits of Reject, 0 = there is a disparity.
Image reject_of(const Header& header, const Frame& frame);

/// The objects that have a place in metres, nearest first. id: the track's number, empty where the object is
/// no track; the object's own number where no tracks were looked for. score: its confidence. None without a
/// rig.
Detection3DArray detections_of(const Header& header, const Step& step, const std::optional<StereoRig>& rig);

/// The points of obstacles or of the floor that have a disparity, of each `stride`th pixel in each `stride`th
/// row: x y z (m), rgb, object (its number, 0 = none), confidence (of the disparity). Empty without a rig.
PointCloud2 cloud_of(const Header& header, const Frame& frame, Space space,
                     const std::optional<StereoRig>& rig, View<const Gray> left, View<const Rgb> left_rgb,
                     int stride = 1);

/// The grid of obstacles (map_obstacles()); none where no floor is known. `header`: of the floor's frame.
std::optional<OccupancyGrid> grid_of(const Header& header, const Frame& frame,
                                     const std::optional<StereoRig>& rig, const SpaceConfig& config);

/// Where the floor is in the camera's frame; none where it is not known.
std::optional<TransformStamped> floor_transform_of(Stamp stamp, const FrameNames& names, const Ground& ground,
                                                   const std::optional<StereoRig>& rig);
/// Where the camera is in the map; none where that is not known.
std::optional<TransformStamped> camera_transform_of(const FrameNames& names, const Step& step);
/// Both, as far as they are known.
TFMessage transforms_of(const FrameNames& names, const Step& step, const std::optional<StereoRig>& rig);

}  // namespace cairn::ros
