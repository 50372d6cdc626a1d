// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "command.hpp"

/// --view of cairn live and cairn follow: its output and refusals. (tests/unit/live/view_server_test.cpp tests the server.)
namespace cairn::command {
namespace {

class LiveView : public CommandTest {
 protected:
  const std::string source_ = CAIRN_SOURCE_DIR "/data/sequences/rolling_ball";
};

TEST_F(LiveView, PrintsItsAddress) {
  const Outcome outcome = run({"live", source_, "--frames", "1", "--view", "127.0.0.1:0"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_TRUE(outcome.err.starts_with("view: http://127.0.0.1:")) << outcome.err;
  EXPECT_NE(outcome.err.find("/?token="), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("view: 0 viewers at most, 0 messages encoded"), std::string::npos)
      << outcome.err;
}

TEST_F(LiveView, FollowHasItToo) {
  const Outcome outcome = run({"follow", source_, "--frames", "1", "--view", "127.0.0.1:0"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_TRUE(outcome.err.starts_with("view: http://127.0.0.1:")) << outcome.err;
  EXPECT_NE(outcome.err.find("view: 0 viewers at most"), std::string::npos) << outcome.err;
  refuses({"follow", source_, "--tunable"}, {"--tunable", "needs --view"});
}

TEST_F(LiveView, RefusesUnsafeOrInvalidOptions) {
  refuses({"live", source_, "--tunable"}, {"--tunable", "needs --view"});
  refuses({"live", source_, "--tls-key", "key.pem"}, {"--tls-key", "needs --view"});
  refuses({"live", source_, "--view", "0.0.0.0:0"}, {"0.0.0.0", "--tls-cert", "--insecure"});
  refuses({"live", source_, "--view", "robot:8765"}, {"'robot:8765'", "127.0.0.1:8765"});
  refuses({"live", source_, "--view", "127.0.0.1:0", "--view-token", "short"}, {"--view-token", "16 to 128"});
  refuses({"live", source_, "--view", "127.0.0.1:0", "--tls-cert", "none.pem"}, {"--tls-key"});
  refuses({"live", source_, "--view", "127.0.0.1:0", "--tls-cert", "none.pem", "--tls-key", "none.pem"},
          {"none.pem", "PEM"});
}

}  // namespace
}  // namespace cairn::command
