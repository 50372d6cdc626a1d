// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/ros/messages.hpp>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>
#include <vector>

/// Messages of other sensors, and the same data as lines of files.
namespace cairn::sensor_messages {

/// Of a robot (x forward, y left, z up): the rotation of a camera that looks ahead (x right, y down, z forward), as a
/// rotation vector.
inline const Point3 kOpticalFromRobot_rad = (2 * std::numbers::pi / 3 / std::sqrt(3.0)) * Point3{-1, 1, -1};

inline ros::Header header(Stamp stamp, const std::string& frame) {
  return {ros::time_of(stamp), frame};
}

inline ros::TFMessage transform(const std::string& parent, const std::string& child, Point3 place,
                                Point3 rotation_vector) {
  ros::TransformStamped one;
  one.header.frame_id = parent;
  one.child_frame_id = child;
  one.transform.translation = {place.x, place.y, place.z};
  const auto q = quaternion(rotation_about(rotation_vector));
  one.transform.rotation = {q[0], q[1], q[2], q[3]};
  return {{one}};
}

/// A robot on an arc, from 1 s on at 20 Hz.
inline std::vector<ros::Odometry> odometry(int count) {
  std::vector<ros::Odometry> all;
  for (int i = 0; i < count; ++i) {
    ros::Odometry message;
    message.header = header({1'000'000'000 + i * 50'000'000LL}, "odom");
    message.child_frame_id = "base_link";
    const double angle = 0.02 * i;
    message.pose.pose.position = {std::sin(angle), 1 - std::cos(angle), 0};
    message.pose.pose.orientation = {0, 0, std::sin(angle / 2), std::cos(angle / 2)};
    all.push_back(message);
  }
  return all;
}

/// At rest for 0.6 s from 1 s on, then turning; 200 Hz.
inline std::vector<ros::Imu> imu(int count) {
  std::vector<ros::Imu> all;
  for (int i = 0; i < count; ++i) {
    ros::Imu message;
    message.header = header({1'000'000'000 + i * 5'000'000LL}, "imu");
    message.angular_velocity = {0.01, -0.02 + (i > 120 ? 0.3 * std::sin(0.01 * i) : 0), 0.003 * (i % 2)};
    message.linear_acceleration = {0, -9.81, 0.01 * (i % 3)};
    all.push_back(message);
  }
  return all;
}

/// A wall at 0.3 m ahead of the camera, at 10 Hz from 0 on.
inline std::vector<ros::LaserScan> scans(int count) {
  std::vector<ros::LaserScan> all;
  for (int i = 0; i < count; ++i) {
    ros::LaserScan message;
    message.header = header({i * 100'000'000LL}, "laser");
    message.angle_min = -0.4F;
    message.angle_increment = 0.02F;
    message.angle_max = 0.4F;
    message.range_min = 0.05F;
    message.range_max = 30;
    message.ranges.assign(41, 0.3F + 0.001F * static_cast<float>(i));
    message.ranges[3] = INFINITY;
    all.push_back(message);
  }
  return all;
}

// ---- as lines of files, with all digits ----

inline std::string digits(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}

inline std::string tum_line(const ros::Odometry& message) {
  const auto& [p, q] = message.pose.pose;
  std::string line = seconds_text(ros::stamp_of(message.header.stamp));
  for (const double value : {p.x, p.y, p.z, q.x, q.y, q.z, q.w}) line += " " + digits(value);
  return line + "\n";
}

inline std::string euroc_line(const ros::Imu& message) {
  const auto& [w, a] = std::pair(message.angular_velocity, message.linear_acceleration);
  std::string line = std::to_string(ros::stamp_of(message.header.stamp).ns);
  for (const double value : {w.x, w.y, w.z, a.x, a.y, a.z}) line += "," + digits(value);
  return line + "\n";
}

inline std::string table_line(const ros::LaserScan& message, bool with_header) {
  std::string line;
  if (with_header) {
    line = "stamp,angle_min,angle_increment";
    for (std::size_t i = 0; i < message.ranges.size(); ++i) line += ",r" + std::to_string(i);
    line += "\n";
  }
  line += std::to_string(ros::stamp_of(message.header.stamp).ns);
  for (const float value : {message.angle_min, message.angle_increment}) line += "," + digits(double{value});
  for (const float range : message.ranges)
    line += "," + (std::isfinite(range) ? digits(double{range}) : std::string("inf"));
  return line + "\n";
}

}  // namespace cairn::sensor_messages
