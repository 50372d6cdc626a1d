// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <cairn/live/live_frame.hpp>

/// The contents of a live view, channel by channel. Internal to it. (docs/live_view.md, "Channels")
namespace cairn::live {

enum class Channel : std::uint8_t { left, labels, reject, disparity, objects, obstacles, scene, stats, tf };
inline constexpr std::size_t kChannels = 9;
constexpr std::size_t index_of(Channel channel) {
  return static_cast<std::size_t>(channel);
}
constexpr Channel channel_at(std::size_t index) {
  return static_cast<Channel>(index);
}
/// A set of channels.
using ChannelBits = std::uint32_t;
constexpr ChannelBits bit_of(Channel channel) {
  return ChannelBits{1} << index_of(channel);
}

struct ChannelInfo {
  std::string topic;
  std::string_view encoding;
  std::string_view schema_name;
  std::string schema;
  std::string_view schema_encoding;
};
/// By index; clients use index + 1.
const std::array<ChannelInfo, kChannels>& channels();

/// The message of one frame on a channel, shared by all receivers.
struct ViewMessage {
  Channel channel = Channel::left;
  std::uint64_t frame = 0;     // counted by the server
  std::uint64_t stamp_ns = 0;  // of the pair
  std::shared_ptr<const std::vector<std::uint8_t>> payload;
  std::size_t picture_bytes = 0;  // of Channel::left: size of the JPEG file at the end of the payload
};
using ViewMessagePtr = std::shared_ptr<const ViewMessage>;

/// The state of the server, for the statistics.
struct ViewState {
  int clients = 0;
  std::uint64_t skipped = 0;  // messages skipped for slow clients
  bool is_tunable = false;
  bool can_record = false;
  bool is_recording = false;
  bool is_file = false;  // a source that can be paused
  bool is_paused = false;
  std::optional<input::SourceStatus> source;  // now; nullopt: as of the frame
};

/// Without a payload if the frame lacks the data. Throws Error if a message cannot hold the stamp of the frame, or
/// its image cannot be encoded.
ViewMessage encode(Channel channel, const LiveFrame& frame, const std::optional<StereoRig>& rig,
                   const ViewState& state);

}  // namespace cairn::live
