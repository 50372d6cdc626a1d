// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <message_filters/subscriber.h>
#include <message_filters/sync_policies/approximate_time.h>
#include <message_filters/synchronizer.h>

#include <cairn/input/ros_pictures.hpp>
#include <cairn/ros/from_step.hpp>
#include <cairn/sequence/follower.hpp>
#include <cairn/sequence/stamps.hpp>
#include <cairn_ros/conversions.hpp>
#include <geometry_msgs/msg/transform_stamped.hpp>
#include <memory>
#include <optional>
#include <rclcpp/rclcpp.hpp>
#include <rclcpp_components/register_node_macro.hpp>
#include <sensor_msgs/msg/camera_info.hpp>
#include <sensor_msgs/msg/image.hpp>
#include <sensor_msgs/msg/point_cloud2.hpp>
#include <stereo_msgs/msg/disparity_image.hpp>
#include <string>
#include <tf2_msgs/msg/tf_message.hpp>
#include <vision_msgs/msg/detection3_d_array.hpp>

namespace cairn_ros {

using CameraInfo = sensor_msgs::msg::CameraInfo;
using Detections = vision_msgs::msg::Detection3DArray;
using Disparity = stereo_msgs::msg::DisparityImage;
using Image = sensor_msgs::msg::Image;
using PointCloud = sensor_msgs::msg::PointCloud2;
using Transforms = tf2_msgs::msg::TFMessage;

/// Finds and tracks objects in the pairs of left/image_rect and right/image_rect. Every option of `cairn
/// follow` is a parameter of the same name, as text ("match.num_disparities"), read once at the start.
class SegmentNode : public rclcpp::Node {
 public:
  explicit SegmentNode(const rclcpp::NodeOptions& options)
      : rclcpp::Node("cairn", options),
        exec_(cairn::Exec::with_threads(static_cast<int>(declare_parameter("threads", 0)))),
        objects_(create_publisher<Detections>("~/objects", 5)),
        disparity_(create_publisher<Disparity>("~/disparity", 5)),
        obstacles_(create_publisher<PointCloud>("~/obstacles", 5)),
        transforms_(create_publisher<Transforms>("/tf", 100)),
        pairs_(Policy(4), left_, right_, left_info_, right_info_) {
    for (const cairn::OptionInfo& option : cairn::options(config_)) {
      const std::string value = declare_parameter(option.name, option.value);
      if (value != option.value) cairn::set(config_, option.name, value);
    }
    cairn::validate(config_);
    const rmw_qos_profile_t newest = rclcpp::SensorDataQoS().keep_last(2).get_rmw_qos_profile();
    left_.subscribe(this, "left/image_rect", newest);
    right_.subscribe(this, "right/image_rect", newest);
    left_info_.subscribe(this, "left/camera_info", newest);
    right_info_.subscribe(this, "right/camera_info", newest);
    pairs_.registerCallback(&SegmentNode::take, this);
  }

 private:
  using Policy = message_filters::sync_policies::ApproximateTime<Image, Image, CameraInfo, CameraInfo>;

  void take(const Image::ConstSharedPtr& left, const Image::ConstSharedPtr& right,
            const CameraInfo::ConstSharedPtr& left_info, const CameraInfo::ConstSharedPtr& right_info) {
    try {
      const cairn::Stamp stamp = stamp_from(left->header);
      // A bag that starts again or a simulator that is reset is a new run, see clock_step(), maybe of another rig.
      const auto clock = follower_ ? cairn::clock_step(last_, stamp) : cairn::ClockStep::forward;
      if (clock == cairn::ClockStep::repeated)
        throw cairn::Error("left out: a pair with a stamp that is not later than the one before");
      if (clock == cairn::ClockStep::set_back) RCLCPP_WARN(get_logger(), "clock set back, a new run begins");
      if (!follower_ || clock == cairn::ClockStep::set_back) {
        rig_ = cairn::ros::rig_of(camera_info_from(*left_info), camera_info_from(*right_info),
                                  cairn::Size{static_cast<int>(left->width), static_cast<int>(left->height)});
        follower_.emplace(config_, rig_, exec_);
      }
      last_ = stamp;
      const cairn::io::LoadedPair images = cairn::input::pictures_of(
          image_from(*left), "left/image_rect", image_from(*right), "right/image_rect", bits_, {});
      bits_ = images.bits;
      const cairn::io::LoadedImage& seen = images.left;
      const auto pair = cairn::StereoPair::from(seen.gray, images.right.gray, seen.rgb);
      config_ = follower_->config();  // of this frame; it may change options for the next one
      const cairn::TrackedFrame step = follower_->next(pair, stamp);
      if (step.control) {
        RCLCPP_INFO(get_logger(), "%s steadier with %s=%s (was %s)",
                    step.control->is_set ? "set:" : "would be", step.control->candidate.option.c_str(),
                    step.control->candidate.value.c_str(), step.control->before.c_str());
      }
      publish(step, seen, left->header.frame_id);
    } catch (const cairn::Error& error) {
      RCLCPP_ERROR_THROTTLE(get_logger(), *get_clock(), 1000, "%s", error.what());
    }
  }

  void publish(const cairn::TrackedFrame& step, const cairn::io::LoadedImage& seen,
               const std::string& camera) {
    const cairn::ros::Header header = cairn::ros::header_of(step.stamp, camera);
    const cairn::ros::FrameNames names{camera, camera + "_floor", camera + "_map"};
    if (const auto floor = cairn::ros::floor_transform_of(step.stamp, names, step.frame.ground, rig_)) {
      Transforms message;
      message.transforms.push_back(as<geometry_msgs::msg::TransformStamped>(*floor));
      transforms_->publish(message);
    }
    if (objects_->get_subscription_count() > 0)
      objects_->publish(as<Detections>(cairn::ros::detections_of(header, step, rig_)));
    if (disparity_->get_subscription_count() > 0) {
      disparity_->publish(as<Disparity>(
          cairn::ros::disparity_image_of(header, step.frame, rig_, config_.segmentation.match)));
    }
    if (obstacles_->get_subscription_count() > 0) {
      obstacles_->publish(as<PointCloud>(cairn::ros::cloud_of(
          header, step.frame, cairn::ObstacleLabel::obstacle, rig_, seen.gray, seen.rgb)));
    }
  }

  cairn::FollowConfig config_;
  cairn::Exec exec_;
  std::optional<cairn::StereoRig> rig_;
  std::optional<cairn::Follower> follower_;
  cairn::Stamp last_;  // of the pair before
  int bits_ = 8;       // of the images so far
  rclcpp::Publisher<Detections>::SharedPtr objects_;
  rclcpp::Publisher<Disparity>::SharedPtr disparity_;
  rclcpp::Publisher<PointCloud>::SharedPtr obstacles_;
  rclcpp::Publisher<Transforms>::SharedPtr transforms_;
  message_filters::Subscriber<Image> left_;
  message_filters::Subscriber<Image> right_;
  message_filters::Subscriber<CameraInfo> left_info_;
  message_filters::Subscriber<CameraInfo> right_info_;
  message_filters::Synchronizer<Policy> pairs_;
};

}  // namespace cairn_ros

RCLCPP_COMPONENTS_REGISTER_NODE(cairn_ros::SegmentNode)
