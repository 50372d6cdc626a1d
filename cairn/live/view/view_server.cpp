// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <utility>  // required by awaitable.hpp of Boost 1.74 in C++20

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core/buffers_to_string.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/ssl.hpp>
#include <boost/beast/websocket.hpp>
#include <boost/beast/websocket/ssl.hpp>

#include <cairn/live/view/view_server.hpp>

#include <algorithm>
#include <atomic>
#include <cairn/core/error.hpp>
#include <cairn/io/names_and_numbers.hpp>
#include <cairn/output/web/live_page.hpp>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <thread>

#include <cairn/live/view/access.hpp>
#include <cairn/live/view/client.hpp>
#include <cairn/live/view/frame_json.hpp>

// Boost.Beast is confined to this file: compiling it takes longer than the rest of the folder.
namespace cairn::live {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using tcp = asio::ip::tcp;
using ErrorCode = beast::error_code;
using namespace std::chrono_literals;

constexpr auto kPatience = 15s;   // for a request, an answer, a handshake
constexpr auto kIdle = 30s;       // without reading or answering, until a viewer is disconnected
constexpr auto kGoodbye = 500ms;  // to notify viewers at the end
constexpr std::size_t kCompressedFrame = 1 << 16;  // bytes, of a compressed message
constexpr int kSendBuffer = 1 << 17;               // bytes; a larger buffer would only add delay
constexpr std::uint32_t kMaxHeader = 8 * 1024;
constexpr std::uint64_t kMaxBody = 1024;
constexpr int kMaxVisitors = 32;  // connections other than viewers

using Response = http::response<http::string_body>;

std::string_view view(beast::string_view text) {
  return {text.data(), text.size()};
}

/// A connection that receives frames.
class Viewer {
 public:
  Viewer() = default;
  virtual ~Viewer() = default;
  Viewer(const Viewer&) = delete;
  Viewer& operator=(const Viewer&) = delete;
  /// The messages of one frame.
  virtual void offer(const std::vector<ViewMessagePtr>& messages) = 0;
  virtual void changed(const std::set<std::string>& parameters) = 0;
  /// Sends what is queued.
  virtual void pump() = 0;
  virtual void say_goodbye() = 0;
  [[nodiscard]] virtual ChannelBits subscribed() const = 0;
  /// Those of which it would take a message now.
  [[nodiscard]] virtual ChannelBits wanted() const { return subscribed(); }
  [[nodiscard]] virtual std::uint64_t skipped() const = 0;
};

Response plain(http::status status, std::string text) {
  Response response{status, 11};
  response.set(http::field::content_type, "text/plain; charset=utf-8");
  response.body() = std::to_string(static_cast<unsigned>(status)) + ": " + std::move(text) + "\n";
  return response;
}

Response answer(const char* type, std::string text) {
  Response response{http::status::ok, 11};
  response.set(http::field::content_type, type);
  response.body() = std::move(text);
  return response;
}

/// Headers of every answer: no caching, no framing, no referrer.
void harden(Response& response) {
  response.set(http::field::server, "cairn");
  response.set(http::field::cache_control, "no-store");
  response.set("X-Content-Type-Options", "nosniff");
  response.set("X-Frame-Options", "DENY");
  response.set("Referrer-Policy", "no-referrer");
  response.set("Cross-Origin-Resource-Policy", "same-origin");
  response.set("Cross-Origin-Opener-Policy", "same-origin");
  if (response.find("Content-Security-Policy") == response.end())
    response.set("Content-Security-Policy", "default-src 'none'; frame-ancestors 'none'");
  response.keep_alive(false);
  response.prepare_payload();
}

}  // namespace

/// All functions but offer() and the encoder run on one thread.
class ViewServer::Hub {
 public:
  Hub(ViewOptions options, ViewedRun run)
      : options_(std::move(options)),
        access_(options_),
        run_(std::move(run)),
        parameters_(run_, options_.tunable),
        session_(random_token()) {
    if (access_.is_tls()) load_tls();
    listen();
    accept();
    server_ = std::thread([this] {
      while (true) {
        try {
          io_.run();
          return;
        } catch (const std::exception&) {  // a failed answer does not affect the others
        }
      }
    });
    encoder_ = std::thread([this] { encode_frames(); });
  }
  ~Hub() { close(); }
  Hub(const Hub&) = delete;
  Hub& operator=(const Hub&) = delete;

