// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <algorithm>
#include <cairn/core/error.hpp>
#include <cairn/core/image.hpp>
#include <cairn/ros/messages.hpp>
#include <cstddef>
#include <string>

/// Conversion between the messages of rclcpp and cairn's own, which have the same members. Templates on
/// rclcpp's types, so this header needs no part of ROS.
namespace cairn_ros {

// ---- from cairn's messages ----

void copy(const cairn::ros::Header& from, auto& to) {
  to.stamp.sec = from.stamp.sec;
  to.stamp.nanosec = from.stamp.nanosec;
  to.frame_id = from.frame_id;
}

/// Point and Vector3.
void copy_xyz(const auto& from, auto& to) {
  to.x = from.x;
  to.y = from.y;
  to.z = from.z;
}

void copy(const cairn::ros::Quaternion& from, auto& to) {
  copy_xyz(from, to);
  to.w = from.w;
}

void copy(const cairn::ros::Pose& from, auto& to) {
  copy_xyz(from.position, to.position);
  copy(from.orientation, to.orientation);
}

void copy_pixels(const auto& from, auto& to) {
  to.height = from.height;
  to.width = from.width;
  to.encoding = from.encoding;
  to.is_bigendian = from.is_bigendian;
  to.step = from.step;
  to.data.assign(from.data.begin(), from.data.end());
}

void copy(const cairn::ros::Image& from, auto& to) {
  copy(from.header, to.header);
  copy_pixels(from, to);
}

void copy(const cairn::ros::DisparityImage& from, auto& to) {
  copy(from.header, to.header);
  copy(from.image, to.image);
  to.f = from.f;
  to.t = from.t;
  to.valid_window.x_offset = from.valid_window.x_offset;
  to.valid_window.y_offset = from.valid_window.y_offset;
  to.valid_window.height = from.valid_window.height;
  to.valid_window.width = from.valid_window.width;
  to.valid_window.do_rectify = from.valid_window.do_rectify;
  to.min_disparity = from.min_disparity;
  to.max_disparity = from.max_disparity;
  to.delta_d = from.delta_d;
}

void copy(const cairn::ros::PointCloud2& from, auto& to) {
  copy(from.header, to.header);
  to.height = from.height;
  to.width = from.width;
  to.fields.resize(from.fields.size());
  for (std::size_t i = 0; i < from.fields.size(); ++i) {
    to.fields[i].name = from.fields[i].name;
    to.fields[i].offset = from.fields[i].offset;
    to.fields[i].datatype = from.fields[i].datatype;
    to.fields[i].count = from.fields[i].count;
  }
  to.is_bigendian = from.is_bigendian;
  to.point_step = from.point_step;
  to.row_step = from.row_step;
  to.data.assign(from.data.begin(), from.data.end());
  to.is_dense = from.is_dense;
}

void copy(const cairn::ros::Detection3D& from, auto& to) {
  copy(from.header, to.header);
  to.results.resize(from.results.size());
  for (std::size_t i = 0; i < from.results.size(); ++i) {
    to.results[i].hypothesis.class_id = from.results[i].hypothesis.class_id;
    to.results[i].hypothesis.score = from.results[i].hypothesis.score;
    copy(from.results[i].pose.pose, to.results[i].pose.pose);
    std::copy(from.results[i].pose.covariance.begin(), from.results[i].pose.covariance.end(),
              to.results[i].pose.covariance.begin());
  }
  copy(from.bbox.center, to.bbox.center);
  copy_xyz(from.bbox.size, to.bbox.size);
  to.id = from.id;
}

void copy(const cairn::ros::Detection3DArray& from, auto& to) {
  copy(from.header, to.header);
  to.detections.resize(from.detections.size());
  for (std::size_t i = 0; i < from.detections.size(); ++i) copy(from.detections[i], to.detections[i]);
}

void copy(const cairn::ros::TransformStamped& from, auto& to) {
  copy(from.header, to.header);
  to.child_frame_id = from.child_frame_id;
  copy_xyz(from.transform.translation, to.transform.translation);
  copy(from.transform.rotation, to.transform.rotation);
}

/// The equivalent message of rclcpp's type.
template <class Theirs>
Theirs as(const auto& from) {
  Theirs to;
  copy(from, to);
  return to;
}

// ---- to cairn ----

/// The part of CameraInfo that describes a rectified camera and its images.
cairn::ros::CameraInfo camera_info_from(const auto& from) {
  cairn::ros::CameraInfo to;
  to.height = from.height;
  to.width = from.width;
  std::copy(from.p.begin(), from.p.end(), to.p.begin());
  to.binning_x = from.binning_x;
  to.binning_y = from.binning_y;
  to.roi.x_offset = from.roi.x_offset;
  to.roi.y_offset = from.roi.y_offset;
  to.roi.width = from.roi.width;
  to.roi.height = from.roi.height;
  return to;
}

cairn::Stamp stamp_from(const auto& header) {
  return cairn::ros::stamp_of({header.stamp.sec, header.stamp.nanosec});
}

/// The same with its pixels; for input::pictures_of().
cairn::ros::Image image_from(const auto& message) {
  cairn::ros::Image to;
  copy_pixels(message, to);
  return to;
}

}  // namespace cairn_ros
