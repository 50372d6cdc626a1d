// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <sys/resource.h>

#include <nlohmann/json.hpp>
#include <sstream>
#include <support/recordings.hpp>
#include <support/samples.hpp>

#include "command.hpp"

/// --record of cairn live and cairn follow, and replaying such a recording.
namespace cairn::command {
namespace {

using Json = nlohmann::json;

class LiveRecord : public CommandTest {
 protected:
  [[nodiscard]] static std::string sequence() {
    return (fs::path(CAIRN_SOURCE_DIR) / "data" / "sequences" / "rolling_ball").string();
  }
  /// For every frame of the sequence, or of `source`.
  Outcome record(const std::vector<std::string>& more = {}, const std::string& source = sequence()) const {
    std::vector<std::string> words{"live", source,     "--every-frame", "--pace",
                                   "0",    "--record", path("run.mcap")};
    words.insert(words.end(), more.begin(), more.end());
    return run(words);
  }
  /// Without names and times, which may differ.
  static std::string plain(Json frame) {
    for (const char* key : {"name", "stamp_ns", "timings_ms", "timings"}) frame.erase(key);
    return frame.dump();
  }
  static std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> all;
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);) {
      Json frame = Json::parse(line);
      frame.erase("name");
      all.push_back(frame.dump());
    }
    return all;
  }
};

TEST_F(LiveRecord, ReplayGivesTheObjectsOfTheImages) {
  const Outcome recorded = record({"--no-tracks"});
  ASSERT_EQ(recorded.code, 0) << recorded.err;
  EXPECT_NE(recorded.err.find("recorded " + path("run.mcap") + ": 6 frames"), std::string::npos)
      << recorded.err;
  const Outcome again =
      run({"live", path("run.mcap"), "--every-frame", "--no-tracks", "--pace", "0", "--json-lines"});
  ASSERT_EQ(again.code, 0) << again.err;
  std::istringstream found(again.out);
  for (const char* name : {"000", "001", "002", "003", "004", "005"}) {
    const std::string folder = sequence() + "/" + name;
    std::string line;
    ASSERT_TRUE(std::getline(found, line)) << name;
    EXPECT_EQ(plain(Json::parse(line)), plain(Json::parse(run({"segment", folder, "--json"}).out))) << name;
  }
}

TEST_F(LiveRecord, ReplayGivesTheTracksOfTheOriginal) {
  const std::string original = run({"follow", sequence(), "--json-lines"}).out;
  ASSERT_EQ(record().code, 0);
  const Outcome followed = run({"follow", path("run.mcap"), "--json-lines"});
  EXPECT_EQ(followed.code, 0) << followed.err;
  EXPECT_EQ(lines_of(followed.out), lines_of(original));
  const Outcome live = run({"live", path("run.mcap"), "--every-frame", "--pace", "0", "--json-lines"});
  EXPECT_EQ(lines_of(live.out), lines_of(original));
  const Outcome folder = run({"record", path("run.mcap"), "-o", path("folder")});
  EXPECT_EQ(folder.code, 0) << folder.err;
  EXPECT_EQ(lines_of(run({"follow", path("folder"), "--json-lines"}).out), lines_of(original));
}

TEST_F(LiveRecord, FollowRecordsTheSame) {
  const Outcome followed = run({"follow", sequence(), "--record", path("run.mcap"), "-o", path("out")});
  ASSERT_EQ(followed.code, 0) << followed.err;
  EXPECT_NE(followed.err.find("recorded " + path("run.mcap") + ": 6 frames"), std::string::npos)
      << followed.err;
  const Outcome again = run({"follow", path("run.mcap"), "--json-lines"});
  EXPECT_EQ(lines_of(again.out), lines_of(content(at("out/tracks.jsonl"))));
}

TEST_F(LiveRecord, StoresItsOptions) {
  const std::vector<std::string> options{"--set", "superpixels.count=100", "--set", "tracking.min_hits=2"};
  ASSERT_EQ(record(options).code, 0);
  std::vector<std::string> follow{"follow", sequence(), "--json-lines"};
  follow.insert(follow.end(), options.begin(), options.end());
  const std::string original = run(follow).out;
  const std::vector<std::string> live{"live", path("run.mcap"), "--every-frame", "--pace",
                                      "0",    "--json-lines"};
  const Outcome again = run(live);
  EXPECT_EQ(lines_of(again.out), lines_of(original));
  EXPECT_TRUE(again.err.starts_with("cairn: " + path("run.mcap") + ": using the options of the recording"))
      << again.err;
  const Outcome others = run(with("live", {live.begin() + 1, live.end()}, {"--preset", "default"}));
  EXPECT_EQ(others.err.find("of the recording"), std::string::npos);
  EXPECT_NE(lines_of(others.out), lines_of(original));
}

