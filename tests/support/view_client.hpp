// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <openssl/ssl.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>
#include <zlib.h>

#include <chrono>
#include <cstdint>
#include <cstring>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

/// A client for live views without Boost: HTTP and WebSocket by hand, over TCP or TLS.
namespace cairn::support {

using Bytes = std::vector<std::uint8_t>;

/// A connection to 127.0.0.1 with a read timeout of 10 s.
class Connection {
 public:
  explicit Connection(std::uint16_t port, bool tls = false, int receive_buffer = 0)
      : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    if (receive_buffer > 0)
      ::setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &receive_buffer, sizeof(receive_buffer));
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(port);
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (::connect(socket_, reinterpret_cast<sockaddr*>(&to), sizeof(to)) != 0)
      throw std::runtime_error("cannot connect");
    if (tls) {
      context_.reset(SSL_CTX_new(TLS_client_method()));
      tls_.reset(SSL_new(context_.get()));
      SSL_set_fd(tls_.get(), socket_);
      if (SSL_connect(tls_.get()) != 1) throw std::runtime_error("no TLS");
    }
  }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;
  ~Connection() {
    tls_.reset();
    ::close(socket_);
  }

  void send(std::string_view bytes) {
    while (!bytes.empty()) {
      const auto sent = tls_ ? SSL_write(tls_.get(), bytes.data(), static_cast<int>(bytes.size()))
                             : ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (sent <= 0) return;  // the test checks the server's reaction
      bytes.remove_prefix(static_cast<std::size_t>(sent));
    }
  }
  /// Reads exactly that many bytes; false at the end of the connection, or on a timeout.
  bool read(void* to, std::size_t count) {
    auto* at = static_cast<char*>(to);
    while (count > 0) {
      if (!wait()) return false;
      const auto got =
          tls_ ? SSL_read(tls_.get(), at, static_cast<int>(count)) : ::recv(socket_, at, count, 0);
      if (got <= 0) return false;
      at += got;
      count -= static_cast<std::size_t>(got);
    }
    return true;
  }
  /// Reads up to a blank line.
  std::string read_head() {
    std::string head;
    for (char c = 0; !head.ends_with("\r\n\r\n") && read(&c, 1);) head += c;
    return head;
  }
  std::string read_all() {
    std::string all;
    for (char c = 0; read(&c, 1);) all += c;
    return all;
  }

 private:
  bool wait() {
    if (tls_ && SSL_pending(tls_.get()) > 0) return true;
    pollfd ready{socket_, POLLIN, 0};
    return ::poll(&ready, 1, 10'000) == 1;
  }

  struct Free {
    void operator()(SSL_CTX* context) const { SSL_CTX_free(context); }
    void operator()(SSL* tls) const { SSL_free(tls); }
  };
  int socket_;
  std::unique_ptr<SSL_CTX, Free> context_;
  std::unique_ptr<SSL, Free> tls_;
};

struct Answer {
  int status = 0;
  std::string head;
  std::string body;
  /// The value of a header; empty if it is missing.
  [[nodiscard]] std::string header(const std::string& name) const {
    const std::size_t at = head.find("\r\n" + name + ": ");
    if (at == std::string::npos) return {};
    const std::size_t from = at + name.size() + 4;
    return head.substr(from, head.find("\r\n", from) - from);
  }
};

inline Answer answer_of(const std::string& text) {
  Answer answer;
  const std::size_t end = text.find("\r\n\r\n");
  answer.head = text.substr(0, end);
  if (end != std::string::npos) answer.body = text.substr(end + 4);
  if (answer.head.size() > 12) answer.status = std::atoi(answer.head.c_str() + 9);
  return answer;
}

/// "GET / HTTP/1.1" with these headers.
inline std::string request(const std::string& target, const std::string& lines,
                           const std::string& method = "GET") {
  return method + " " + target + " HTTP/1.1\r\n" + lines + "\r\n";
}
inline Answer ask(std::uint16_t port, const std::string& text, bool tls = false) {
  Connection connection(port, tls);
  connection.send(text);
  return answer_of(connection.read_all());
}

