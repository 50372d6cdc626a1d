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

#include "channels.hpp"
#include "parameters.hpp"

/// One viewer's side of the Foxglove WebSocket protocol, without the socket. Internal to the live view; used
/// by one thread.
namespace cairn::live {

inline constexpr std::size_t kMostClientBytes = 64 * 1024;  // of one message
/// Identical on the wire; the first that a client offers in this order is taken.
inline constexpr std::array<std::string_view, 3> kSubprotocols{"foxglove.sdk.v1", "foxglove.websocket.v1",
                                                               "cairn.v1"};
/// The subprotocol for an offer such as "a, b"; empty for none.
std::string_view chosen_subprotocol(std::string_view offered);

/// What is to be sent next: a text, or a message with what stands before its payload.
struct Outgoing {
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

  /// The newest message of a channel. It replaces one that is still waiting.
  void offer(const ViewMessagePtr& message);
  /// Parameters have other values.
  void changed(const std::set<std::string>& names);

  /// What to send next; none: nothing waits.
  std::optional<Outgoing> next();
  /// False: what it asked for is to be read by it before it asks for more.
  [[nodiscard]] bool may_ask() const { return texts_.size() < 16; }

  [[nodiscard]] ChannelBits subscribed() const;
  /// Messages that were replaced.
  [[nodiscard]] std::uint64_t skipped() const { return skipped_; }
  [[nodiscard]] std::uint64_t sent() const { return sent_; }

 private:
  using Json = Parameters::Json;
  struct Subscription {
    std::uint32_t id = 0;
    std::uint64_t last_frame = 0;  // that it was offered
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
  std::size_t turn_ = 0;  // of the channels
  std::deque<std::string> texts_;
  std::set<std::string> watched_;
  bool watches_all_ = false;
  std::set<std::string> to_tell_;  // parameters
  std::uint64_t skipped_ = 0;
  std::uint64_t sent_ = 0;
};

}  // namespace cairn::live