TEST_F(LiveRecord, TheCamerasFrameOfARecordingIsInTheResults) {
  const samples::Sample sample = samples::load("four_in_a_row");
  const io::LoadedImage& left = sample.images.left;
  {
    recordings::CameraFile robot(at("robot.mcap"));
    const auto left_topic = robot.topic<ros::Image>("/front/left/image_rect");
    const auto right_topic = robot.topic<ros::Image>("/front/right/image_rect");
    for (const Stamp stamp : {Stamp{1'403'636'579'763'555'584}, Stamp{1'403'636'579'863'555'584}}) {
      const ros::Header header = ros::header_of(stamp, "front_left_optical");
      robot.add(left_topic, stamp,
                left.rgb.empty() ? ros::image_of(header, left.gray.view())
                                 : ros::image_of(header, left.rgb.view()));
      robot.add(right_topic, stamp, ros::image_of(header, sample.images.right.gray.view()));
    }
  }
  const auto says = [&](const std::vector<std::string>& words) {
    const Outcome outcome = run(words);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    const std::vector<std::string> lines = lines_of(outcome.out);
    ASSERT_EQ(lines.size(), 2U);
    const Json line = Json::parse(lines.back());
    EXPECT_EQ(line["frame_id"], "front_left_optical");
    EXPECT_EQ(line["stamp_ns"], 1'403'636'579'863'555'584);
  };
  const std::string options = "match.num_disparities=32";
  says({"follow", path("robot.mcap"), "--json-lines", "--set", options});
  ASSERT_EQ(record({"--no-tracks", "--set", options}, path("robot.mcap")).code, 0);
  for (const std::string& recording : {path("robot.mcap"), path("run.mcap")}) {
    says(
        {"live", recording, "--no-tracks", "--every-frame", "--pace", "0", "--json-lines", "--set", options});
  }
  const std::vector<std::string> unnamed = lines_of(run({"follow", sequence(), "--json-lines"}).out);
  EXPECT_FALSE(Json::parse(unnamed.at(0)).contains("frame_id"));
}

TEST_F(LiveRecord, AFullFileEndsTheRecordingButNotTheRun) {
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  rlimit small = before;
  small.rlim_cur = 500'000;
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  const Outcome outcome = record({"--json-lines", "--record-what", "all"});
  setrlimit(RLIMIT_FSIZE, &before);
  EXPECT_EQ(outcome.code, 3) << outcome.err;
  EXPECT_EQ(std::count(outcome.out.begin(), outcome.out.end(), '\n'), 6);
  EXPECT_NE(outcome.err.find("cairn: recording stopped: " + path("run.mcap") +
                             ": can no longer be written: File too large\n"),
            std::string::npos)
      << outcome.err;
  EXPECT_NE(outcome.err.find("; stopped: "), std::string::npos) << outcome.err;
}

TEST_F(LiveRecord, ATruncatedRecordingIsReadUpToItsLastChunk) {
  ASSERT_EQ(record({"--record-what", "all"}).code, 0);  // enough data for several chunks
  fs::resize_file(at("run.mcap"), fs::file_size(at("run.mcap")) * 3 / 4);
  const Outcome cut = run({"follow", path("run.mcap"), "--json-lines"});
  EXPECT_EQ(cut.code, 3) << cut.err;
  EXPECT_NE(cut.err.find("is truncated"), std::string::npos) << cut.err;
  const std::vector<std::string> found = lines_of(cut.out);
  const std::vector<std::string> original = lines_of(run({"follow", sequence(), "--json-lines"}).out);
  ASSERT_GE(found.size(), 1U);
  ASSERT_LT(found.size(), original.size());
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_EQ(found[i], original[i]);
}

TEST_F(LiveRecord, RefusesInOneLine) {
  write(at("there.mcap"), "something");
  write(at("text.mcap"), "\x89MCAP0\r\n");
  refuses({"live", sequence(), "--record", path("there.mcap")}, {"there.mcap", "already exists"});
  refuses({"live", sequence(), "--record", path("no/folder.mcap")}, {"no/folder.mcap", "cannot be written"});
  refuses({"live", sequence(), "--record-what", "pictures"},
          {"--record-what", "\"pictures\"", "input, objects"});
  refuses({"follow", path("text.mcap")}, {"text.mcap", "is truncated", "nothing can be read"});
  refuses({"segment", path("text.mcap")}, {"text.mcap", "is a recording", "cairn record"});
}

}  // namespace
}  // namespace cairn::command