inline std::string upgrade(const std::string& target, const std::string& lines,
                           const std::string& subprotocol = "foxglove.sdk.v1") {
  return request(target, lines +
                             "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
                             "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n" +
                             (subprotocol.empty() ? "" : "Sec-WebSocket-Protocol: " + subprotocol + "\r\n"));
}

/// Decompresses the messages of a connection with context takeover (RFC 7692, section 7.2.2).
class Inflater {
 public:
  Inflater() {
    if (inflateInit2(&stream_, -MAX_WBITS) != Z_OK) throw std::runtime_error("no zlib");
  }
  ~Inflater() { inflateEnd(&stream_); }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;

  Bytes inflated(Bytes message) {
    message.insert(message.end(), {0x00, 0x00, 0xff, 0xff});
    Bytes all;
    Bytes part(1 << 16);
    stream_.next_in = message.data();
    stream_.avail_in = static_cast<uInt>(message.size());
    do {
      stream_.next_out = part.data();
      stream_.avail_out = static_cast<uInt>(part.size());
      if (const int status = inflate(&stream_, Z_SYNC_FLUSH); status != Z_OK && status != Z_BUF_ERROR)
        throw std::runtime_error("not deflated");
      all.insert(all.end(), part.data(), stream_.next_out);
    } while (stream_.avail_out == 0);
    return all;
  }

 private:
  z_stream stream_{};
};

/// An open WebSocket.
class WebSocket {
 public:
  using Json = nlohmann::json;
  struct Message {
    int opcode = 0;
    Bytes payload;
    [[nodiscard]] std::string text() const { return {payload.begin(), payload.end()}; }
  };
  /// A message on a channel.
  struct Data {
    std::uint32_t subscription = 0;
    std::uint64_t stamp_ns = 0;
    Bytes payload;
  };

  WebSocket(std::uint16_t port, const std::string& target, const std::string& subprotocol = "foxglove.sdk.v1",
            bool tls = false, int receive_buffer = 0)
      : connection_(port, tls, receive_buffer) {
    connection_.send(upgrade(
        target,
        "Host: 127.0.0.1:" + std::to_string(port) + "\r\nSec-WebSocket-Extensions: permessage-deflate\r\n",
        subprotocol));
    answer_ = answer_of(connection_.read_head());
    if (answer_.status != 101) throw std::runtime_error("not upgraded: " + answer_.head);
    is_compressed_ = !answer_.header("Sec-WebSocket-Extensions").empty();
  }
  [[nodiscard]] const Answer& answer() const { return answer_; }

  void send(const Json& message) { send_frame(1, message.dump()); }
  void send_frame(std::uint8_t opcode, const std::string& payload) {
    std::string frame{static_cast<char>(0x80 | opcode)};
    const std::size_t size = payload.size();
    if (size < 126) {
      frame += static_cast<char>(0x80 | size);
    } else {
      const bool is_long = size > 0xffff;
      frame += static_cast<char>(0x80 | (is_long ? 127 : 126));
      for (int shift = is_long ? 56 : 8; shift >= 0; shift -= 8)
        frame += static_cast<char>(size >> shift & 255);
    }
    connection_.send(frame + std::string(4, '\0') + payload);  // a mask of 0
  }

  /// Sends a compressed text.
  void send_deflated(const std::string& text) {
    z_stream stream{};
    if (deflateInit2(&stream, Z_BEST_SPEED, Z_DEFLATED, -MAX_WBITS, MAX_MEM_LEVEL, Z_DEFAULT_STRATEGY) !=
        Z_OK)
      throw std::runtime_error("no zlib");
    std::string out(deflateBound(&stream, text.size()) + 16, '\0');
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
    stream.avail_in = static_cast<uInt>(text.size());
    stream.next_out = reinterpret_cast<Bytef*>(out.data());
    stream.avail_out = static_cast<uInt>(out.size());
    deflate(&stream, Z_SYNC_FLUSH);
    out.resize(out.size() - stream.avail_out - 4);  // without 00 00 ff ff
    deflateEnd(&stream);
    send_frame(0x41, out);
  }

