// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <cairn/live/view/channels.hpp>
#include <cairn/live/view/parameters.hpp>

/// One connection of the Foxglove WebSocket protocol, without the socket. Internal to the live view; used by
/// one thread.
namespace cairn::live {

inline constexpr std::size_t kMaxClientBytes = 64 * 1024;  // of one message
/// Identical on the wire; the first one offered by a client, in this order, is selected.
inline constexpr std::array<std::string_view, 3> kSubprotocols{"foxglove.sdk.v1", "foxglove.websocket.v1",
                                                               "cairn.v1"};
/// The subprotocol for an offer such as "a, b"; empty for none.
std::string_view chosen_subprotocol(std::string_view offered);

/// The next data to send: a text, or a message with a prefix before its payload.
struct OutgoingMessage {
  std::string text;
  ViewMessagePtr message;
  std::array<std::uint8_t, 13> head{};
};

class Client {
 public:
  /// `parameters` must outlive it. `session`: names this run of the server.
  Client(Parameters& parameters, const std::string& name, const std::string& session);

  void on_text(const std::string& text);
  void on_binary();

  /// Queues the messages of the newest frame instead of those that still wait, unless is_mid_frame(): viewers
  /// draw the messages of a frame together.
  void offer(const std::vector<ViewMessagePtr>& messages);
  /// A frame has been sent in part; the rest waits.
  [[nodiscard]] bool is_mid_frame() const;
  /// The frame of the message sent last; 0: none yet.
  [[nodiscard]] std::uint64_t begun() const { return begun_; }
  /// Announces changed values of parameters.
  void changed(const std::set<std::string>& names);

  /// The next data to send; nullopt if nothing waits.
  std::optional<OutgoingMessage> next();
  /// False if the client must first read earlier answers before it sends more requests.
  [[nodiscard]] bool may_ask() const { return texts_.size() < 16; }

  [[nodiscard]] ChannelBits subscribed() const;
  /// Number of messages that were offered and never sent.
  [[nodiscard]] std::uint64_t skipped() const { return skipped_; }
  [[nodiscard]] std::uint64_t sent() const { return sent_; }

 private:
  using Json = Parameters::Json;
  struct Subscription {
    std::uint32_t id = 0;
    std::uint64_t last_frame = 0;  // the last frame queued
    std::uint64_t offered = 0;     // the last frame offered
    ViewMessagePtr waiting;
  };

  void handle(const nlohmann::json& message);
  void subscribe(const nlohmann::json& list);
  void unsubscribe(const nlohmann::json& list);
  void watch(const nlohmann::json& names, bool on);
  void say(const Json& message);
  void complain(const std::string& what);

  Parameters& parameters_;
  std::map<Channel, Subscription> subscriptions_;
  std::size_t turn_ = 0;  // the next channel, round robin
  std::uint64_t begun_ = 0;
  std::deque<std::string> texts_;
  std::set<std::string> watched_;
  bool watches_all_ = false;
  std::set<std::string> to_tell_;  // changed parameters to be sent
  std::uint64_t skipped_ = 0;
  std::uint64_t sent_ = 0;
};

}  // namespace cairn::live
