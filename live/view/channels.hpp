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

#include "../live_frame.hpp"

/// What a live view shows of a frame, channel by channel. Internal to it. (docs/live_view.md, "Channels")
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
  std::string_view topic;
  std::string_view encoding;
  std::string_view schema_name;
  std::string schema;
  std::string_view schema_encoding;
};
/// By index; clients know them by index + 1.
const std::array<ChannelInfo, kChannels>& channels();

/// One frame's message on a channel, shared by all who get it.
struct ViewMessage {
  Channel channel = Channel::left;
  std::uint64_t frame = 0;     // counted by the server
  std::uint64_t stamp_ns = 0;  // of the pair
  std::vector<std::uint8_t> payload;
  std::size_t picture_bytes = 0;  // of Channel::left: the JPEG file, which the payload ends with
};
using ViewMessagePtr = std::shared_ptr<const ViewMessage>;

/// What the statistics say of the server.
struct ViewState {
  int clients = 0;
  std::uint64_t skipped = 0;  // messages that a slow client did not get
  bool is_tunable = false;
  bool can_record = false;
  bool is_recording = false;
  bool is_file = false;  // that can be paused
  bool is_paused = false;
  std::optional<io::SourceStatus> source;  // now; none: as it was at the frame
};

/// Throws Error where a message cannot hold the frame's stamp, or its image cannot be encoded.
ViewMessage encode(Channel channel, const LiveFrame& frame, const std::optional<StereoRig>& rig,
                   const ViewState& state);

}  // namespace cairn::live