  // Called from the run's thread:

  void offer(const LiveFramePtr& frame) {
    LiveFramePtr old = frame;  // freed after the lock is released: its images are large
    {
      const std::lock_guard lock(mutex_);
      if (is_closed_) return;
      std::swap(newest_, old);
      ++newest_number_;
      is_new_ = true;
    }
    wake_.notify_one();
  }

  void close() {
    {
      const std::lock_guard lock(mutex_);
      if (std::exchange(is_closed_, true)) return;
    }
    wake_.notify_all();
    encoder_.join();
    asio::post(io_, [this] { say_goodbye(); });
    server_.join();
    newest_.reset();
  }

  [[nodiscard]] std::uint16_t port() const { return port_; }
  [[nodiscard]] std::uint64_t encoded() const { return encoded_; }
  [[nodiscard]] std::string url() const {
    std::string host = options_.address;
    if (host == "0.0.0.0" || host == "::") {
      host = io::host_name();
      if (host.empty()) host = "localhost";
    }
    if (host.find(':') != std::string::npos) host = "[" + host + "]";
    return (access_.is_tls() ? "https://" : "http://") + host + ":" + std::to_string(port_) +
           "/?token=" + access_.token();
  }
  [[nodiscard]] std::string summary() const {
    std::string text = "view: " + std::to_string(most_clients_) +
                       (most_clients_ == 1 ? " viewer" : " viewers") + " at most, " +
                       std::to_string(encoded_) + " messages encoded, " + std::to_string(skipped_before_) +
                       " skipped because a viewer was slow";
    if (!trouble_.empty()) text += "; " + trouble_;
    return text;
  }

  // Called from the server's thread:

  [[nodiscard]] const Access& access() const { return access_; }
  /// New connections are refused.
  [[nodiscard]] bool is_ending() const { return !acceptor_.is_open(); }
  [[nodiscard]] bool is_on_network() const { return !is_loopback(options_.address); }
  [[nodiscard]] Parameters& parameters() { return parameters_; }
  [[nodiscard]] const std::string& session() const { return session_; }
  [[nodiscard]] const std::string& source_name() const { return run_.name; }
  [[nodiscard]] asio::ssl::context& tls() { return *tls_; }
  [[nodiscard]] bool is_full() const {
    return viewers_.size() >= static_cast<std::size_t>(options_.max_clients);
  }

  void add_visitor() { ++visitors_; }
  void remove_visitor() { --visitors_; }
  void add(Viewer& viewer) {
    viewers_.insert(&viewer);
    most_clients_ = std::max(most_clients_, viewers_.size());
    note_subscriptions();
  }
  void remove(Viewer& viewer) {
    if (viewers_.erase(&viewer) == 0) return;
    skipped_before_ += viewer.skipped();
    note_subscriptions();
  }
  /// Called when a viewer subscribes or leaves. New subscribers also get the current frame.
  void note_subscriptions() { note_demand(0); }
  /// Called when the demand changes: by a viewer that has received frame number `had`, and needs the current one if
  /// that is newer.
  void note_demand(std::uint64_t had) {
    ChannelBits all = 0;
    std::uint64_t skipped = skipped_before_;
    for (const Viewer* viewer : viewers_) {
      all |= viewer->wanted();
      skipped += viewer->skipped();
    }
    clients_ = static_cast<int>(viewers_.size());
    skipped_ = skipped;
    {
      const std::lock_guard lock(mutex_);
      wanted_ = all;
      is_new_ = is_new_ || newest_number_ > had;  // if nobody can take it now, it waits
    }
    wake_.notify_one();
  }
  /// Sends changed parameters to their subscribers, whoever changed them.
  void tell_changes() {
    const std::set<std::string> changed = parameters_.take_changes();
    if (changed.empty()) return;
    for (Viewer* viewer : std::set<Viewer*>(viewers_)) {
      viewer->changed(changed);
      viewer->pump();
    }
  }

