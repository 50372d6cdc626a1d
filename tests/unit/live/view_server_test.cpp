// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>
#include <malloc.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/x509.h>

#include <atomic>
#include <cairn/core/error.hpp>
#include <cairn/live/runner.hpp>
#include <cairn/live/view/access.hpp>
#include <cairn/live/view/client.hpp>
#include <cairn/live/view/view_server.hpp>
#include <cairn/pipeline/segment.hpp>
#include <cairn/ros/from_step.hpp>
#include <cstdio>
#include <iterator>
#include <map>
#include <mutex>
#include <random>
#include <thread>

#include "support/samples.hpp"
#include "support/temporary_folder.hpp"
#include "support/view_client.hpp"

/// The live view from the side of its clients: over sockets.
namespace cairn::live {
namespace {

using support::Answer;
using support::ask;
using support::request;
using support::upgrade;
using support::WebSocket;
using Json = nlohmann::json;

constexpr const char* kToken = "a-token-of-a-test";

const samples::Sample& sample() {
  static const samples::Sample loaded = samples::load("four_in_a_row");
  return loaded;
}
FollowConfig first_config() {
  FollowConfig config;
  config.segmentation = sample().suited();
  return config;
}
input::SequenceFrame pair_at(std::size_t index) {
  input::SequenceFrame pair;
  pair.name = std::to_string(index);
  pair.index = index;
  pair.stamp.ns = static_cast<std::int64_t>(index + 1) * 100'000'000;
  const auto& images = sample().images;
  pair.left.gray = images.left.gray.clone();
  if (!images.left.rgb.empty()) pair.left.rgb = images.left.rgb.clone();
  pair.right = images.right.gray.clone();
  return pair;
}

/// The result for the sample, computed once; with distinct stamps and numbers.
LiveFramePtr frame_at(int index) {
  static const std::shared_ptr<const input::SequenceFrame> pair =
      std::make_shared<input::SequenceFrame>(pair_at(0));
  static const FollowConfig config = first_config();
  auto frame = std::make_shared<LiveFrame>();
  frame->pair = pair;
  frame->step.index = index;
  frame->step.stamp.ns = (index + 1) * std::int64_t{100'000'000};
  frame->step.is_lost = true;
  frame->step.frame = segment(sample().pair(), sample().calibration.rig, config.segmentation, {});
  frame->config = std::make_shared<const FollowConfig>(config);
  frame->done = Clock::now();
  frame->started = frame->arrived = frame->done - std::chrono::milliseconds(20);
  frame->stages = {{"match", 12.5}};
  frame->findings = {{FindingKind::swapped, Severity::broken, 98, "98 % of 50 points are negative"}};
  frame->rate_hz = 10;
  return frame;
}
/// The same frame under other numbers.
LiveFramePtr renumbered(int index) {
  static const LiveFramePtr first = frame_at(0);
  auto frame = std::make_shared<LiveFrame>();
  frame->pair = first->pair;
  frame->step.index = index;
  frame->step.stamp.ns = (index + 1) * std::int64_t{100'000'000};
  frame->step.frame.disparity.disparity_px = first->step.frame.disparity.disparity_px.clone();
  frame->step.frame.disparity.reject = first->step.frame.disparity.reject.clone();
  frame->step.frame.objects.labels = first->step.frame.objects.labels.clone();
  frame->step.frame.objects.list = first->step.frame.objects.list;
  frame->config = first->config;
  frame->arrived = frame->started = frame->done = Clock::now();
  return frame;
}

ViewedRun run_of_test() {
  ViewedRun run;
  run.name = "a test";
  run.image = sample().images.left.gray.size();
  run.rig = sample().calibration.rig;
  run.config = [config = std::make_shared<const FollowConfig>(first_config())] { return config; };
  return run;
}
ViewOptions options_of_test() {
  ViewOptions options;
  options.port = 0;
  options.token = kToken;
  return options;
}

/// A server, and helpers to talk to it.
struct Served {
  explicit Served(ViewOptions options = options_of_test(), ViewedRun run = run_of_test())
      : server(std::move(options), std::move(run)), port(server.port()) {}

  [[nodiscard]] std::string host() const { return "Host: 127.0.0.1:" + std::to_string(port) + "\r\n"; }
  [[nodiscard]] std::string cookie(const std::string& token = kToken) const {
    return "Cookie: theme=dark; cairn_" + std::to_string(port) + "=" + token + "\r\n";
  }
  [[nodiscard]] std::string with_token(const std::string& path = "/") const {
    std::string all = path;  // GCC 12 falsely warns of a chain of +
    all += "?token=";
    return all += kToken;
  }
  [[nodiscard]] WebSocket connect(const std::string& subprotocol = "foxglove.sdk.v1") const {
    return WebSocket(port, with_token(), subprotocol);
  }

