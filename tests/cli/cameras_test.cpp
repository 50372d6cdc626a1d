// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cctype>

#include "command.hpp"

/// Cameras on the command line: live and record, and their messages.
namespace cairn::command {
namespace {

class Cameras : public CommandTest {
 protected:
  static constexpr const char* kPipeline =
      "gst:videotestsrc is-live=true pattern=snow ! "
      "video/x-raw,format=YUY2,width=320,height=120,framerate=30/1";
  void SetUp() override {
    const Outcome outcome = run({"record", "gst:videotestsrc num-buffers=1", "-o", path("probe")});
    if (outcome.code != 0) GTEST_SKIP() << "install gstreamer1.0-plugins-base: " << outcome.err;
  }
};

TEST_F(Cameras, LiveFollowsAPipelineAndEndsInTime) {
  const Outcome outcome = run({"live", kPipeline, "--duration", "1.5", "--json-lines", "--no-tracks",
                               "--max-age", "0", "--set", "match.num_disparities=16"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_GT(std::count(outcome.out.begin(), outcome.out.end(), '\n'), 2);
  EXPECT_NE(outcome.out.find("\"stamp_ns\":"), std::string::npos);
  EXPECT_NE(outcome.err.find(" frames in "), std::string::npos);
  EXPECT_NE(outcome.err.find("from image to objects"), std::string::npos);
}

TEST_F(Cameras, RecordTakesTheFirstFramesOfAPipeline) {
  const Outcome outcome = run({"record", kPipeline, "--frames", "4", "-o", path("out")});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("recorded 4 frames"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("stamps from the pipeline"), std::string::npos) << outcome.out;
  EXPECT_TRUE(fs::exists(at("out/000003/right.png")));
  // The result is readable as a sequence with the same stamps.
  EXPECT_EQ(run({"record", path("out"), "-o", path("again")}).code, 0);
  EXPECT_EQ(content(at("out/stamps.txt")), content(at("again/stamps.txt")));
}

TEST_F(Cameras, RefusesMissingCameras) {
  refuses({"live", "v4l2:/dev/video98"}, {"v4l2:/dev/video98", "no such device"});
  refuses({"live", "gst:no_such_element_at_all"}, {"no_such_element_at_all"});
  refuses({"follow", "gst:videotestsrc", "--open-timeout", "0"}, {"--open-timeout", "found 0"});
}

}  // namespace
}  // namespace cairn::command