  Response respond(const ViewVerdict& verdict, std::string_view host) {
    if (verdict.status == 303) {
      Response response{http::status::see_other, 11};
      response.set(http::field::location, "/");
      response.set(http::field::set_cookie, verdict.cookie);
      return response;
    }
    if (verdict.status != 200) return plain(static_cast<http::status>(verdict.status), verdict.text);
    if (verdict.path == "/") return page(host);
    if (verdict.path == "/options.json") return answer("application/json", parameters_.options_json());
    if (verdict.path == "/config.yaml") return answer("text/yaml; charset=utf-8", parameters_.config_yaml());
    if (verdict.path == "/status.json") return answer("application/json", status_json());
    return plain(http::status::not_found,
                 "expected /, /options.json, /config.yaml, /status.json or /left.mjpeg");
  }

 private:
  // ---- listening ----

  void load_tls() {
    tls_.emplace(asio::ssl::context::tls_server);
    SSL_CTX_set_min_proto_version(tls_->native_handle(), TLS1_2_VERSION);
    ErrorCode error;
    tls_->use_certificate_chain_file(options_.tls_cert, error);
    if (error) throw Error("--tls-cert: " + options_.tls_cert + ": " + error.message() + ", expected PEM");
    tls_->use_private_key_file(options_.tls_key, asio::ssl::context::pem, error);
    if (error) throw Error("--tls-key: " + options_.tls_key + ": " + error.message() + ", expected PEM");
    if (SSL_CTX_check_private_key(tls_->native_handle()) != 1)
      throw Error("--tls-key: " + options_.tls_key + ": is not the key of " + options_.tls_cert);
  }

  void listen() {
    const tcp::endpoint at(asio::ip::make_address(options_.address), options_.port);
    ErrorCode error;
    acceptor_.open(at.protocol(), error);
    if (!error) acceptor_.set_option(asio::socket_base::reuse_address(true), error);
    if (!error) acceptor_.bind(at, error);
    if (!error) acceptor_.listen(asio::socket_base::max_listen_connections, error);
    if (error) {
      throw Error("--view: " + options_.address + ":" + std::to_string(options_.port) +
                  " cannot be listened on: " + error.message());
    }
    port_ = acceptor_.local_endpoint().port();
  }

  void accept() {
    acceptor_.async_accept([this](ErrorCode error, tcp::socket socket) {
      if (error == asio::error::operation_aborted || !acceptor_.is_open()) return;
      if (error) {  // e.g. too many open files
        pause_.expires_after(100ms);
        pause_.async_wait([this](ErrorCode) { accept(); });
        return;
      }
      if (visitors_ < kMaxVisitors + options_.max_clients) welcome(std::move(socket));
      accept();
    });
  }
  void welcome(tcp::socket socket);

  void say_goodbye() {
    ErrorCode ignored;
    acceptor_.close(ignored);
    pause_.cancel();
    for (Viewer* viewer : std::set<Viewer*>(viewers_)) viewer->say_goodbye();
    if (viewers_.empty()) return io_.stop();
    goodbye_.expires_after(kGoodbye);
    goodbye_.async_wait([this](ErrorCode) { io_.stop(); });
    until_gone();
  }
  void until_gone() {
    if (viewers_.empty()) return io_.stop();
    pause_.expires_after(10ms);
    pause_.async_wait([this](ErrorCode) { until_gone(); });
  }

  // ---- HTTP answers ----

  Response page(std::string_view host) {
    const std::string nonce = random_token();
    Response response = answer("text/html; charset=utf-8", output::live_page(nonce));
    // In older browsers 'self' does not include WebSockets. The host is one of ours: Access has checked it.
    response.set("Content-Security-Policy",
                 "default-src 'none'; script-src 'nonce-" + nonce + "'; style-src 'nonce-" + nonce +
                     "'; img-src 'self' data: blob:; connect-src 'self' " +
                     (access_.is_tls() ? "wss://" : "ws://") + std::string(host) +
                     "; base-uri 'none'; form-action 'none'; frame-ancestors 'none'");
    return response;
  }

  std::string status_json() {
    LiveFramePtr frame;
    {
      const std::lock_guard lock(mutex_);
      frame = newest_;
    }
    return (frame ? stats_json(*frame, run_.rig, state()) : stats_json(state())) + "\n";
  }

