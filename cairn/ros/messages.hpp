// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <cairn/ros/cdr.hpp>
#include <cairn/sequence/pose.hpp>

/// The ROS 2 messages that we send, record and read, as defined from Humble on. Each member is listed once,
/// in each(), for both bytes and definitions.
namespace cairn::ros {

struct Time {
  static constexpr std::string_view kType = "builtin_interfaces/msg/Time";
  std::int32_t sec = 0;
  std::uint32_t nanosec = 0;
  static void each(auto& m, auto&& visit) {
    visit("sec", m.sec);
    visit("nanosec", m.nanosec);
  }
};

struct Header {
  static constexpr std::string_view kType = "std_msgs/msg/Header";
  Time stamp;
  std::string frame_id;
  static void each(auto& m, auto&& visit) {
    visit("stamp", m.stamp);
    visit("frame_id", m.frame_id);
  }
};

struct String {
  static constexpr std::string_view kType = "std_msgs/msg/String";
  std::string data;
  static void each(auto& m, auto&& visit) { visit("data", m.data); }
};

// ---- geometry ----

struct Point {
  static constexpr std::string_view kType = "geometry_msgs/msg/Point";
  double x = 0;
  double y = 0;
  double z = 0;
  static void each(auto& m, auto&& visit) {
    visit("x", m.x);
    visit("y", m.y);
    visit("z", m.z);
  }
};

struct Vector3 {
  static constexpr std::string_view kType = "geometry_msgs/msg/Vector3";
  double x = 0;
  double y = 0;
  double z = 0;
  static void each(auto& m, auto&& visit) {
    visit("x", m.x);
    visit("y", m.y);
    visit("z", m.z);
  }
};

struct Quaternion {
  static constexpr std::string_view kType = "geometry_msgs/msg/Quaternion";
  double x = 0;
  double y = 0;
  double z = 0;
  double w = 1;
  static void each(auto& m, auto&& visit) {
    visit("x", m.x);
    visit("y", m.y);
    visit("z", m.z);
    visit("w", m.w);
  }
};

struct Pose {
  static constexpr std::string_view kType = "geometry_msgs/msg/Pose";
  Point position;
  Quaternion orientation;
  static void each(auto& m, auto&& visit) {
    visit("position", m.position);
    visit("orientation", m.orientation);
  }
};

struct PoseWithCovariance {
  static constexpr std::string_view kType = "geometry_msgs/msg/PoseWithCovariance";
  Pose pose;
  std::array<double, 36> covariance{};  // position before rotation, row-major
  static void each(auto& m, auto&& visit) {
    visit("pose", m.pose);
    visit("covariance", m.covariance);
  }
};

struct PoseWithCovarianceStamped {
  static constexpr std::string_view kType = "geometry_msgs/msg/PoseWithCovarianceStamped";
  Header header;
  PoseWithCovariance pose;
  static void each(auto& m, auto&& visit) {
    visit("header", m.header);
    visit("pose", m.pose);
  }
};

struct Twist {
  static constexpr std::string_view kType = "geometry_msgs/msg/Twist";
  Vector3 linear;
  Vector3 angular;
  static void each(auto& m, auto&& visit) {
    visit("linear", m.linear);
    visit("angular", m.angular);
  }
};

struct TwistWithCovariance {
  static constexpr std::string_view kType = "geometry_msgs/msg/TwistWithCovariance";
  Twist twist;
  std::array<double, 36> covariance{};
  static void each(auto& m, auto&& visit) {
    visit("twist", m.twist);
    visit("covariance", m.covariance);
  }
};

struct Odometry {
  static constexpr std::string_view kType = "nav_msgs/msg/Odometry";
  Header header;               // frame_id: of the pose, often "odom"
  std::string child_frame_id;  // whose pose it is, often "base_link"
  PoseWithCovariance pose;
  TwistWithCovariance twist;
  static void each(auto& m, auto&& visit) {
    visit("header", m.header);
    visit("child_frame_id", m.child_frame_id);
    visit("pose", m.pose);
    visit("twist", m.twist);
  }
};

struct Transform {
  static constexpr std::string_view kType = "geometry_msgs/msg/Transform";
  Vector3 translation;
  Quaternion rotation;
  static void each(auto& m, auto&& visit) {
    visit("translation", m.translation);
    visit("rotation", m.rotation);
  }
};

struct TransformStamped {
  static constexpr std::string_view kType = "geometry_msgs/msg/TransformStamped";
  Header header;  // frame_id: the parent, into which points of the child are transformed
  std::string child_frame_id;
  Transform transform;
  static void each(auto& m, auto&& visit) {
    visit("header", m.header);
    visit("child_frame_id", m.child_frame_id);
    visit("transform", m.transform);
  }
};

struct TFMessage {
  static constexpr std::string_view kType = "tf2_msgs/msg/TFMessage";
  std::vector<TransformStamped> transforms;
  static void each(auto& m, auto&& visit) { visit("transforms", m.transforms); }
};

// ---- sensors ----

struct Image {
  static constexpr std::string_view kType = "sensor_msgs/msg/Image";
  Header header;
  std::uint32_t height = 0;
  std::uint32_t width = 0;
  std::string encoding;  // "mono8", "mono16", "rgb8", "bgr8", "32FC1"
  std::uint8_t is_bigendian = 0;
  std::uint32_t step = 0;  // bytes per row
  Bytes data;
  static void each(auto& m, auto&& visit) {
    visit("header", m.header);
    visit("height", m.height);
    visit("width", m.width);
    visit("encoding", m.encoding);
    visit("is_bigendian", m.is_bigendian);
    visit("step", m.step);
    visit("data", m.data);
  }
};

struct LaserScan {
  static constexpr std::string_view kType = "sensor_msgs/msg/LaserScan";
  Header header;
  float angle_min = 0;  // rad, counter-clockwise about z from x
  float angle_max = 0;
  float angle_increment = 0;
  float time_increment = 0;  // s
  float scan_time = 0;
  float range_min = 0;  // m
  float range_max = 0;
  std::vector<float> ranges;  // m; outside of range_min … range_max: no echo
  std::vector<float> intensities;
  static void each(auto& m, auto&& visit) {
    visit("header", m.header);
    visit("angle_min", m.angle_min);
    visit("angle_max", m.angle_max);
    visit("angle_increment", m.angle_increment);
    visit("time_increment", m.time_increment);
    visit("scan_time", m.scan_time);
    visit("range_min", m.range_min);
    visit("range_max", m.range_max);
    visit("ranges", m.ranges);
    visit("intensities", m.intensities);
  }
};

struct Imu {
  static constexpr std::string_view kType = "sensor_msgs/msg/Imu";
  Header header;
  Quaternion orientation;
  std::array<double, 9> orientation_covariance{};
  Vector3 angular_velocity;  // rad/s
  std::array<double, 9> angular_velocity_covariance{};
  Vector3 linear_acceleration;  // m/s²
  std::array<double, 9> linear_acceleration_covariance{};
  static void each(auto& m, auto&& visit) {
    visit("header", m.header);
    visit("orientation", m.orientation);
    visit("orientation_covariance", m.orientation_covariance);
    visit("angular_velocity", m.angular_velocity);
    visit("angular_velocity_covariance", m.angular_velocity_covariance);
    visit("linear_acceleration", m.linear_acceleration);
    visit("linear_acceleration_covariance", m.linear_acceleration_covariance);
  }
};

struct CompressedImage {
  static constexpr std::string_view kType = "sensor_msgs/msg/CompressedImage";
  Header header;
  std::string format;  // "jpeg", "png", or longer, such as "rgb8; jpeg compressed bgr8"
  Bytes data;
  static void each(auto& m, auto&& visit) {
    visit("header", m.header);
    visit("format", m.format);
    visit("data", m.data);
  }
};

struct RegionOfInterest {
  static constexpr std::string_view kType = "sensor_msgs/msg/RegionOfInterest";
  std::uint32_t x_offset = 0;
  std::uint32_t y_offset = 0;
  std::uint32_t height = 0;
  std::uint32_t width = 0;
  bool do_rectify = false;
  static void each(auto& m, auto&& visit) {
    visit("x_offset", m.x_offset);
    visit("y_offset", m.y_offset);
    visit("height", m.height);
    visit("width", m.width);
    visit("do_rectify", m.do_rectify);
  }
};

struct CameraInfo {
  static constexpr std::string_view kType = "sensor_msgs/msg/CameraInfo";
  Header header;
  std::uint32_t height = 0;
  std::uint32_t width = 0;
  std::string distortion_model;
  std::vector<double> d;
  std::array<double, 9> k{};   // of the raw image
  std::array<double, 9> r{};   // from raw to rectified
  std::array<double, 12> p{};  // of the rectified image
  std::uint32_t binning_x = 0;
  std::uint32_t binning_y = 0;
  RegionOfInterest roi;
  static void each(auto& m, auto&& visit) {
    visit("header", m.header);
    visit("height", m.height);
    visit("width", m.width);
    visit("distortion_model", m.distortion_model);
    visit("d", m.d);
    visit("k", m.k);
    visit("r", m.r);
    visit("p", m.p);
    visit("binning_x", m.binning_x);
    visit("binning_y", m.binning_y);
    visit("roi", m.roi);
  }
};

struct PointField {
  static constexpr std::string_view kType = "sensor_msgs/msg/PointField";
  static constexpr std::uint8_t kUint32 = 6;
  static constexpr std::uint8_t kFloat32 = 7;
  std::string name;
  std::uint32_t offset = 0;
  std::uint8_t datatype = 0;
  std::uint32_t count = 1;
  static void each(auto& m, auto&& visit) {
    visit("name", m.name);
    visit("offset", m.offset);
    visit("datatype", m.datatype);
    visit("count", m.count);
  }
};

struct PointCloud2 {
  static constexpr std::string_view kType = "sensor_msgs/msg/PointCloud2";
  Header header;
  std::uint32_t height = 0;
  std::uint32_t width = 0;
  std::vector<PointField> fields;
  bool is_bigendian = false;
  std::uint32_t point_step = 0;
  std::uint32_t row_step = 0;
  Bytes data;
  bool is_dense = false;
  static void each(auto& m, auto&& visit) {
    visit("header", m.header);
    visit("height", m.height);
    visit("width", m.width);
    visit("fields", m.fields);
    visit("is_bigendian", m.is_bigendian);
    visit("point_step", m.point_step);
    visit("row_step", m.row_step);
    visit("data", m.data);
    visit("is_dense", m.is_dense);
  }
};

struct DisparityImage {
  static constexpr std::string_view kType = "stereo_msgs/msg/DisparityImage";
  Header header;
  Image image;  // 32FC1
  float f = 0;  // px
  float t = 0;  // baseline, m: depth = f t / disparity
  RegionOfInterest valid_window;
  float min_disparity = 0;
  float max_disparity = 0;
  float delta_d = 0;
  static void each(auto& m, auto&& visit) {
    visit("header", m.header);
    visit("image", m.image);
    visit("f", m.f);
    visit("t", m.t);
    visit("valid_window", m.valid_window);
    visit("min_disparity", m.min_disparity);
    visit("max_disparity", m.max_disparity);
    visit("delta_d", m.delta_d);
  }
};

// ---- results ----

struct ObjectHypothesis {
  static constexpr std::string_view kType = "vision_msgs/msg/ObjectHypothesis";
  std::string class_id;
  double score = 0;
  static void each(auto& m, auto&& visit) {
    visit("class_id", m.class_id);
    visit("score", m.score);
  }
};

struct ObjectHypothesisWithPose {
  static constexpr std::string_view kType = "vision_msgs/msg/ObjectHypothesisWithPose";
  ObjectHypothesis hypothesis;
  PoseWithCovariance pose;
  static void each(auto& m, auto&& visit) {
    visit("hypothesis", m.hypothesis);
    visit("pose", m.pose);
  }
};

struct BoundingBox3D {
  static constexpr std::string_view kType = "vision_msgs/msg/BoundingBox3D";
  Pose center;
  Vector3 size;
  static void each(auto& m, auto&& visit) {
    visit("center", m.center);
    visit("size", m.size);
  }
};

struct Detection3D {
  static constexpr std::string_view kType = "vision_msgs/msg/Detection3D";
  Header header;
  std::vector<ObjectHypothesisWithPose> results;
  BoundingBox3D bbox;
  std::string id;
  static void each(auto& m, auto&& visit) {
    visit("header", m.header);
    visit("results", m.results);
    visit("bbox", m.bbox);
    visit("id", m.id);
  }
};

struct Detection3DArray {
  static constexpr std::string_view kType = "vision_msgs/msg/Detection3DArray";
  Header header;
  std::vector<Detection3D> detections;
  static void each(auto& m, auto&& visit) {
    visit("header", m.header);
    visit("detections", m.detections);
  }
};

struct MapMetaData {
  static constexpr std::string_view kType = "nav_msgs/msg/MapMetaData";
  Time map_load_time;
  float resolution = 0;  // m
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  Pose origin;  // the corner of the first cell
  static void each(auto& m, auto&& visit) {
    visit("map_load_time", m.map_load_time);
    visit("resolution", m.resolution);
    visit("width", m.width);
    visit("height", m.height);
    visit("origin", m.origin);
  }
};

struct OccupancyGrid {
  static constexpr std::string_view kType = "nav_msgs/msg/OccupancyGrid";
  Header header;
  MapMetaData info;
  std::vector<std::int8_t> data;  // 0 … 100, -1 = unknown
  static void each(auto& m, auto&& visit) {
    visit("header", m.header);
    visit("info", m.info);
    visit("data", m.data);
  }
};

struct KeyValue {
  static constexpr std::string_view kType = "diagnostic_msgs/msg/KeyValue";
  std::string key;
  std::string value;
  static void each(auto& m, auto&& visit) {
    visit("key", m.key);
    visit("value", m.value);
  }
};

struct DiagnosticStatus {
  static constexpr std::string_view kType = "diagnostic_msgs/msg/DiagnosticStatus";
  static constexpr std::byte kOk{0};
  static constexpr std::byte kWarn{1};
  static constexpr std::byte kError{2};
  std::byte level = kOk;
  std::string name;
  std::string message;
  std::string hardware_id;
  std::vector<KeyValue> values;
  static void each(auto& m, auto&& visit) {
    visit("level", m.level);
    visit("name", m.name);
    visit("message", m.message);
    visit("hardware_id", m.hardware_id);
    visit("values", m.values);
  }
};

struct DiagnosticArray {
  static constexpr std::string_view kType = "diagnostic_msgs/msg/DiagnosticArray";
  Header header;
  std::vector<DiagnosticStatus> status;
  static void each(auto& m, auto&& visit) {
    visit("header", m.header);
    visit("status", m.status);
  }
};

/// The definition of a message and its nested types, in the format of recordings and Foxglove ("ros2msg").
/// For Image, CompressedImage, CameraInfo, PointCloud2, DisparityImage, Detection3DArray, OccupancyGrid,
/// TFMessage, TransformStamped, LaserScan, Imu, Odometry, DiagnosticArray, Header and String.
template <Message M>
std::string schema_of();

/// Throws Error if a stamp is more than 2³¹ s from 0.
Time time_of(Stamp stamp);
Stamp stamp_of(Time time);

}  // namespace cairn::ros
