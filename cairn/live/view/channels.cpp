// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/live/view/channels.hpp>

#include <algorithm>
#include <cairn/live/topics.hpp>
#include <cairn/live/view/frame_json.hpp>

namespace cairn::live {
namespace {

constexpr int kCloudStride = 4;  // px

const Topic& topic_of(Channel channel) {
  static const std::vector<const Topic*> viewed = topics_by(&Topic::viewed);
  return *viewed.at(index_of(channel));
}

}  // namespace

const std::array<ChannelInfo, kChannels>& channels() {
  static const std::array<ChannelInfo, kChannels> all = [] {
    std::array<ChannelInfo, kChannels> made;
    for (std::size_t i = 0; i < kChannels; ++i) {
      const Topic& topic = topic_of(channel_at(i));
      const bool is_ros = topic.type.find('/') != std::string_view::npos;
      made[i] = {full_name(topic), is_ros ? "cdr" : "json", topic.type, topic.schema(),
                 is_ros ? "ros2msg" : "jsonschema"};
    }
    return made;
  }();
  return all;
}

ViewMessage encode(Channel channel, const LiveFrame& frame, const std::optional<StereoRig>& rig,
                   const ViewState& state) {
  ViewMessage message{
      channel, 0, static_cast<std::uint64_t>(std::max<std::int64_t>(0, frame.step.stamp.ns)), {}, 0};
  if (channel == Channel::stats) {
    const std::string json = stats_json(frame, rig, state);
    message.payload = std::make_shared<const ros::Bytes>(json.begin(), json.end());
  } else {
    message.payload = message_of(topic_of(channel), frame, {.rig = rig, .cloud_stride = kCloudStride});
  }
  if (channel == Channel::left) message.picture_bytes = left_jpeg(frame)->size();
  return message;
}

}  // namespace cairn::live