  [[nodiscard]] ViewState state() const {
    ViewState state;
    state.clients = clients_;
    state.skipped = skipped_;
    state.is_tunable = options_.tunable;
    state.can_record = static_cast<bool>(run_.record);
    state.is_recording = run_.is_recording && run_.is_recording();
    state.is_file = static_cast<bool>(run_.pause);
    state.is_paused = run_.is_paused && run_.is_paused();
    if (run_.source) state.source = run_.source();
    return state;
  }

  // ---- encoding frames ----

  /// Runs on its own thread: encodes the newest frame's messages that have subscribers, each once.
  void encode_frames() {
    std::array<ViewMessagePtr, kChannels> made;
    std::unique_lock lock(mutex_);
    for (;;) {
      wake_.wait(lock, [&] { return is_closed_ || (is_new_ && wanted_ != 0 && !is_delivering_); });
      if (is_closed_) return;
      is_new_ = false;
      is_delivering_ = true;
      LiveFramePtr frame = newest_;
      const std::uint64_t number = newest_number_;
      const ChannelBits wanted = wanted_;
      lock.unlock();
      std::vector<ViewMessagePtr> messages;
      for (std::size_t i = 0; i < kChannels; ++i) {
        if ((wanted & bit_of(channel_at(i))) == 0) continue;
        if (!made[i] || made[i]->frame != number) made[i] = encoded_message(channel_at(i), *frame, number);
        if (made[i]) messages.push_back(made[i]);
      }
      const std::uint64_t revision = frame->revision;
      frame.reset();
      asio::post(io_, [this, messages = std::move(messages), number, revision] {
        deliver(messages, number, revision);
      });
      lock.lock();
    }
  }

  ViewMessagePtr encoded_message(Channel channel, const LiveFrame& frame, std::uint64_t number) {
    try {
      auto message = std::make_shared<ViewMessage>(encode(channel, frame, run_.rig, state()));
      if (!message->payload) return nullptr;
      message->frame = number;
      ++encoded_;
      return message;
    } catch (const std::exception& error) {  // running out of memory here must not end the robot's run
      trouble_ = channels()[index_of(channel)].topic + " could not be sent: " + error.what();
      return nullptr;
    }
  }

  void deliver(const std::vector<ViewMessagePtr>& messages, std::uint64_t number, std::uint64_t revision) {
    // Viewers are not destroyed meanwhile: only completion handlers do that.
    for (Viewer* viewer : std::set<Viewer*>(viewers_)) {
      viewer->offer(messages);
      viewer->pump();
    }
    note_demand(number);
    if (std::exchange(revision_, revision) != revision) tell_changes();
    {
      const std::lock_guard lock(mutex_);
      is_delivering_ = false;
    }
    wake_.notify_one();
  }

  ViewOptions options_;
  Access access_;
  ViewedRun run_;
  Parameters parameters_;
  std::string session_;

  int visitors_ = 0;
  std::set<Viewer*> viewers_;
  std::size_t most_clients_ = 0;
  std::uint64_t skipped_before_ = 0;  // by viewers that left
  std::uint64_t revision_ = 0;

  std::mutex mutex_;  // guards the members below
  std::condition_variable wake_;
  LiveFramePtr newest_;
  std::uint64_t newest_number_ = 0;
  bool is_new_ = false;  // a new frame, or a new subscription
  bool is_delivering_ = false;
  bool is_closed_ = false;
  ChannelBits wanted_ = 0;

  std::atomic<int> clients_ = 0;
  std::atomic<std::uint64_t> skipped_ = 0;
  std::atomic<std::uint64_t> encoded_ = 0;
  std::string trouble_;  // of the encoder

  // Last member, so that open connections are destroyed before what they use.
  asio::io_context io_{1};
  std::optional<asio::ssl::context> tls_;
  tcp::acceptor acceptor_{io_};
  asio::steady_timer pause_{io_};
  asio::steady_timer goodbye_{io_};
  std::uint16_t port_ = 0;

  std::thread server_;
  std::thread encoder_;
};

namespace {

// ---- streams with and without TLS ----

using PlainStream = beast::tcp_stream;
using TlsStream = beast::ssl_stream<beast::tcp_stream>;

beast::tcp_stream& socket_of(PlainStream& stream) {
  return stream;
}
beast::tcp_stream& socket_of(TlsStream& stream) {
  return stream.next_layer();
}

/// A motion JPEG stream for clients without scripts.
template <class Hub, class Stream>
class MovingPicture : public Viewer, public std::enable_shared_from_this<MovingPicture<Hub, Stream>> {
 public:
  MovingPicture(Hub& hub, Stream stream) : hub_(hub), stream_(std::move(stream)) {}
  ~MovingPicture() override {
    hub_.remove(*this);
    hub_.remove_visitor();
  }