  /// Skips pings. nullopt if the connection has ended.
  std::optional<Message> read() {
    Message message;
    bool is_deflated = false;
    for (;;) {
      std::array<std::uint8_t, 10> head{};
      if (!connection_.read(head.data(), 2)) return std::nullopt;
      std::uint64_t size = head[1] & 127;
      if (const int more = size == 126 ? 2 : size == 127 ? 8 : 0; more > 0) {
        if (!connection_.read(head.data() + 2, static_cast<std::size_t>(more))) return std::nullopt;
        size = 0;
        for (int i = 0; i < more; ++i) size = size << 8 | head[static_cast<std::size_t>(2 + i)];
      }
      Bytes payload(size);
      if (size > 0 && !connection_.read(payload.data(), size)) return std::nullopt;
      bytes_ += size;
      const int opcode = head[0] & 15;
      const bool is_control = opcode >= 8;
      if (!is_compressed_ || is_control) {
        EXPECT_EQ(head[0] & 0xf0, 0x80) << "a message in one frame, and not compressed";
      }
      if (opcode == 9) continue;
      if (is_control) return Message{opcode, std::move(payload)};
      const bool is_last = (head[0] & 0x80) != 0;
      const bool is_first = opcode != 0;
      if (is_first) {
        message = {opcode, std::move(payload)};
        is_deflated = (head[0] & 0x40) != 0;
      } else {
        message.payload.insert(message.payload.end(), payload.begin(), payload.end());
      }
      if (!is_last) continue;
      if (is_deflated) message.payload = inflater_.inflated(std::move(message.payload));
      return message;
    }
  }
  /// Total payload bytes as received, before decompression.
  [[nodiscard]] std::uint64_t bytes() const { return bytes_; }
  /// The next text with this operation; skips channel messages.
  Json read_op(const std::string& op) {
    while (const auto message = read()) {
      if (message->opcode != 1) continue;
      Json json = Json::parse(message->text());
      if (json.at("op") == "advertise") channels_ = json.at("channels");
      if (json.at("op") == op) return json;
    }
    ADD_FAILURE() << "no " << op;
    return {};
  }
  /// The next message on a channel; skips texts.
  std::optional<Data> read_data() {
    while (const auto message = read()) {
      if (message->opcode != 2 || message->payload.size() < 13) continue;
      EXPECT_EQ(message->payload[0], 1);
      Data data;
      for (int i = 3; i >= 0; --i) data.subscription = data.subscription << 8 | message->payload[1 + slot(i)];
      for (int i = 7; i >= 0; --i) data.stamp_ns = data.stamp_ns << 8 | message->payload[5 + slot(i)];
      data.payload.assign(message->payload.begin() + 13, message->payload.end());
      return data;
    }
    return std::nullopt;
  }
  /// The server's close code; 0 without one.
  int read_close() {
    while (const auto message = read()) {
      if (message->opcode == 8 && message->payload.size() >= 2)
        return message->payload[0] << 8 | message->payload[1];
    }
    return 0;
  }

  /// The id of an advertised topic.
  int channel(const std::string& topic) {
    if (channels_.is_null()) read_op("advertise");
    for (const Json& one : channels_) {
      if (one.at("topic") == topic) return one.at("id").get<int>();
    }
    return 0;
  }
  [[nodiscard]] const Json& channels() {
    channel("");
    return channels_;
  }
  void subscribe(const std::string& topic, int id) {
    send({{"op", "subscribe"}, {"subscriptions", {{{"id", id}, {"channelId", channel(topic)}}}}});
  }

 private:
  static std::size_t slot(int i) { return static_cast<std::size_t>(i); }

  Connection connection_;
  Answer answer_;
  bool is_compressed_ = false;
  Inflater inflater_;
  std::uint64_t bytes_ = 0;
  Json channels_;
};

}  // namespace cairn::support
