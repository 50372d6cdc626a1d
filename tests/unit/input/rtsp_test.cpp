// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cairn/core/image.hpp>
#include <cairn/input/sequence.hpp>
#include <cstdio>
#include <string>
#include <support/gst_pipelines.hpp>
#include <support/temporary_folder.hpp>
#include <thread>

/// A network camera: an RTSP server on this computer, in a process of its own that is killed and restarted.
namespace cairn::input {
namespace {

using namespace std::chrono_literals;
using support::has;
using support::refusal;
using Clock = std::chrono::steady_clock;

class Server {
 public:
  /// Port 0: any free one.
  explicit Server(int port) {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) return;
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_adddup2(&files, ends[1], STDOUT_FILENO);
    std::string program = CAIRN_RTSP_SERVER;
    std::string port_text = std::to_string(port);
    char* arguments[] = {program.data(), port_text.data(), nullptr};
    ::posix_spawn(&process_, program.c_str(), &files, nullptr, arguments, environ);
    posix_spawn_file_actions_destroy(&files);
    ::close(ends[1]);
    FILE* output = ::fdopen(ends[0], "r");
    if (std::fscanf(output, "%d", &port_) != 1) port_ = 0;
    std::fclose(output);
  }
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;
  ~Server() { kill(); }
  void kill() {
    if (process_ <= 0) return;
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
    process_ = 0;
  }
  [[nodiscard]] int port() const { return port_; }

 private:
  pid_t process_ = 0;
  int port_ = 0;
};

TEST(Rtsp, ReconnectsAfterTheServerWasKilled) {
  if (!support::has_elements({"rtspsrc", "rtph264depay", "avdec_h264", "x264enc", "decodebin"})) {
    GTEST_SKIP() << "install gstreamer1.0-plugins-good gstreamer1.0-plugins-ugly gstreamer1.0-libav";
  }
  auto server = std::make_unique<Server>(0);
  const int port = server->port();
  ASSERT_GT(port, 0) << "the server did not begin";
  const std::string url = "rtsp://127.0.0.1:" + std::to_string(port) + "/pair";
  SourceOptions options;
  options.open_timeout_s = 30;
  const auto source = open_sequence(url, options);
  EXPECT_EQ(source->name(), "rtsp");
  EXPECT_EQ(source->image_size(), (Size{320, 240}));
  Stamp before;
  for (int i = 0; i < 30; ++i) {
    const auto pair = source->next();
    ASSERT_TRUE(pair);
    EXPECT_GT(pair->stamp, before);
    before = pair->stamp;
  }
  server.reset();
  for (int i = 0; i < 400 && source->status().trouble.empty(); ++i) std::this_thread::sleep_for(50ms);
  EXPECT_FALSE(source->status().is_connected);
  EXPECT_NE(source->status().trouble, "");
  std::printf("while the server is away: %s\n", source->status().trouble.c_str());
  server = std::make_unique<Server>(port);
  ASSERT_EQ(server->port(), port);
  const auto again = Clock::now();
  bool is_after_gap = false;
  for (int i = 0; i < 300 && !is_after_gap; ++i) {
    const auto pair = source->next();
    ASSERT_TRUE(pair);
    is_after_gap = pair->after_gap;
  }
  EXPECT_TRUE(is_after_gap);
  EXPECT_LT(Clock::now() - again, 20s);
  EXPECT_EQ(source->status().reconnects, 1U);
  const auto stopped = Clock::now();
  source->stop();
  EXPECT_FALSE(source->next());
  EXPECT_LT(Clock::now() - stopped, 200ms);
}

TEST(Rtsp, RefusesAMissingServerWithoutPrintingThePassword) {
  if (!support::has_elements({"rtspsrc", "decodebin"})) GTEST_SKIP() << "install gstreamer1.0-plugins-good";
  const std::string words = refusal([] { (void)open_sequence("rtsp://me:secret@127.0.0.1:1/pair", {}); });
  EXPECT_TRUE(has(words, {"rtsp://***@127.0.0.1:1/pair", "pipeline fails"}));
  EXPECT_EQ(words.find("secret"), std::string::npos);
}

}  // namespace
}  // namespace cairn::input