  void begin() {
    hub_.add_visitor();
    hub_.add(*this);
    socket_of(stream_).expires_never();
    listen_for_end();
    text_ =
        "HTTP/1.1 200 OK\r\nServer: cairn\r\nCache-Control: no-store\r\nConnection: close\r\n"
        "X-Content-Type-Options: nosniff\r\nCross-Origin-Resource-Policy: same-origin\r\n"
        "Content-Type: multipart/x-mixed-replace; boundary=cairn\r\n\r\n--cairn\r\n";
    write(asio::buffer(text_));
  }
  void offer(const std::vector<ViewMessagePtr>& messages) override {
    for (const ViewMessagePtr& message : messages) {
      if (message->channel != Channel::left || message->frame <= last_) continue;
      last_ = message->frame;
      if (waiting_) ++skipped_;
      waiting_ = message;
    }
  }
  void changed(const std::set<std::string>&) override {}
  void pump() override {
    if (is_writing_ || !waiting_) return;
    sending_ = std::exchange(waiting_, nullptr);
    text_ =
        "Content-Type: image/jpeg\r\nContent-Length: " + std::to_string(sending_->picture_bytes) + "\r\n\r\n";
    const auto& payload = *sending_->payload;
    const std::array<asio::const_buffer, 3> parts{
        asio::buffer(text_),
        asio::buffer(payload.data() + (payload.size() - sending_->picture_bytes), sending_->picture_bytes),
        asio::buffer(kEndOfPart)};
    write(parts);
  }
  void say_goodbye() override { end(); }
  [[nodiscard]] ChannelBits subscribed() const override { return bit_of(Channel::left); }
  [[nodiscard]] std::uint64_t skipped() const override { return skipped_; }

 private:
  static constexpr std::string_view kEndOfPart = "\r\n--cairn\r\n";

  template <class Buffers>
  void write(const Buffers& buffers) {
    is_writing_ = true;
    socket_of(stream_).expires_after(kIdle);
    asio::async_write(stream_, buffers, [self = this->shared_from_this()](ErrorCode error, std::size_t) {
      if (error) return self->end();
      self->is_writing_ = false;
      self->sending_.reset();
      self->pump();
    });
  }
  void listen_for_end() {
    stream_.async_read_some(asio::buffer(nothing_),
                            [self = this->shared_from_this()](ErrorCode error, std::size_t) {
                              if (error) return self->end();
                              self->listen_for_end();
                            });
  }
  void end() {
    socket_of(stream_).close();
    hub_.remove(*this);
  }

  Hub& hub_;
  Stream stream_;
  std::array<char, 64> nothing_{};
  std::string text_;
  ViewMessagePtr waiting_;
  ViewMessagePtr sending_;
  std::uint64_t last_ = 0;
  std::uint64_t skipped_ = 0;
  bool is_writing_ = false;
};

/// A client of the WebSocket protocol.
template <class Hub, class Stream>
class Socket : public Viewer, public std::enable_shared_from_this<Socket<Hub, Stream>> {
 public:
  Socket(Hub& hub, Stream stream)
      : hub_(hub), stream_(std::move(stream)), client_(hub.parameters(), hub.source_name(), hub.session()) {
    hub_.add_visitor();
  }
  ~Socket() override {
    hub_.remove(*this);
    hub_.remove_visitor();
  }

