// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/scene/floor_frame.hpp>
#include <optional>
#include <string>

#include <cairn/ros/messages.hpp>
#include <cairn/sequence/follower.hpp>
#include <cairn/sequence/landmarks.hpp>

/// The results of a frame as ROS messages. Positions are in the left camera's optical frame (x right, y down,
/// z forward), except for the grid, which is in that of the floor.
namespace cairn::ros {

/// The frame names of left camera, floor and map.
struct FrameNames {
  std::string camera = "cairn_camera";
  std::string floor = "cairn_floor";
  std::string map = "cairn_map";
};
/// The default names, with the camera's replaced unless `camera` is empty.
FrameNames frame_names(const std::string& camera);
/// The frame_id to record for an image; empty if it is the default name of cairn, so that a recording
/// contains no more than its source did.
std::string camera_of(const Header& header);

Header header_of(Stamp stamp, const std::string& frame_id);

Image image_of(const Header& header, View<const Gray> image);   // mono8
Image image_of(const Header& header, View<const Rgb> image);    // rgb8
Image image_of(const Header& header, View<const float> image);  // 32FC1

enum class Side : std::uint8_t { left, right };
/// P describes a rectified rig completely (docs/install.md, "With OpenCV"); there is no distortion.
CameraInfo camera_info_of(const Header& header, const StereoRig& rig, Size size, Side side);
/// The same for the images as they come: K and P are of the full resolution, of which a camera may publish a region of
/// interest, and every binning_x-th column (REP 104; sensor_msgs/CameraInfo). The result has neither.
CameraInfo as_published(CameraInfo info);
/// The size of the images that it is of; empty if the message has none.
Size image_size_of(const CameraInfo& info);
/// The camera of an image, as published: a rig with a baseline of 0, nullopt if the message has no focal length. By K of
/// raw images, else by P, or by K where P is empty. Throws Error if the message is of images of another size.
std::optional<StereoRig> one_camera_of(const CameraInfo& info, bool is_raw,
                                       std::optional<Size> images = std::nullopt);
/// The rig from the P of both cameras, as published. Throws Error unless they belong to one rectified rig, in this
/// order, and to images of this size, if given.
StereoRig rig_of(const CameraInfo& left, const CameraInfo& right, std::optional<Size> images = std::nullopt);

/// 32FC1 with NaN for holes, or `hole_px` if given: many ROS nodes expect min_disparity − 1. Disparities
/// count from the principal points, so that depth = f·t / disparity for any rig.doffs_px. Without a rig f and
/// t are 0.
DisparityImage disparity_image_of(const Header& header, View<const float> disparity_px,
                                  const std::optional<StereoRig>& rig, const MatchConfig& config,
                                  std::optional<float> hole_px = std::nullopt);
/// The same of a frame's disparities.
DisparityImage disparity_image_of(const Header& header, const Frame& frame,
                                  const std::optional<StereoRig>& rig, const MatchConfig& config,
                                  std::optional<float> hole_px = std::nullopt);

/// mono16: the track of each pixel (modulo 65535, from 1), or its object if there was no tracking; 0 = none.
Image labels_of(const Header& header, const TrackedFrame& step);
/// mono16: the bits of Reject, 0 = valid disparity.
Image reject_of(const Header& header, const Frame& frame);

/// The objects with a metric position, nearest first. id: the track's number, empty for an object without a
/// track; the object's number if there was no tracking. score: its confidence. Empty without a rig.
Detection3DArray detections_of(const Header& header, const TrackedFrame& step,
                               const std::optional<StereoRig>& rig);

/// The confirmed tracks in the frame of `header`, to which `map_from_odom` leads from the frame of odometry; id: the
/// track's number after `prefix`.
Detection3DArray tracks_of(const Header& header, const TrackedFrame& step, const cairn::Pose& map_from_odom,
                           const std::string& prefix);
/// The camera's pose in the frame of `header`; `covariance`: along the axes of that frame.
PoseWithCovarianceStamped camera_pose_of(const Header& header, const TrackedFrame& step,
                                         const cairn::Pose& map_from_odom, const Covariance6& covariance);
/// Landmarks that are present; `size`: their mean width twice, and their height. id: the landmark's number.
Detection3DArray landmarks_of(const Header& header, const std::vector<Landmark>& landmarks);

/// The points of obstacles or floor with a disparity, from every `stride`-th pixel of every `stride`-th row:
/// x y z (m), rgb, object (its number, 0 = none), confidence (of the disparity). Empty without a rig.
PointCloud2 cloud_of(const Header& header, const Frame& frame, ObstacleLabel space,
                     const std::optional<StereoRig>& rig, View<const Gray> left, View<const Rgb> left_rgb,
                     int stride = 1);
/// Adds points at most 2 cm apart along the upper edges of steps, as obstacles without an object: both levels of a kerb are
/// floor, which clears a costmap. `cloud`: of cloud_of().
void add_steps(PointCloud2& cloud, const std::vector<GroundStep>& steps, const FloorFrame& floor);

/// A grid of map_obstacles(). `header`: in the floor's frame.
OccupancyGrid grid_of(const Header& header, ObstacleGrid grid);
/// That of a frame; nullopt if no floor is known.
std::optional<OccupancyGrid> grid_of(const Header& header, const Frame& frame,
                                     const std::optional<StereoRig>& rig, const ObstaclesConfig& config);

/// The floor's pose in the camera's frame; nullopt if unknown.
std::optional<TransformStamped> floor_transform_of(Stamp stamp, const FrameNames& names, const Ground& ground,
                                                   const std::optional<StereoRig>& rig);
/// The camera's pose in the map; nullopt if unknown.
std::optional<TransformStamped> camera_transform_of(const FrameNames& names, const TrackedFrame& step);
/// Both, if known.
TFMessage transforms_of(const FrameNames& names, const TrackedFrame& step,
                        const std::optional<StereoRig>& rig);

}  // namespace cairn::ros
