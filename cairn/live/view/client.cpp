// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/live/view/client.hpp>

#include <algorithm>
#include <cairn/core/error.hpp>
#include <cairn/output/json.hpp>
#include <cairn/output/json_line.hpp>
#include <exception>
#include <limits>
#include <utility>

namespace cairn::live {
namespace {

using Json = Parameters::Json;

constexpr std::uint8_t kMessageData = 1;
constexpr int kError = 2;
constexpr std::int64_t kMaxId = std::numeric_limits<std::uint32_t>::max();

Json advertisement() {
  Json all = Json::array();
  for (std::size_t i = 0; i < kChannels; ++i) {
    const ChannelInfo& channel = channels()[i];
    all.push_back({{"id", i + 1},
                   {"topic", channel.topic},
                   {"encoding", channel.encoding},
                   {"schemaName", channel.schema_name},
                   {"schema", channel.schema},
                   {"schemaEncoding", channel.schema_encoding}});
  }
  return {{"op", "advertise"}, {"channels", all}};
}

/// The list for a key, up to a sensible length.
const nlohmann::json& list_of(const nlohmann::json& message, const char* key) {
  constexpr std::size_t kMax = 1000;
  const output::JsonLine line(message);
  const nlohmann::json& list = line.at(key);
  if (!list.is_array() || list.size() > kMax) line.refuse(key, "a list of at most 1000");
  return list;
}

std::set<std::string> names_in(const nlohmann::json& message) {
  std::set<std::string> names;
  for (const nlohmann::json& name : list_of(message, "parameterNames")) {
    if (!name.is_string()) throw Error("`parameterNames` holds " + output::shown(name) + ", expected texts");
    names.insert(name.get<std::string>());
  }
  return names;
}

void store(std::uint64_t value, std::uint8_t* to, int bytes) {
  for (int i = 0; i < bytes; ++i) to[i] = static_cast<std::uint8_t>(value >> (8 * i) & 255);
}

}  // namespace

std::string_view chosen_subprotocol(std::string_view offered) {
  for (const std::string_view known : kSubprotocols) {
    std::string_view rest = offered;
    while (!rest.empty()) {
      const std::size_t end = std::min(rest.find(','), rest.size());
      std::string_view one = rest.substr(0, end);
      while (one.starts_with(' ')) one.remove_prefix(1);
      while (one.ends_with(' ')) one.remove_suffix(1);
      if (one == known) return known;
      rest.remove_prefix(std::min(end + 1, rest.size()));
    }
  }
  return {};
}

Client::Client(Parameters& parameters, const std::string& name, const std::string& session)
    : parameters_(parameters) {
  say({{"op", "serverInfo"},
       {"name", "cairn: " + name},
       {"capabilities", {"parameters", "parametersSubscribe"}},
       {"supportedEncodings", Json::array({"cdr", "json"})},
       {"metadata", {{"cairn", CAIRN_VERSION}}},
       {"sessionId", session}});
  static const std::string advertised = output::json_text(advertisement());
  texts_.push_back(advertised);
}

void Client::say(const Json& message) {
  texts_.push_back(output::json_text(message));
}

void Client::complain(const std::string& what) {
  say({{"op", "status"}, {"level", kError}, {"message", what}});
}

void Client::on_binary() {
  complain("found a binary message, expected JSON: publishing is not supported");
}

void Client::on_text(const std::string& text) {
  try {
    const auto message = output::parsed_json(text);
    if (!message) throw Error("found text that is not JSON, expected {\"op\": …}");
    handle(*message);
  } catch (const std::exception& error) {  // a recorder may throw other exceptions than Error
    complain(error.what());
  }
}

void Client::handle(const nlohmann::json& message) {
  const std::string op = output::JsonLine(message).text("op");
  if (op == "subscribe") return subscribe(list_of(message, "subscriptions"));
  if (op == "unsubscribe") return unsubscribe(list_of(message, "subscriptionIds"));
  if (op == "subscribeParameterUpdates") return watch(message, true);
  if (op == "unsubscribeParameterUpdates") return watch(message, false);
  if (op != "getParameters" && op != "setParameters") {
    throw Error(
        "op: found " + output::shown(op) +
        ", expected subscribe, unsubscribe, getParameters, setParameters, subscribeParameterUpdates or "
        "unsubscribeParameterUpdates");
  }
  const output::JsonLine line(message);
  const bool has_id = !line.at("id").is_null();
  std::set<std::string> names;
  bool wants_answer = true;
  if (op == "getParameters") {
    names = names_in(message);
  } else {
    const nlohmann::json& list = list_of(message, "parameters");
    try {
      parameters_.set(list);
    } catch (const std::exception& error) {
      complain(error.what());
    }
    for (const nlohmann::json& each : list) {
      if (const auto name = each.is_object() ? each.find("name") : each.end();
          name != each.end() && name->is_string())
        names.insert(name->get<std::string>());
    }
    // Reports the state to the client, even if the request was refused.
    wants_answer = !names.empty() || has_id;
    if (names.empty()) names.insert("");
  }
  if (!wants_answer) return;
  Json answer{{"op", "parameterValues"}, {"parameters", parameters_.values(names)}};
  if (has_id) answer["id"] = line.text("id");
  say(answer);
}

void Client::subscribe(const nlohmann::json& list) {
  for (const nlohmann::json& each : list) {
    const output::JsonLine line(each);
    const std::int64_t id = line.integer("id", 0, kMaxId);
    const std::int64_t channel = line.integer("channelId", 1, static_cast<std::int64_t>(kChannels));
    const Channel wanted = channel_at(static_cast<std::size_t>(channel - 1));
    if (subscriptions_.contains(wanted)) {
      throw Error("subscribe: channel " + std::to_string(channel) +
                  " is subscribed to already, expected one subscription to a channel");
    }
    for (const auto& [other, subscription] : subscriptions_) {
      if (subscription.id == id) throw Error("subscribe: the id " + std::to_string(id) + " is in use");
    }
    subscriptions_[wanted].id = static_cast<std::uint32_t>(id);
  }
}

void Client::unsubscribe(const nlohmann::json& list) {
  for (const nlohmann::json& id : list) {
    const auto gone = std::erase_if(subscriptions_, [&](const auto& each) {
      return id.is_number_integer() && id.get<std::int64_t>() == std::int64_t{each.second.id};
    });
    if (gone == 0)
      complain("unsubscribe: found " + output::shown(id) + ", expected the id of a subscription");
  }
}

/// No names means all.
void Client::watch(const nlohmann::json& message, bool on) {
  const std::set<std::string> names = names_in(message);
  if (names.empty()) {
    watches_all_ = on;
    if (!on) watched_.clear();
  }
  for (const std::string& name : names) {
    if (!on) watched_.erase(name);
    if (on && parameters_.has(name)) watched_.insert(name);
  }
}

void Client::changed(const std::set<std::string>& names) {
  for (const std::string& name : names) {
    if (watches_all_ || watched_.contains(name)) to_tell_.insert(name);
  }
}

void Client::offer(const std::vector<ViewMessagePtr>& messages) {
  const bool is_busy = is_mid_frame();
  for (const ViewMessagePtr& message : messages) {
    const auto place = subscriptions_.find(message->channel);
    if (place == subscriptions_.end() || place->second.last_frame >= message->frame) continue;
    Subscription& subscription = place->second;
    const bool was_refused = subscription.offered == message->frame;
    subscription.offered = message->frame;
    if (is_busy && message->frame != begun_) {
      if (!was_refused) ++skipped_;
      continue;
    }
    if (was_refused) --skipped_;
    if (subscription.waiting) ++skipped_;
    subscription.last_frame = message->frame;
    subscription.waiting = message;
  }
}

bool Client::is_mid_frame() const {
  return std::any_of(subscriptions_.begin(), subscriptions_.end(), [&](const auto& each) {
    return each.second.waiting && each.second.waiting->frame == begun_;
  });
}

std::optional<OutgoingMessage> Client::next() {
  OutgoingMessage out;
  if (!texts_.empty()) {
    out.text = std::move(texts_.front());
    texts_.pop_front();
    return out;
  }
  if (!to_tell_.empty()) {
    // Sends current values, as they may have changed several times meanwhile.
    out.text = output::json_text(
        {{"op", "parameterValues"}, {"parameters", parameters_.values(std::exchange(to_tell_, {}))}});
    return out;
  }
  for (std::size_t i = 0; i < kChannels; ++i) {
    const Channel channel = channel_at((turn_ + i) % kChannels);
    const auto place = subscriptions_.find(channel);
    if (place == subscriptions_.end() || !place->second.waiting) continue;
    turn_ = index_of(channel) + 1;
    out.message = std::exchange(place->second.waiting, nullptr);
    out.head[0] = kMessageData;
    store(place->second.id, out.head.data() + 1, 4);
    store(out.message->stamp_ns, out.head.data() + 5, 8);
    begun_ = out.message->frame;
    ++sent_;
    return out;
  }
  return std::nullopt;
}

ChannelBits Client::subscribed() const {
  ChannelBits bits = 0;
  for (const auto& [channel, subscription] : subscriptions_) bits |= bit_of(channel);
  return bits;
}

}  // namespace cairn::live