  template <class Request>
  void begin(const Request& request, std::string_view subprotocol) {
    socket_of(stream_.next_layer()).expires_never();
    stream_.set_option(websocket::stream_base::timeout{kPatience, kIdle, true});
    stream_.set_option(websocket::stream_base::decorator([subprotocol](websocket::response_type& response) {
      response.set(http::field::server, "cairn");
      response.set(http::field::sec_websocket_protocol,
                   beast::string_view(subprotocol.data(), subprotocol.size()));
    }));
    stream_.read_message_max(kMaxClientBytes);
    stream_.auto_fragment(false);
    if (hub_.is_on_network()) {
      // Uncompressed labels at a camera's rate exceed the bandwidth of Wi-Fi. Compression costs this thread
      // time for each viewer.
      websocket::permessage_deflate deflate;
      deflate.server_enable = true;
      deflate.compLevel = 1;
      deflate.memLevel = 8;
      stream_.set_option(deflate);
      stream_.write_buffer_bytes(kCompressedFrame);
    }
    hub_.add(*this);
    is_writing_ = true;  // during the handshake
    stream_.async_accept(request, [self = this->shared_from_this()](ErrorCode error) {
      if (error) return self->end();
      self->is_writing_ = false;
      self->is_open_ = true;
      if (self->is_over_) return self->close();
      self->read();
      self->pump();
    });
  }

  void offer(const std::vector<ViewMessagePtr>& messages) override { client_.offer(messages); }
  void changed(const std::set<std::string>& parameters) override { client_.changed(parameters); }
  void pump() override {
    if (is_writing_ || is_over_) return;
    const bool was_mid_frame = client_.is_mid_frame();
    auto next = client_.next();
    if (!next) return;
    out_ = std::move(*next);
    if (was_mid_frame && !client_.is_mid_frame()) hub_.note_demand(client_.begun());
    is_writing_ = true;
    const auto done = [self = this->shared_from_this()](ErrorCode error, std::size_t) {
      self->is_writing_ = false;
      self->out_ = {};
      if (error) return self->end();
      if (!self->is_reading_) self->read();
      self->pump();
    };
    stream_.binary(out_.message != nullptr);
    if (out_.message) {
      const std::array<asio::const_buffer, 2> parts{asio::buffer(out_.head),
                                                    asio::buffer(*out_.message->payload)};
      stream_.async_write(parts, done);
    } else {
      stream_.async_write(asio::buffer(out_.text), done);
    }
  }
  void say_goodbye() override {
    if (!std::exchange(is_over_, true) && is_open_) close();
  }
  [[nodiscard]] ChannelBits subscribed() const override { return client_.subscribed(); }
  [[nodiscard]] ChannelBits wanted() const override {
    return client_.is_mid_frame() ? 0 : client_.subscribed();
  }
  [[nodiscard]] std::uint64_t skipped() const override { return client_.skipped(); }

 private:
  /// Pauses reading while the client does not read its answers.
  void read() {
    if (is_over_ || !client_.may_ask()) return;
    is_reading_ = true;
    stream_.async_read(buffer_, [self = this->shared_from_this()](ErrorCode error, std::size_t) {
      self->is_reading_ = false;
      if (error) return self->end();
      self->take();
    });
  }
  void take() {
    const ChannelBits before = client_.subscribed();
    if (stream_.got_text()) {
      client_.on_text(beast::buffers_to_string(buffer_.data()));
    } else {
      client_.on_binary();
    }
    buffer_.consume(buffer_.size());
    if (client_.subscribed() != before) hub_.note_subscriptions();
    hub_.tell_changes();
    read();
    pump();
  }
  /// Not before the end of the handshake, which also writes.
  void close() {
    stream_.async_close(websocket::close_reason(websocket::close_code::going_away, "the run is over"),
                        [self = this->shared_from_this()](ErrorCode) { self->end(); });
  }
  void end() {
    is_over_ = true;
    hub_.remove(*this);
    socket_of(stream_.next_layer()).close();
  }

  Hub& hub_;
  websocket::stream<Stream> stream_;
  Client client_;
  beast::flat_buffer buffer_;
  OutgoingMessage out_;
  bool is_writing_ = false;
  bool is_reading_ = false;
  bool is_open_ = false;
  bool is_over_ = false;
};

/// A connection until its purpose is known: one request, one answer.
template <class Hub, class Stream>
class Visitor : public std::enable_shared_from_this<Visitor<Hub, Stream>> {
 public:
  Visitor(Hub& hub, Stream stream) : hub_(hub), stream_(std::move(stream)) { hub_.add_visitor(); }
  ~Visitor() { hub_.remove_visitor(); }
  Visitor(const Visitor&) = delete;
  Visitor& operator=(const Visitor&) = delete;

  void begin() {
    socket_of(stream_).expires_after(kPatience);
    if constexpr (std::is_same_v<Stream, TlsStream>) {
      stream_.async_handshake(asio::ssl::stream_base::server,
                              [self = this->shared_from_this()](ErrorCode error) {
                                if (!error) self->read();
                              });
    } else {
      read();
    }
  }

