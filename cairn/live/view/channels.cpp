// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/live/view/channels.hpp>

#include <algorithm>
#include <cairn/core/image.hpp>
#include <cairn/io/raster.hpp>
#include <cairn/ros/from_step.hpp>
#include <cmath>

#include <cairn/live/view/frame_json.hpp>

namespace cairn::live {
namespace {

constexpr int kJpegQuality = 85;
constexpr int kCloudStride = 4;  // px

template <ros::Message M>
ChannelInfo of_ros(std::string_view topic) {
  return {topic, "cdr", M::kType, ros::schema_of<M>(), "ros2msg"};
}

std::string jpeg_of(const io::LoadedImage& picture) {
  const View<const Gray> grey = picture.gray;
  const View<const Rgb> colour = picture.rgb;
  io::PixelRows rows{grey.size(), 1, 1, grey.data(), grey.stride()};
  if (!colour.empty()) {
    rows = {colour.size(), 3, 1, reinterpret_cast<const std::uint8_t*>(colour.data()), colour.stride() * 3};
  }
  return io::encode_jpeg(rows, kJpegQuality);
}

/// 0 = hole, 1 … 255 over the search range.
ros::Image disparity_of(const ros::Header& header, View<const float> disparity_px, const MatchConfig& match) {
  Image<Gray> grey(disparity_px.size());
  const auto low = static_cast<float>(match.min_disparity);
  const float scale = 254.0F / static_cast<float>(match.num_disparities);
  for (int y = 0; y < disparity_px.height(); ++y) {
    const float* const from = disparity_px.row(y);
    std::transform(from, from + disparity_px.width(), grey.row(y), [&](float d) {
      if (!std::isfinite(d)) return Gray{0};
      // Rounds, as numbers from 1 on: std::round() is a call for each pixel, and took a third of all encoding.
      return static_cast<Gray>(std::clamp(1 + (d - low) * scale, 1.0F, 255.0F) + 0.5F);
    });
  }
  return ros::image_of(header, View<const Gray>(grey));
}

std::vector<std::uint8_t> bytes_of(const std::string& text) {
  return {text.begin(), text.end()};
}

}  // namespace

const std::array<ChannelInfo, kChannels>& channels() {
  static const std::array<ChannelInfo, kChannels> all{
      of_ros<ros::CompressedImage>("/cairn/left"),
      of_ros<ros::Image>("/cairn/labels"),
      of_ros<ros::Image>("/cairn/reject"),
      of_ros<ros::Image>("/cairn/disparity"),
      of_ros<ros::Detection3DArray>("/cairn/objects"),
      of_ros<ros::PointCloud2>("/cairn/obstacles"),
      ChannelInfo{"/cairn/scene", "json", "foxglove.SceneUpdate", std::string(kSceneSchema), "jsonschema"},
      ChannelInfo{"/cairn/stats", "json", "cairn.Stats", std::string(kStatsSchema), "jsonschema"},
      of_ros<ros::TFMessage>("/tf")};
  return all;
}

ViewMessage encode(Channel channel, const LiveFrame& frame, const std::optional<StereoRig>& rig,
                   const ViewState& state) {
  const TrackedFrame& step = frame.step;
  const io::LoadedImage& left = frame.pair->left;
  const ros::FrameNames names = ros::frame_names(frame.pair->frame_id);
  const auto header = [&] { return ros::header_of(step.stamp, names.camera); };
  ViewMessage message{
      channel, 0, static_cast<std::uint64_t>(std::max<std::int64_t>(0, step.stamp.ns)), {}, 0};
  auto& payload = message.payload;
  switch (channel) {
    case Channel::left: {
      const std::string jpeg = jpeg_of(left);
      payload = ros::encode(ros::CompressedImage{header(), "jpeg", bytes_of(jpeg)});
      message.picture_bytes = jpeg.size();
      break;
    }
    case Channel::labels:
      payload = ros::encode(ros::labels_of(header(), step));
      break;
    case Channel::reject:
      payload = ros::encode(ros::reject_of(header(), step.frame));
      break;
    case Channel::disparity:
      payload = ros::encode(
          disparity_of(header(), step.frame.disparity.disparity_px, frame.config->segmentation.match));
      break;
    case Channel::objects:
      payload = ros::encode(ros::detections_of(header(), step, rig));
      break;
    case Channel::obstacles:
      payload = ros::encode(ros::cloud_of(header(), step.frame, ObstacleLabel::obstacle, rig, left.gray,
                                          left.rgb, kCloudStride));
      break;
    case Channel::scene:
      payload = bytes_of(scene_json(frame, rig));
      break;
    case Channel::stats:
      payload = bytes_of(stats_json(frame, rig, state));
      break;
    case Channel::tf:
      payload = ros::encode(ros::transforms_of(names, step, rig));
      break;
  }
  return message;
}

}  // namespace cairn::live
