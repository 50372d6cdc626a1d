// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <array>
#include <utility>

#include <cairn/ros/dds/participant.hpp>

namespace cairn::ros {
namespace {

/// tests/unit/ros/dds_test.cpp derives them from the members of the messages.
constexpr std::array<std::pair<std::string_view, std::string_view>, 13> kTypeHashes{
    {{"std_msgs/msg/String", "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"},
     {"sensor_msgs/msg/Image", "RIHS01_d31d41a9a4c4bc8eae9be757b0beed306564f7526c88ea6a4588fb9582527d47"},
     {"sensor_msgs/msg/CameraInfo",
      "RIHS01_b3dfd68ff46c9d56c80fd3bd4ed22c7a4ddce8c8348f2f59c299e73118e7e275"},
     {"sensor_msgs/msg/PointCloud2",
      "RIHS01_9198cabf7da3796ae6fe19c4cb3bdd3525492988c70522628af5daa124bae2b5"},
     {"stereo_msgs/msg/DisparityImage",
      "RIHS01_1ec1ff6b5bace919e4544a37f2d96ead9f81783701b7b7a4d97a09325ecf2711"},
     {"vision_msgs/msg/Detection3DArray",
      "RIHS01_793f5eab9595ac1c0da07873cc859db42eae51f0ee76056db8562515d830e018"},
     {"nav_msgs/msg/OccupancyGrid",
      "RIHS01_8d348150c12913a31ee0ec170fbf25089e4745d17035792a1ba94d6f0bc0cfc7"},
     {"geometry_msgs/msg/PoseWithCovarianceStamped",
      "RIHS01_26432f9803e43727d3c8f668d1fdb3c630f548af631e2f4e31382371bfea3b6e"},
     {"sensor_msgs/msg/LaserScan", "RIHS01_64c191398013af96509d518dac71d5164f9382553fce5c1f8cca5be7924bd828"},
     {"sensor_msgs/msg/Imu", "RIHS01_7d9a00ff131080897a5ec7e26e315954b8eae3353c3f995c55faf71574000b5b"},
     {"nav_msgs/msg/Odometry", "RIHS01_3cc97dc7fb7502f8714462c526d369e35b603cfc34d946e3f2eda2766dfec6e0"},
     {"diagnostic_msgs/msg/DiagnosticArray",
      "RIHS01_5a8a36efb05fb25070fa0fb3810290c0e6cd4862b54a8fb975a1ee8dc55a333e"},
     {"tf2_msgs/msg/TFMessage", "RIHS01_e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087"}}};

}  // namespace

std::string_view type_hash(std::string_view ros_type) {
  for (const auto& [type, hash] : kTypeHashes)
    if (type == ros_type) return hash;
  return {};
}

}  // namespace cairn::ros
