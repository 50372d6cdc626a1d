// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/stereo_pair.hpp>
#include <optional>
#include <string>
#include <vector>

#include <cairn/input/sequence.hpp>
#include <cairn/io/calibration_files.hpp>
#include <cairn/ros/messages.hpp>

/// Depth and disparity images of ROS messages, for recordings and topics. (docs/bring_your_own_depth.md)
namespace cairn::input {

struct RosDepth {
  /// Of a DisparityImage.
  struct FocalAndBaseline {
    float focal_px = 0;
    float baseline_m = 0;
  };
  Image<float> values;                         // NaN: hole
  std::optional<FocalAndBaseline> of_message;  // nullopt: the values are depths in m
};

/// Whether a message is a depth image of another image, by their encodings: 32FC1, or 16 bits beside an image of 8. If
/// both have 16 bits, by the names of the topics: "depth" where they differ.
bool is_depth_of(const std::string& encoding, const std::string& encoding_of_image, const std::string& topic,
                 const std::string& topic_of_image);
/// "depth" in the part of the topic in which it differs from that of the image, and not in the image's.
bool is_named_depth_of(const std::string& topic, const std::string& topic_of_image);
/// Depths in m of 16UC1 or mono16 (mm; 0: hole) and 32FC1 (m). Throws Error like raster_of().
RosDepth depth_of(const ros::Image& image, const Pool& pool);
/// The same of 16-bit PNG, also in the form of compressed_depth_image_transport ("compressedDepth"), which packs 32FC1
/// as inverse depths.
RosDepth depth_of(const ros::CompressedImage& image, const Pool& pool);
/// Disparities, counted from the principal points. Values below min_disparity are holes.
RosDepth depth_of(const ros::DisparityImage& image, const Pool& pool);

/// The camera of an image with depth, by its camera_info: of a raw image, if its topic says so, K instead of P. `right`:
/// of the right image that checks the depth, nullptr if unknown; the rig has its baseline where its P has one. Throws
/// Error if a message is of images of another size.
void set_cameras(io::Calibration& calibration, const ros::CameraInfo& left, const ros::CameraInfo* right,
                 const std::string& topic, std::optional<Size> images = std::nullopt);
/// The topics of an image and its depth, and the frame_id of their headers.
struct DepthNames {
  std::string image_topic;
  std::string image_frame;
  std::string depth_topic;
  std::string depth_frame;
};
/// What is often wrong with depth cameras: an image with distortion; depth in another frame than its image, so perhaps
/// not aligned to it. `info`: of the image, nullptr if unknown.
std::vector<SourceRemark> remarks_on(const DepthNames& names, const ros::CameraInfo* info);

/// Completes the calibration for these messages: what a DisparityImage says of its cameras; or an assumed baseline for
/// depths. No change without a focal length and centre.
void complete(io::Calibration& calibration, const RosDepth& first);
/// A right image can check depths in m only if the baseline is known. Throws Error, with the source's name.
void check_baseline(const io::Calibration& calibration, const RosDepth& first, const std::string& source);
/// The remark on a frame without that right image: "depth not checked, without a right image on /right/image_rect".
std::string unchecked_on(const std::string& topic);
/// The disparities of an image of this size. Throws Error if the size differs, and for depths without a rig.
Image<float> disparity_of(const RosDepth& depth, Size image, const std::optional<StereoRig>& rig,
                          const Pool& pool);

}  // namespace cairn::input