 private:
  void read() {
    parser_.header_limit(kMaxHeader);
    parser_.body_limit(kMaxBody);
    http::async_read(stream_, buffer_, parser_,
                     [self = this->shared_from_this()](ErrorCode error, std::size_t) { self->take(error); });
  }

  void take(ErrorCode error) {
    if (error == http::error::header_limit || error == http::error::body_limit) {
      return say(plain(http::status::payload_too_large, "found a longer request, expected at most 8 kB"));
    }
    if (error) {
      // Answers a request that is not HTTP, but not a closed connection.
      if (error.category() == http::make_error_code(http::error::bad_method).category() &&
          error != http::error::end_of_stream && error != http::error::partial_message)
        return say(plain(http::status::bad_request, "found no HTTP request"));
      return;
    }
    const auto& request = parser_.get();
    const std::string_view host = view(request[http::field::host]);
    const bool is_upgrade = websocket::is_upgrade(request);
    const ViewVerdict verdict = hub_.access().judge({view(request.method_string()), view(request.target()),
                                                     host, view(request[http::field::origin]),
                                                     view(request[http::field::cookie]), is_upgrade});
    if (verdict.status != 200) return say(hub_.respond(verdict, host));
    const bool is_picture = verdict.path == "/left.mjpeg";
    if (!is_upgrade && !is_picture) return say(hub_.respond(verdict, host));
    if (hub_.is_ending()) return end();
    if (hub_.is_full()) {
      return say(
          plain(http::status::service_unavailable, "the largest number of viewers is connected already"));
    }
    if (!is_upgrade) {
      std::make_shared<MovingPicture<Hub, Stream>>(hub_, std::move(stream_))->begin();
      return;
    }
    const std::string_view subprotocol =
        chosen_subprotocol(view(request[http::field::sec_websocket_protocol]));
    if (subprotocol.empty()) {
      return say(plain(http::status::bad_request,
                       "expected one of the subprotocols foxglove.sdk.v1, foxglove.websocket.v1, cairn.v1"));
    }
    std::make_shared<Socket<Hub, Stream>>(hub_, std::move(stream_))->begin(request, subprotocol);
  }

  void say(Response response) {
    harden(response);
    response_ = std::move(response);
    socket_of(stream_).expires_after(kPatience);
    http::async_write(stream_, response_, [self = this->shared_from_this()](ErrorCode error, std::size_t) {
      if (!error) self->end();
    });
  }
  void end() {
    if constexpr (std::is_same_v<Stream, TlsStream>) {
      stream_.async_shutdown([self = this->shared_from_this()](ErrorCode) {});
    } else {
      ErrorCode ignored;
      stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
    }
  }

  Hub& hub_;
  Stream stream_;
  beast::flat_buffer buffer_{kMaxHeader + kMaxBody};
  http::request_parser<http::string_body> parser_;
  Response response_;
};

}  // namespace

void ViewServer::Hub::welcome(tcp::socket socket) {
  ErrorCode ignored;
  socket.set_option(tcp::no_delay(true), ignored);
  socket.set_option(asio::socket_base::send_buffer_size(kSendBuffer), ignored);
  PlainStream stream(std::move(socket));
  if (tls_) {
    std::make_shared<Visitor<Hub, TlsStream>>(*this, TlsStream(std::move(stream), *tls_))->begin();
  } else {
    std::make_shared<Visitor<Hub, PlainStream>>(*this, std::move(stream))->begin();
  }
}

ViewServer::ViewServer(ViewOptions options, ViewedRun run)
    : hub_(std::make_unique<Hub>(std::move(options), std::move(run))) {}
ViewServer::~ViewServer() = default;
void ViewServer::offer(const LiveFramePtr& frame) {
  hub_->offer(frame);
}
void ViewServer::finish() {
  hub_->close();
}
std::string ViewServer::summary() const {
  return hub_->summary();
}
std::uint16_t ViewServer::port() const {
  return hub_->port();
}
std::string ViewServer::url() const {
  return hub_->url();
}
std::uint64_t ViewServer::encoded() const {
  return hub_->encoded();
}

}  // namespace cairn::live