  ViewServer server;
  std::uint16_t port;
};

/// Returns when the server has processed all that the client sent.
void await_processed(WebSocket& client) {
  client.send({{"op", "getParameters"}, {"parameterNames", {"live.none"}}, {"id", "x"}});
  EXPECT_EQ(client.read_op("parameterValues").at("id"), "x");
}

Point3 point_of(const Json& numbers) {
  return {numbers.at(0), numbers.at(1), numbers.at(2)};
}
Point3 middle_of(const Json& corners) {
  Point3 sum;
  for (const Json& corner : corners) sum = sum + point_of(corner);
  return 0.125 * sum;
}
std::string refusal_of(const std::function<void()>& what) {
  try {
    what();
  } catch (const Error& error) {
    return error.what();
  }
  return "no refusal";
}
bool has(const std::string& text, const std::string& words) {
  return text.find(words) != std::string::npos;
}

// ---- access ----

TEST(ViewServer, AcceptsClientsWithTheToken) {
  const Served served;
  EXPECT_EQ(served.server.url(), "http://127.0.0.1:" + std::to_string(served.port) + "/?token=" + kToken);
  EXPECT_EQ(ask(served.port, request("/", served.host())).status, 403);
  EXPECT_EQ(ask(served.port, request("/?token=wrong", served.host())).status, 403);
  EXPECT_EQ(ask(served.port, request("/?token=" + std::string(kToken) + "x", served.host())).status, 403);
  EXPECT_EQ(ask(served.port, request("/", served.host() + served.cookie("wrong"))).status, 403);
  EXPECT_EQ(ask(served.port, request("/?token=wrong", served.host() + served.cookie())).status, 403);
  const Answer first = ask(served.port, request(served.with_token(), served.host()));
  EXPECT_EQ(first.status, 303);
  EXPECT_EQ(first.header("Location"), "/");
  EXPECT_EQ(first.header("Set-Cookie"),
            "cairn_" + std::to_string(served.port) + "=" + kToken + "; Path=/; HttpOnly; SameSite=Strict");
  const Answer page = ask(served.port, request("/", served.host() + served.cookie()));
  EXPECT_EQ(page.status, 200);
  EXPECT_TRUE(has(page.body, "<!doctype html>"));
  EXPECT_FALSE(has(page.body, kToken));
}

TEST(ViewServer, SendsThePageWithAPolicyAndAFreshNonce) {
  const Served served;
  const auto nonce_of = [&] {
    const Answer page = ask(served.port, request("/", served.host() + served.cookie()));
    const std::string policy = page.header("Content-Security-Policy");
    EXPECT_TRUE(policy.starts_with("default-src 'none'; script-src 'nonce-")) << policy;
    EXPECT_FALSE(has(policy, "unsafe")) << policy;
    EXPECT_EQ(page.header("X-Content-Type-Options"), "nosniff");
    EXPECT_EQ(page.header("Cache-Control"), "no-store");
    const std::string nonce = policy.substr(policy.find("nonce-") + 6, 32);
    EXPECT_TRUE(has(page.body, "<script nonce=\"" + nonce + "\">"));
    EXPECT_TRUE(has(page.body, "<style nonce=\"" + nonce + "\">"));
    return nonce;
  };
  EXPECT_NE(nonce_of(), nonce_of());
}

TEST(ViewServer, RefusesForeignHostsMethodsAndPaths) {
  const Served served;
  const auto status = [&](const std::string& text) { return ask(served.port, text).status; };
  const std::string cookie = served.cookie();
  EXPECT_EQ(status(request(served.with_token(), "Host: evil.example\r\n")), 421);
  EXPECT_EQ(status(request(served.with_token(), "Host: 127.0.0.1.evil.example:8765\r\n")), 421);
  EXPECT_EQ(status(request(served.with_token(), "Host: 10.0.0.5\r\n")), 421);
  EXPECT_EQ(status(request(served.with_token(), "")), 421);
  EXPECT_EQ(status(upgrade(served.with_token(), "Host: evil.example\r\n")), 421);
  // Through a tunnel the port differs.
  EXPECT_EQ(status(request(served.with_token(), "Host: localhost:9000\r\n")), 303);
  EXPECT_EQ(status(request(served.with_token(), "Host: [::1]:9000\r\n")), 303);
  EXPECT_EQ(status(request("/", served.host() + cookie + "Content-Length: 0\r\n", "POST")), 405);
  EXPECT_EQ(status(request("/../etc/passwd", served.host() + cookie)), 404);
  EXPECT_EQ(status(request("/", served.host() + cookie + "X: " + std::string(9000, 'x') + "\r\n")), 413);
  EXPECT_EQ(status("what is this?\r\n\r\n"), 400);
}

TEST(ViewServer, RefusesPagesOfOtherOrigins) {
  ViewOptions options = options_of_test();
  options.origins = {"https://viewer.example"};
  const Served served(options);
  const auto status = [&](const std::string& target, const std::string& lines) {
    support::Connection connection(served.port);
    connection.send(upgrade(target, served.host() + lines));
    return support::answer_of(connection.read_head()).status;
  };
  const std::string own = "Origin: http://127.0.0.1:" + std::to_string(served.port) + "\r\n";
  EXPECT_EQ(status("/", ""), 403);
  EXPECT_EQ(status("/", served.cookie()), 101);  // a program
  EXPECT_EQ(status("/", served.cookie() + own), 101);
  EXPECT_EQ(status("/", served.cookie() + "Origin: https://evil.example\r\n"), 403);
  EXPECT_EQ(status("/", served.cookie() + "Origin: http://127.0.0.1:1\r\n"), 403);
  EXPECT_EQ(status("/", served.cookie() + "Origin: null\r\n"), 403);
  EXPECT_EQ(status("/", served.cookie() + "Origin: https://viewer.example\r\n"), 101);
  EXPECT_EQ(status("/", "Origin: https://viewer.example\r\n"), 403);  // without the token
}

TEST(ViewServer, RefusesUnsafeOptions) {
  const auto refusal = [](const std::function<void(ViewOptions&)>& change) {
    return refusal_of([&] {
      ViewOptions options = options_of_test();
      change(options);
      const ViewServer server(options, run_of_test());
    });
  };
  EXPECT_TRUE(has(refusal([](ViewOptions& o) { o.address = "0.0.0.0"; }), "--insecure"));
  EXPECT_TRUE(has(refusal([](ViewOptions& o) { o.address = "robot"; }), "expected an IP address"));
  EXPECT_TRUE(has(refusal([](ViewOptions& o) { o.token = "short"; }), "expected 16 to 128"));
  EXPECT_TRUE(has(refusal([](ViewOptions& o) { o.token = "0123456789abcdef;x"; }), "expected 16 to 128"));
  EXPECT_TRUE(has(refusal([](ViewOptions& o) { o.tls_cert = "a.pem"; }), "no --tls-key"));
  EXPECT_TRUE(has(refusal([](ViewOptions& o) { o.tls_cert = o.tls_key = "missing.pem"; }), "missing.pem"));
  EXPECT_TRUE(has(refusal([](ViewOptions& o) { o.origins = {"*"}; }), "--view-origin: found '*'"));
  const Served served;
  EXPECT_TRUE(has(refusal([&](ViewOptions& o) { o.port = served.port; }), "cannot be listened on"));
  EXPECT_EQ(refusal([](ViewOptions& o) {
              o.address = "0.0.0.0";
              o.insecure = true;
            }),
            "no refusal");
}

TEST(ViewServer, GeneratesATokenOf128Bits) {
  ViewOptions options = options_of_test();
  options.token.clear();
  const ViewServer a(options, run_of_test());
  const ViewServer b(options, run_of_test());
  const auto token = [](const std::string& url) { return url.substr(url.find('=') + 1); };
  EXPECT_EQ(token(a.url()).size(), 32U);
  EXPECT_NE(token(a.url()), token(b.url()));
}

TEST(ViewServer, ReadsAddresses) {
  const auto read = [](const std::string& text) {
    ViewOptions options;
    read_view_address(text, options);
    return options.address + " " + std::to_string(options.port);
  };
  EXPECT_EQ(read("0.0.0.0:80"), "0.0.0.0 80");
  EXPECT_EQ(read("localhost:9000"), "127.0.0.1 9000");
  EXPECT_EQ(read(":9000"), "127.0.0.1 9000");
  EXPECT_EQ(read("10.1.2.3"), "10.1.2.3 8765");
  EXPECT_EQ(read("[::1]:9000"), "::1 9000");
  EXPECT_EQ(read("::1"), "::1 8765");
  for (const char* wrong :
       {"robot:80", "127.0.0.1:x", "127.0.0.1:70000", "127.0.0.1:", "data/samples/overlap"})
    EXPECT_TRUE(has(refusal_of([&] { read(wrong); }), wrong)) << wrong;
}

TEST(ViewServer, LimitsTheNumberOfClients) {
  ViewOptions options = options_of_test();
  options.max_clients = 2;
  const Served served(options);
  WebSocket first = served.connect();
  {
    WebSocket second = served.connect();
    second.read_op("serverInfo");
    EXPECT_EQ(ask(served.port, upgrade(served.with_token(), served.host())).status, 503);
    EXPECT_EQ(ask(served.port, request(served.with_token("/left.mjpeg"), served.host())).status, 503);
  }
  // A client that leaves makes room.
  int status = 503;
  for (int i = 0; i < 100 && status == 503; ++i) {
    support::Connection connection(served.port);
    connection.send(upgrade(served.with_token(), served.host()));
    status = support::answer_of(connection.read_head()).status;
    if (status == 503) std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  EXPECT_EQ(status, 101);
}

TEST(ViewServer, TheRunMayEndDuringAHandshake) {
  for (int i = 0; i <= 12; ++i) {
    auto served = std::make_unique<Served>();
    support::Connection connection(served->port);
    connection.send(upgrade(served->with_token(), served->host()));
    std::this_thread::sleep_for(std::chrono::microseconds(i < 12 ? 50 * i : 500'000));
    served.reset();
    const Answer answer = support::answer_of(connection.read_all());
    EXPECT_TRUE(answer.status == 101 || answer.status == 0) << answer.status;
    EXPECT_TRUE(answer.status == 0 || answer.body.ends_with("\x03\xe9the run is over"));  // 1001
    EXPECT_TRUE(answer.status == 101 || i < 12);
  }
}

// ---- TLS ----

/// A self-signed certificate as PEM files.
void write_certificate(const std::filesystem::path& cert, const std::filesystem::path& key) {
  EVP_PKEY* const pair = EVP_EC_gen("P-256");
  X509* const x509 = X509_new();
  X509_set_version(x509, 2);
  ASN1_INTEGER_set(X509_get_serialNumber(x509), 1);
  X509_gmtime_adj(X509_getm_notBefore(x509), 0);
  X509_gmtime_adj(X509_getm_notAfter(x509), 3600);
  X509_set_pubkey(x509, pair);
  X509_NAME* const name = X509_get_subject_name(x509);
  X509_NAME_add_entry_by_txt(name, "CN", MBSTRING_ASC, reinterpret_cast<const unsigned char*>("localhost"),
                             -1, -1, 0);
  X509_set_issuer_name(x509, name);
  X509_sign(x509, pair, EVP_sha256());
  std::FILE* file = std::fopen(cert.c_str(), "w");
  PEM_write_X509(file, x509);
  std::fclose(file);
  file = std::fopen(key.c_str(), "w");
  PEM_write_PrivateKey(file, pair, nullptr, nullptr, 0, nullptr, nullptr);
  std::fclose(file);
  X509_free(x509);
  EVP_PKEY_free(pair);
}

TEST(ViewServer, SpeaksTls) {
  const support::TemporaryFolder folder;
  ViewOptions options = options_of_test();
  options.tls_cert = folder.path() / "cert.pem";
  options.tls_key = folder.path() / "key.pem";
  write_certificate(options.tls_cert, options.tls_key);
  Served served(options);
  EXPECT_TRUE(served.server.url().starts_with("https://"));
  EXPECT_EQ(ask(served.port, request("/", served.host()), true).status, 403);
  const Answer first = ask(served.port, request(served.with_token(), served.host()), true);
  EXPECT_EQ(first.status, 303);
  EXPECT_TRUE(has(first.header("Set-Cookie"), "; Secure"));
  const Answer page = ask(served.port, request("/", served.host() + served.cookie()), true);
  EXPECT_TRUE(has(page.header("Content-Security-Policy"), "wss://127.0.0.1:"));
  EXPECT_EQ(ask(served.port, request(served.with_token(), served.host())).status, 0);  // no plain-text answer
  // A page loaded without TLS has another origin.
  EXPECT_EQ(ask(served.port,
                upgrade(served.with_token(),
                        served.host() + "Origin: http://127.0.0.1:" + std::to_string(served.port) + "\r\n"),
                true)
                .status,
            403);
  served.server.offer(renumbered(0));
  WebSocket socket(served.port, served.with_token(), "foxglove.websocket.v1", true);
  socket.subscribe("/cairn/labels", 3);
  const auto data = socket.read_data();
  ASSERT_TRUE(data);
  EXPECT_EQ(data->subscription, 3U);
  const auto labels = ros::decode<ros::Image>(data->payload);
  EXPECT_EQ(labels.encoding, "mono16");
  // An address reachable from the network is allowed.
  options.address = "0.0.0.0";
  EXPECT_EQ(refusal_of([&] { const ViewServer open(options, run_of_test()); }), "no refusal");
  // A certificate with the key of another one.
  write_certificate(folder.path() / "other.pem", options.tls_key);
  EXPECT_TRUE(has(refusal_of([&] { const ViewServer wrong(options, run_of_test()); }), "--tls-key"));
}

// ---- the protocol ----

TEST(ViewServer, SpeaksEachSubprotocol) {
  const Served served;
  for (const std::string name : {"foxglove.sdk.v1", "foxglove.websocket.v1", "cairn.v1"}) {
    WebSocket socket = served.connect("unknown.v9, " + name);
    EXPECT_EQ(socket.answer().header("Sec-WebSocket-Protocol"), name);
    EXPECT_EQ(socket.answer().header("Sec-WebSocket-Extensions"), "");
    const Json info = socket.read_op("serverInfo");
    EXPECT_EQ(info.at("name"), "cairn: a test");
    EXPECT_EQ(info.at("capabilities"), Json({"parameters", "parametersSubscribe"}));
    const Json channels = socket.channels();
    EXPECT_EQ(channels.size(), kChannels);
    for (const Json& channel : channels) {
      const bool is_json = channel.at("encoding") == "json";
      EXPECT_EQ(channel.at("schemaEncoding"), is_json ? "jsonschema" : "ros2msg");
      EXPECT_FALSE(channel.at("schema").get<std::string>().empty());
      if (is_json) {
        EXPECT_TRUE(Json::accept(channel.at("schema").get<std::string>())) << channel.at("topic");
      }
    }
  }
  EXPECT_EQ(ask(served.port, upgrade(served.with_token(), served.host(), "")).status, 400);
  EXPECT_EQ(ask(served.port, upgrade(served.with_token(), served.host(), "chat")).status, 400);
  // The first subprotocol that we support, not the first offered.
  EXPECT_EQ(
      served.connect("foxglove.websocket.v1, foxglove.sdk.v1").answer().header("Sec-WebSocket-Protocol"),
      "foxglove.sdk.v1");
}

TEST(ViewServer, CompressesOnlyForRemoteClients) {
  const std::vector<std::string> topics{"/cairn/labels", "/cairn/reject", "/cairn/disparity", "/cairn/left"};
  const auto frame = [&](const std::string& address, std::uint64_t& bytes) {
    ViewOptions options = options_of_test();
    options.address = address;
    options.insecure = address != "127.0.0.1";
    Served served(options);
    WebSocket socket = served.connect();
    EXPECT_EQ(has(socket.answer().header("Sec-WebSocket-Extensions"), "permessage-deflate"),
              options.insecure);
    EXPECT_EQ(socket.channels().size(), kChannels);
    const std::uint64_t before = socket.bytes();
    std::map<std::uint32_t, support::Bytes> got;
    served.server.offer(renumbered(0));
    for (std::size_t i = 0; i < topics.size(); ++i) {
      socket.subscribe(topics[i], static_cast<int>(i));
      if (auto data = socket.read_data()) got[data->subscription] = std::move(data->payload);
    }
    bytes = socket.bytes() - before;
    return got;
  };
  std::uint64_t plain = 0;
  std::uint64_t compressed = 0;
  const auto near = frame("127.0.0.1", plain);
  const auto far = frame("0.0.0.0", compressed);
  EXPECT_EQ(near.size(), topics.size());
  EXPECT_EQ(near, far);
  EXPECT_LT(4 * compressed, plain);
}

TEST(ViewServer, AcceptsCompressedMessagesUpToALimit) {
  ViewOptions options = options_of_test();
  options.address = "0.0.0.0";
  options.insecure = true;
  Served served(options);
  served.server.offer(renumbered(0));
  WebSocket socket = served.connect();
  const int channel = socket.channel("/cairn/labels");
  socket.send_deflated(
      Json{{"op", "subscribe"}, {"subscriptions", {{{"id", 5}, {"channelId", channel}}}}}.dump());
  const auto data = socket.read_data();
  ASSERT_TRUE(data);
  EXPECT_EQ(data->subscription, 5U);
  socket.send_deflated(std::string(1'000'000, 'a'));  // about 4 kB compressed
  EXPECT_EQ(socket.read_close(), 1009);
}

TEST(ViewServer, PublishesTheContentOfTheFrame) {
  Served served;
  const LiveFramePtr frame = frame_at(6);
  served.server.offer(frame);
  WebSocket socket = served.connect();
  const std::vector<std::string> topics{"/cairn/left",      "/cairn/labels",  "/cairn/reject",
                                        "/cairn/disparity", "/cairn/objects", "/cairn/obstacles",
                                        "/cairn/scene",     "/cairn/stats"};
  std::map<std::string, support::Bytes> got;
  for (std::size_t i = 0; i < topics.size(); ++i) {
    socket.subscribe(topics[i], static_cast<int>(i));
    const auto data = socket.read_data();
    ASSERT_TRUE(data) << topics[i];
    EXPECT_EQ(data->stamp_ns, 700'000'000U);
    got[topics[data->subscription]] = data->payload;
  }
  const Frame& found = frame->step.frame;
  const Size size = found.objects.labels.size();
  const auto picture = ros::decode<ros::CompressedImage>(got["/cairn/left"]);
  EXPECT_EQ(picture.format, "jpeg");
  EXPECT_EQ(picture.data[0], 0xff);
  EXPECT_EQ(picture.data[1], 0xd8);
  const auto labels = ros::decode<ros::Image>(got["/cairn/labels"]);
  const auto reject = ros::decode<ros::Image>(got["/cairn/reject"]);
  const auto disparity = ros::decode<ros::Image>(got["/cairn/disparity"]);
  ASSERT_EQ(labels.data.size(), static_cast<std::size_t>(2 * size.area()));
  ASSERT_EQ(disparity.data.size(), static_cast<std::size_t>(size.area()));
  const auto searched = static_cast<float>(frame->config->segmentation.match.num_disparities);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const auto at = static_cast<std::size_t>(y * size.width + x);
      ASSERT_EQ(labels.data[2 * at] | labels.data[2 * at + 1] << 8, number(found.objects.labels(x, y)));
      ASSERT_EQ(reject.data[2 * at] | reject.data[2 * at + 1] << 8,
                static_cast<int>(found.disparity.reject(x, y)));
      const float d = found.disparity.disparity_px(x, y);
      ASSERT_EQ(disparity.data[at], std::isnan(d) ? 0 : std::lround(1 + 254 * d / searched));
    }
  }
  const auto objects = ros::decode<ros::Detection3DArray>(got["/cairn/objects"]);
  EXPECT_EQ(objects.detections.size(), found.objects.list.size());
  EXPECT_GT(ros::decode<ros::PointCloud2>(got["/cairn/obstacles"]).width, 0U);

  const auto json = [&](const std::string& topic) {
    return Json::parse(std::string(got[topic].begin(), got[topic].end()));
  };
  const Json stats = json("/cairn/stats");
  EXPECT_EQ(stats.at("frame"), 6);
  EXPECT_EQ(stats.at("clients"), 1);
  EXPECT_EQ(stats.at("latency_ms"), 20);
  EXPECT_EQ(stats.at("stages"), Json::parse(R"([{"stage":"match","ms":12.5}])"));
  EXPECT_EQ(stats.at("num_disparities"), frame->config->segmentation.match.num_disparities);
  EXPECT_EQ(stats.at("image").at("width"), size.width);
  EXPECT_EQ(stats.at("tunable"), false);
  ASSERT_EQ(stats.at("findings").size(), 1U);
  EXPECT_EQ(stats.at("findings").at(0).at("finding"), "cameras swapped");
  EXPECT_EQ(stats.at("findings").at(0).at("severity"), "broken");
  EXPECT_NEAR(stats.at("rig").at("focal_px").get<double>(), double{sample().calibration.rig->focal_px}, 1e-3);
  EXPECT_NEAR(stats.at("ground").at("normal").at(1).get<double>(), -1, 0.1);  // up
  ASSERT_EQ(stats.at("objects").size(), found.objects.list.size());
  for (std::size_t i = 0; i < found.objects.list.size(); ++i) {
    const Json& object = stats.at("objects").at(i);
    EXPECT_EQ(object.at("id"), i + 1);
    const ros::Point place = objects.detections[i].bbox.center.position;
    const Point3 upright = point_of(object.at("corners_m").at(4)) - point_of(object.at("corners_m").at(0));
    EXPECT_LT(length(point_of(object.at("position_m")) - Point3{place.x, place.y, place.z}), 1e-3);
    EXPECT_NEAR(length(upright), object.at("size_m").at(2).get<double>(), 1e-3);
    EXPECT_NEAR(dot(upright, point_of(stats.at("ground").at("normal"))), length(upright), 1e-3);
    EXPECT_LT(length(point_of(object.at("position_m")) - middle_of(object.at("corners_m"))), 0.25);
  }
  const Json scene = json("/cairn/scene");
  ASSERT_EQ(scene.at("entities").size(), found.objects.list.size());
  const Json& cube = scene.at("entities").at(0).at("cubes").at(0);
  const Json& at = cube.at("pose").at("position");
  const Point3 middle{at.at("x"), at.at("y"), at.at("z")};
  const Json& corners = stats.at("objects").at(0).at("corners_m");
  EXPECT_LT(length(middle - middle_of(corners)), 1e-3);
  // The orientation maps the box's own axes to its edges.
  const Json& turn = cube.at("pose").at("orientation");
  const Pose pose = pose_of(middle, {turn.at("x"), turn.at("y"), turn.at("z"), turn.at("w")});
  const Point3 along = point_of(corners.at(1)) - point_of(corners.at(0));
  EXPECT_LT(length(pose.rotated({cube.at("size").at("x"), 0, 0}) - along), 1e-3);
}

TEST(ViewServer, EncodesSubscribedChannelsOnceAndNoOthers) {
  Served served;
  WebSocket idle = served.connect();
  idle.read_op("advertise");
  for (int i = 0; i < 5; ++i) served.server.offer(renumbered(i));
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_EQ(served.server.encoded(), 0U);
  WebSocket a = served.connect();
  WebSocket b = served.connect("foxglove.websocket.v1");
  a.subscribe("/cairn/left", 1);  // to the current frame
  b.subscribe("/cairn/left", 9);
  ASSERT_TRUE(a.read_data());
  ASSERT_TRUE(b.read_data());
  for (int i = 5; i < 15; ++i) {
    served.server.offer(renumbered(i));
    const auto of_a = a.read_data();
    const auto of_b = b.read_data();
    ASSERT_TRUE(of_a && of_b);
    EXPECT_EQ(of_a->stamp_ns, static_cast<std::uint64_t>(i + 1) * 100'000'000);
    EXPECT_EQ(of_a->payload, of_b->payload);
  }
  EXPECT_EQ(served.server.encoded(), 11U);
  a.send({{"op", "unsubscribe"}, {"subscriptionIds", {1}}});
  b.send({{"op", "unsubscribe"}, {"subscriptionIds", {9}}});
  await_processed(b);
  await_processed(a);
  served.server.offer(renumbered(20));
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_EQ(served.server.encoded(), 11U);
}

TEST(ViewServer, AStalledClientDoesNotDelayOthers) {
  constexpr int kFrames = 200;
  Served served;
  WebSocket reader = served.connect();
  reader.subscribe("/cairn/disparity", 1);
  served.server.offer(renumbered(0));
  ASSERT_TRUE(reader.read_data());
  const auto rate = [&](int from) {
    const auto began = Clock::now();
    for (int i = from; i < from + kFrames; ++i) {
      served.server.offer(renumbered(i));
      const auto data = reader.read_data();
      EXPECT_TRUE(data && data->stamp_ns == static_cast<std::uint64_t>(i + 1) * 100'000'000) << i;
    }
    return kFrames / std::chrono::duration<double>(Clock::now() - began).count();
  };
  const double alone = rate(1);
  const auto heap = [] { return static_cast<double>(mallinfo2().uordblks); };
  const double before = heap();
  WebSocket sleeper(served.port, served.with_token(), "foxglove.sdk.v1", false, 1 << 14);
  sleeper.subscribe("/cairn/disparity", 1);
  const double with_sleeper = rate(1 + kFrames);
  const double more = heap() - before;
  EXPECT_LT(more, 1e6);
  // Rates depend on the computer; that no frame was missed or late does not.
  EXPECT_GT(with_sleeper, 1);
  const Json status =
      Json::parse(ask(served.port, request("/status.json", served.host() + served.cookie())).body);
  EXPECT_EQ(status.at("clients"), 2);
  EXPECT_GT(status.at("skipped"), kFrames / 2);
  RecordProperty("alone_hz", std::to_string(alone));
  RecordProperty("with_sleeper_hz", std::to_string(with_sleeper));
  RecordProperty("bytes", std::to_string(more));
  std::printf("alone %.0f Hz, beside a client that does not read %.0f Hz, %.0f kB\n", alone, with_sleeper,
              more / 1000);
}

TEST(ViewServer, ASlowClientGetsCompleteFrames) {
  const std::vector<std::string> topics{"/cairn/left", "/cairn/labels", "/cairn/reject", "/cairn/disparity",
                                        "/cairn/stats"};
  Served served;
  // It reads little at a time, and has little room.
  WebSocket slow(served.port, served.with_token(), "foxglove.sdk.v1", false, 1 << 14);
  std::uint32_t id = 0;
  for (const std::string& topic : topics) slow.subscribe(topic, ++id);
  await_processed(slow);  // so that the first frame is sent whole
  std::atomic<bool> is_over = false;
  std::atomic<int> offered = 0;
  std::thread run([&] {
    while (!is_over) {
      served.server.offer(renumbered(offered++));
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  });
  std::map<std::uint64_t, std::size_t> messages;  // of a frame
  for (int i = 0; i < 60; ++i) {
    const auto data = slow.read_data();
    if (!data) break;
    ++messages[data->stamp_ns];
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  is_over = true;
  run.join();
  const std::uint64_t last = static_cast<std::uint64_t>(offered) * 100'000'000;
  std::size_t of_last = messages.contains(last) ? messages[last] : 0;
  ASSERT_GT(messages.size(), 4U);
  messages.erase(std::prev(messages.end()));  // cut off
  for (const auto& [stamp, count] : messages) EXPECT_EQ(count, topics.size()) << stamp;
  EXPECT_GT(offered, 2 * static_cast<int>(messages.size()));
  EXPECT_LT(served.server.encoded(), 5U * static_cast<unsigned>(offered) / 2)
      << "encodes what it cannot send";
  // The newest frame comes in the end, though it was offered while another was on its way.
  while (of_last < topics.size()) {
    const auto data = slow.read_data();
    ASSERT_TRUE(data);
    if (data->stamp_ns == last) ++of_last;
  }
}

TEST(ViewServer, ReportsTheCamerasStateWithoutFrames) {
  ViewedRun run = run_of_test();
  run.source = [] {
    input::SourceStatus status;
    status.is_live = true;
    status.is_connected = false;
    status.trouble = "/dev/video0: unplugged";
    return status;
  };
  const Served served(options_of_test(), std::move(run));
  const Json status =
      Json::parse(ask(served.port, request("/status.json", served.host() + served.cookie())).body);
  EXPECT_TRUE(status.at("frame").is_null());
  EXPECT_FALSE(status.at("source").at("is_connected"));
  EXPECT_EQ(status.at("source").at("trouble"), "/dev/video0: unplugged");
}

TEST(ViewServer, EscapesForeignText) {
  Served served;
  WebSocket socket = served.connect();
  const auto complaint = [&](const std::string& text) {
    socket.send_frame(1, text);
    return socket.read_op("status").at("message").get<std::string>();
  };
  EXPECT_TRUE(has(complaint("{"), "not JSON"));
  EXPECT_TRUE(has(complaint(std::string(1000, '[')), "nests deeper"));
  EXPECT_TRUE(has(complaint("7"), "expected an object"));
  EXPECT_TRUE(has(complaint("{}"), "`op` is missing"));
  EXPECT_TRUE(has(complaint(R"({"op":"fly"})"), "found \"fly\", expected subscribe"));
  EXPECT_TRUE(has(complaint(R"({"op":"subscribe"})"), "`subscriptions` is missing"));
  EXPECT_TRUE(
      has(complaint(R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":99}]})"), "`channelId` is 99"));
  EXPECT_TRUE(
      has(complaint(R"({"op":"subscribe","subscriptions":[{"id":-1,"channelId":1}]})"), "`id` is -1"));
  EXPECT_TRUE(
      has(complaint(R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":1},{"id":2,"channelId":1}]})"),
          "subscribed to already"));
  EXPECT_TRUE(has(complaint(R"({"op":"unsubscribe","subscriptionIds":[7]})"), "found 7"));
  EXPECT_TRUE(has(complaint(R"({"op":"getParameters","parameterNames":[1]})"), "holds 1"));
  socket.send_frame(2, "binary");
  EXPECT_TRUE(has(socket.read_op("status").at("message"), "publishing is not supported"));
  socket.send_frame(1, std::string(kMaxClientBytes + 1, ' '));
  EXPECT_EQ(socket.read_close(), 1009);
  // Random bytes: the server survives.
  std::mt19937 random(7);
  for (int round = 0; round < 20; ++round) {
    std::string noise(random() % 300, ' ');
    for (char& c : noise) c = static_cast<char>(random());
    support::Connection raw(served.port);
    raw.send(noise);
    WebSocket other = served.connect();
    other.send_frame(static_cast<std::uint8_t>(random() % 16), noise);
  }
  EXPECT_EQ(ask(served.port, request("/", served.host() + served.cookie())).status, 200);
}

TEST(ViewServer, SurvivesMutatedMessages) {
  const std::vector<std::string> sound{
      R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":2},{"id":3,"channelId":4}]})",
      R"({"op":"unsubscribe","subscriptionIds":[1,3]})",
      R"({"op":"getParameters","parameterNames":["match.method","live.pause"],"id":"x"})",
      R"({"op":"setParameters","parameters":[{"name":"match.min_disparity","value":-3,"type":"float64"}],"id":"y"})",
      R"({"op":"subscribeParameterUpdates","parameterNames":[]})"};
  const std::string_view bits = "{}[]\",:0129-.eE\\ux \x80\xff";
  ViewedRun run = run_of_test();
  int sets = 0;
  run.set = [&](const auto&) { ++sets; };
  Parameters parameters(run, true);
  std::mt19937 random(11);
  for (int round = 0; round < 1500; ++round) {
    Client client(parameters, "a test", "1");
    std::string text = sound[random() % sound.size()];
    for (auto change = random() % 4; change > 0; --change) {
      const std::size_t at = random() % text.size();
      switch (random() % 3) {
        case 0:
          text[at] = bits[random() % bits.size()];
          break;
        case 1:
          text.erase(at, 1 + random() % 5);
          break;
        default:
          text.insert(at, text.substr(random() % text.size(), random() % 20));
      }
      if (text.empty()) text = "{";
    }
    while (client.next()) {
    }  // the greeting
    client.on_text(text);
    int answers = 0;
    while (const auto out = client.next()) {
      ++answers;
      ASSERT_TRUE(Json::accept(out->text)) << text;
    }
    ASSERT_LE(answers, 8) << text;
  }
  EXPECT_GT(sets, 30);
}

TEST(ViewServer, ClosesConnectionsProperly) {
  Served served;
  WebSocket socket = served.connect();
  socket.read_op("advertise");
  served.server.finish();
  EXPECT_EQ(socket.read_close(), 1001);
  EXPECT_TRUE(served.server.summary().starts_with("view: 1 viewer at most"));
  EXPECT_ANY_THROW(served.connect());
}

TEST(ViewServer, ServesAMotionJpegWithoutScripts) {
  Served served;
  served.server.offer(renumbered(0));
  support::Connection connection(served.port);
  connection.send(request(served.with_token("/left.mjpeg"), served.host()));
  const Answer answer = support::answer_of(connection.read_head());
  EXPECT_EQ(answer.status, 200);
  EXPECT_EQ(answer.header("Content-Type"), "multipart/x-mixed-replace; boundary=cairn");
  for (int i = 1; i <= 3; ++i) {
    const std::string head = connection.read_head();
    const std::size_t at = head.find("Content-Length: ");
    ASSERT_NE(at, std::string::npos) << head;
    std::string jpeg(std::stoul(head.substr(at + 16)), '\0');
    ASSERT_TRUE(connection.read(jpeg.data(), jpeg.size()));
    EXPECT_TRUE(jpeg.starts_with("\xff\xd8"));
    EXPECT_TRUE(jpeg.ends_with("\xff\xd9"));
    served.server.offer(renumbered(i));
  }
}

// ---- parameters ----

Json set_message(const std::string& name, const Json& value) {
  return {{"op", "setParameters"}, {"id", "s"}, {"parameters", {{{"name", name}, {"value", value}}}}};
}
Json get_message(const std::string& name) {
  return {{"op", "getParameters"}, {"id", "g"}, {"parameterNames", {name}}};
}

TEST(ViewServer, ListsAllOptionsAndChangesNoneUnlessTunable) {
  const Served served;
  WebSocket socket = served.connect();
  socket.send({{"op", "getParameters"}, {"parameterNames", Json::array()}});
  const Json all = socket.read_op("parameterValues").at("parameters");
  EXPECT_EQ(all.size(), options(first_config()).size());
  socket.send(get_message("match.num_disparities"));
  EXPECT_EQ(socket.read_op("parameterValues").at("parameters").at(0).at("value"),
            first_config().segmentation.match.num_disparities);
  socket.send(set_message("objects.min_confidence", 0.9));
  EXPECT_TRUE(has(socket.read_op("status").at("message"), "--tunable"));
  EXPECT_NEAR(socket.read_op("parameterValues").at("parameters").at(0).at("value").get<double>(), 0.35, 1e-6);
  const Json page =
      Json::parse(ask(served.port, request("/options.json", served.host() + served.cookie())).body);
  ASSERT_EQ(page.size(), all.size());
  for (const char* key : {"name", "type", "value", "unit", "domain", "help", "needs", "active", "first"})
    EXPECT_TRUE(page.at(0).contains(key)) << key;
}

/// A source that delivers pairs when the test requests them.
class Fed : public input::Sequence {
 public:
  std::optional<input::SequenceFrame> next() override {
    while (!is_stopped_) {
      std::size_t left = allowed_;
      if (left > 0 && allowed_.compare_exchange_strong(left, left - 1)) return pair_at(index_++);
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return std::nullopt;
  }
  [[nodiscard]] std::optional<std::size_t> size() const override { return std::nullopt; }
  [[nodiscard]] std::string name() const override { return "fed"; }
  [[nodiscard]] Size image_size() const override { return sample().images.left.gray.size(); }
  [[nodiscard]] const std::optional<StereoRig>& rig() const override { return sample().calibration.rig; }
  [[nodiscard]] std::optional<int> disparities() const override { return std::nullopt; }
  [[nodiscard]] const KnownGround& ground() const override { return ground_; }
  [[nodiscard]] const io::Rectifier* rectifier() const override { return nullptr; }
  [[nodiscard]] std::string stamps_from() const override { return "a test"; }
  [[nodiscard]] const std::vector<input::SourceRemark>& remarks() const override { return remarks_; }
  [[nodiscard]] const std::string& ended_early() const override { return nothing_; }
  void stop() override { is_stopped_ = true; }
  [[nodiscard]] input::SourceStatus status() const override {
    input::SourceStatus status;
    status.is_live = true;  // without pacing
    return status;
  }
  void feed() { ++allowed_; }

 private:
  std::atomic<std::size_t> allowed_ = 0;
  std::atomic<bool> is_stopped_ = false;
  std::size_t index_ = 0;
  KnownGround ground_;
  std::vector<input::SourceRemark> remarks_;
  std::string nothing_;
};

/// A runner whose options can be changed through a view.
struct Tuned {
  Tuned() {
    LiveOptions how;
    how.tracks = false;
    runner.emplace(source, "fed", SensorFiles{}, first_config(), how, Exec{});
    ViewOptions options = options_of_test();
    options.tunable = true;
    ViewedRun run = run_of_test();
    run.config = [this] { return runner->config(); };
    run.set = [this](const auto& values) { runner->set(values); };
    run.pause = [this](bool on) { runner->pause(on); };
    run.is_paused = [this] { return runner->is_paused(); };
    run.step = [this] { ++steps; };
    served.emplace(options, run);
    runner->add(served->server);
    thread = std::thread([this] { runner->run(); });
  }
  ~Tuned() {
    runner->stop();
    source.stop();
    thread.join();
  }
  Tuned(const Tuned&) = delete;
  Tuned& operator=(const Tuned&) = delete;

  Fed source;
  std::optional<Runner> runner;
  std::optional<Served> served;
  std::atomic<int> steps = 0;
  std::thread thread;
};

TEST(ViewServer, AnOptionSetByAViewerAppliesFromTheNextFrame) {
  Tuned tuned;
  WebSocket socket = tuned.served->connect();
  socket.subscribe("/cairn/labels", 1);
  const auto shown = [&] {
    tuned.source.feed();
    const auto data = socket.read_data();
    EXPECT_TRUE(data);
    return data ? ros::decode<ros::Image>(data->payload).data : ros::Bytes{};
  };
  const auto expected = [](const std::string& option, const std::string& value) {
    Config config = first_config().segmentation;
    if (!option.empty()) set(config, option, value);
    const Frame frame = segment(sample().pair(), sample().calibration.rig, config, {});
    TrackedFrame step;
    step.frame.objects.labels = frame.objects.labels.clone();
    return ros::labels_of({}, step).data;
  };
  const ros::Bytes first = expected("", "");
  EXPECT_EQ(shown(), first);
  socket.send(set_message("objects.min_area", 5));
  EXPECT_EQ(socket.read_op("parameterValues").at("parameters").at(0).at("value"), 5);
  const ros::Bytes fewer = shown();
  EXPECT_EQ(fewer, expected("objects.min_area", "5"));
  EXPECT_NE(fewer, first);
  const Answer yaml =
      ask(tuned.served->port, request("/config.yaml", tuned.served->host() + tuned.served->cookie()));
  EXPECT_TRUE(has(yaml.body, "  min_area: 5")) << yaml.body;
  // Without a value, the initial one is restored.
  socket.send({{"op", "setParameters"}, {"parameters", {{{"name", "objects.min_area"}}}}});
  socket.read_op("parameterValues");
  EXPECT_EQ(shown(), first);
}

TEST(ViewServer, RefusesValuesAndNamesTheExpectation) {
  Tuned tuned;
  WebSocket socket = tuned.served->connect();
  const auto refusal = [&](const std::string& name, const Json& value) {
    socket.send(set_message(name, value));
    return socket.read_op("status").at("message").get<std::string>();
  };
  EXPECT_EQ(refusal("objects.min_confidence", 2), "option objects.min_confidence: found '2', expected 0 … 1");
  EXPECT_EQ(refusal("objects.min_confidence", "much"),
            "option objects.min_confidence: found \"much\", expected a number, 0 … 1");
  EXPECT_TRUE(has(refusal("match.num_disparities", 32.5), "found 32.5, expected a whole number"));
  EXPECT_TRUE(has(refusal("match.num_disparities", 1e300), "expected a whole number"));
  EXPECT_TRUE(has(refusal("match.method", "magic"), "found 'magic', expected one of window|semi_global"));
  EXPECT_TRUE(has(refusal("match.num_disparites", 32), "match.num_disparities"));  // the nearest
  EXPECT_TRUE(has(refusal("live.record", true), "not an option of this run"));
  EXPECT_TRUE(has(refusal("live.pause", 1), "found 1, expected true or false"));
  // Too large for images of this size.
  EXPECT_TRUE(has(refusal("match.min_disparity", 1000), "1000"));
  // All changes or none.
  socket.send({{"op", "setParameters"},
               {"parameters",
                {{{"name", "match.num_disparities"}, {"value", 16}},
                 {{"name", "objects.min_confidence"}, {"value", -7}}}}});
  socket.read_op("status");
  EXPECT_EQ(tuned.runner->config()->segmentation.match.num_disparities,
            first_config().segmentation.match.num_disparities);
}

TEST(ViewServer, NotifiesOthersOfChanges) {
  Tuned tuned;
  WebSocket a = tuned.served->connect();
  WebSocket watcher = tuned.served->connect();
  watcher.send(
      {{"op", "subscribeParameterUpdates"}, {"parameterNames", {"live.pause", "match.num_disparities"}}});
  watcher.send(get_message("live.pause"));
  EXPECT_EQ(watcher.read_op("parameterValues").at("parameters").at(0).at("value"), false);
  a.send(set_message("objects.min_confidence", 0.5));  // not subscribed
  a.send(set_message("match.num_disparities", 16.0));
  Json update = watcher.read_op("parameterValues").at("parameters");
  EXPECT_EQ(update, Json::parse(R"([{"name":"match.num_disparities","value":16}])"));
  a.send(set_message("live.pause", true));
  update = watcher.read_op("parameterValues").at("parameters");
  EXPECT_EQ(update, Json::parse(R"([{"name":"live.pause","value":true}])"));
  EXPECT_TRUE(tuned.runner->is_paused());
  a.send(set_message("live.step", true));
  a.send(set_message("live.pause", false));
  watcher.read_op("parameterValues");
  EXPECT_EQ(tuned.steps, 1);
}

TEST(ViewServer, RecordsIfPossible) {
  std::atomic<bool> is_recording = false;
  ViewOptions options = options_of_test();
  options.tunable = true;
  ViewedRun run = run_of_test();
  run.record = [&](bool on) {
    if (on && is_recording) throw Error("a.mcap: is being recorded to already");
    is_recording = on;
  };
  run.is_recording = [&] { return is_recording.load(); };
  Served served(options, run);
  WebSocket socket = served.connect();
  socket.send(set_message("live.record", true));
  EXPECT_EQ(socket.read_op("parameterValues").at("parameters").at(0).at("value"), true);
  EXPECT_TRUE(is_recording);
  socket.send(set_message("live.record", true));
  EXPECT_EQ(socket.read_op("status").at("message"), "a.mcap: is being recorded to already");
  served.server.offer(renumbered(0));
  socket.subscribe("/cairn/stats", 1);
  const auto data = socket.read_data();
  ASSERT_TRUE(data);
  const Json stats = Json::parse(std::string(data->payload.begin(), data->payload.end()));
  EXPECT_EQ(stats.at("can_record"), true);
  EXPECT_EQ(stats.at("recording"), true);
  EXPECT_EQ(stats.at("is_file"), false);
}

}  // namespace
}  // namespace cairn::live
