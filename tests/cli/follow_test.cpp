// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <signal.h>

#include <nlohmann/json.hpp>
#include <thread>

#include "command.hpp"

/// cairn follow: its output, refusals and exit.
namespace cairn::command {
namespace {

using Json = nlohmann::json;

class Follow : public CommandTest {
 protected:
  /// A static camera in front of a sample's objects.
  void standing(int frames, const std::string& folder = "in") const {
    for (int i = 0; i < frames; ++i) {
      const fs::path frame = at(folder + "/" + std::to_string(i));
      fs::create_directories(frame);
      for (const char* file : {"left.png", "right.png", "calib.txt"})
        fs::copy_file(fs::path(CAIRN_SOURCE_DIR) / "data/samples/four_in_a_row" / file, frame / file);
    }
  }
  static std::vector<Json> lines_of(const fs::path& path) {
    std::vector<Json> lines;
    std::ifstream file(path);
    for (std::string line; std::getline(file, line);) lines.push_back(Json::parse(line));
    return lines;
  }
};

TEST_F(Follow, KeepsTheIdsOfStaticObjects) {
  standing(4);
  write(at("in/stamps.txt"), "0\n0.1\n0.2\n0.35\n");
  const Outcome outcome = run({"follow", path("in"), "-o", path("out"), "--frames-out"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const std::vector<Json> lines = lines_of(at("out/tracks.jsonl"));
  ASSERT_EQ(lines.size(), 4U);
  EXPECT_EQ(lines[3]["stamp_ns"], 350'000'000);
  EXPECT_EQ(lines[3]["name"], "3");
  std::set<int> first;
  std::set<int> last;
  for (const Json& track : lines.front()["tracks"]) first.insert(track["id"].get<int>());
  for (const Json& track : lines.back()["tracks"]) {
    last.insert(track["id"].get<int>());
    EXPECT_EQ(track["state"], "confirmed");
    EXPECT_EQ(track["moving"], false);
    EXPECT_TRUE(track.contains("rle"));
  }
  EXPECT_GE(first.size(), 2U);
  EXPECT_EQ(first, last);
  EXPECT_NEAR(lines.back()["pose"]["position_m"][0].get<double>(), 0, 0.01);
  const Json summary = Json::parse(content(at("out/summary.json")));
  EXPECT_EQ(summary["frames"], 4);
  EXPECT_EQ(summary["state"], "done");
  EXPECT_EQ(summary["tracks"], first.size());
  const std::string poses = content(at("out/poses.tum"));
  EXPECT_EQ(std::count(poses.begin(), poses.end(), '\n'), 4);
  EXPECT_TRUE(poses.starts_with("0.000000000 "));
  std::ptrdiff_t confirmed = 0;
  for (const Json& line : lines) {
    for (const Json& track : line["tracks"]) confirmed += track["state"] == "confirmed" ? 1 : 0;
  }
  const std::string masks = content(at("out/tracks.mots.txt"));
  EXPECT_GT(confirmed, 4);
  EXPECT_EQ(std::count(masks.begin(), masks.end(), '\n'), confirmed) << "tentative tracks have no mask there";
  EXPECT_TRUE(fs::exists(at("out/3/tracks.png")));
}

TEST_F(Follow, PrintsTheLinesThatItWrites) {
  standing(2);
  const Outcome outcome = run({"follow", path("in"), "-o", path("out"), "--json-lines"});
  EXPECT_EQ(outcome.out, content(at("out/tracks.jsonl")));
}

TEST_F(Follow, LiveWritesTheSameFiles) {
  standing(4);
  write(at("wheels.csv"), "frame,t_s,v_m_per_s,omega_rad_per_s\n0,0,0,0\n1,0.1,0,0\n2,0.2,0,0\n3,0.3,0,0\n");
  const std::vector<std::string> same{path("in"), "--odometry", path("wheels.csv"), "--html", "-o"};
  const auto command = [&](std::vector<std::string> words, const std::string& out,
                           const std::vector<std::string>& more) {
    words.insert(words.end(), same.begin(), same.end());
    words.push_back(out);
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = run(words);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
  };
  command({"follow"}, path("a"), {});
  command({"live"}, path("b"), {"--every-frame", "--pace", "0"});
  command({"live"}, path("c"), {"--pace", "0.3"});  // slowly enough that no pair is replaced
  for (const std::string folder : {"b", "c"}) {
    for (const char* file : {"tracks.jsonl", "poses.tum", "tracks.mots.txt", "events.jsonl"})
      EXPECT_EQ(content(at(folder + "/" + file)), content(at(std::string("a/") + file))) << folder << file;
    const Json summary = Json::parse(content(at(folder + "/summary.json")));
    EXPECT_EQ(summary["state"], "done");
    EXPECT_EQ(summary["frames"], 4);
    EXPECT_TRUE(fs::exists(at(folder + "/follow.html")));
  }
  for (const auto& [option, file] : {std::pair{"--map", "room.db"}, {"--poses", "p.tum"}, {"-o", "d"}})
    refuses({"live", path("in"), "--no-tracks", option, path(file)}, {option, "--no-tracks"});
  refuses({"live", path("in"), "-o", path("in/results")}, {"-o", "inside the source"});
}

TEST_F(Follow, GivesTheSameForAnyNumberOfThreadsAndInstructionSet) {
  standing(3);
  const std::string one = run({"follow", path("in"), "--json-lines", "--threads", "1"}).out;
  EXPECT_FALSE(one.empty());
  EXPECT_EQ(run({"follow", path("in"), "--json-lines", "--threads", "3"}).out, one);
  EXPECT_EQ(run({"follow", path("in"), "--json-lines", "--target", "scalar"}).out, one);
}

TEST_F(Follow, EveryCommandOnASequenceReportsSwappedCamerasOnce) {
  const fs::path sample = fs::path(CAIRN_SOURCE_DIR) / "data/samples/overlap";
  for (const char* name : {"0", "1", "2"}) {
    fs::create_directories(at("in") / name);
    fs::copy_file(sample / "left.png", at("in") / name / "right.png");
    fs::copy_file(sample / "right.png", at("in") / name / "left.png");
    fs::copy_file(sample / "calib.txt", at("in") / name / "calib.txt");
  }
  const auto reports = [](const Outcome& outcome) {
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    const std::size_t found = outcome.err.find("cairn: broken: cameras swapped: ");
    ASSERT_NE(found, std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err.find(" (frame 0). Exchange the two images"), std::string::npos) << outcome.err;
    EXPECT_EQ(outcome.err.find("cameras swapped", found + 30), std::string::npos) << outcome.err;
  };
  reports(run({"follow", path("in"), "-o", path("out")}));
  reports(run({"live", path("in"), "--every-frame", "--pace", "0"}));
  reports(run({"live", path("in"), "--every-frame", "--pace", "0", "--no-tracks"}));
  reports(run({"odometry", path("in")}));
  reports(run({"record", path("in"), "-o", path("recorded")}));
  for (const bool tracks : {false, true}) {
    const std::string folder = path(tracks ? "tracked" : "batch");
    std::vector<std::string> plan{"batch", "plan", path("in"), "-o", folder};
    if (tracks) plan.emplace_back("--tracks");
    ASSERT_EQ(run(plan).code, 0);
    const Outcome worked = run({"batch", "work", folder});
    EXPECT_NE(worked.err.find("cairn: broken: cameras swapped: "), std::string::npos) << worked.err;
  }
  const std::vector<Json> events = lines_of(at("out/events.jsonl"));
  ASSERT_FALSE(events.empty());
  EXPECT_EQ(events[0]["kind"], "finding");
  EXPECT_EQ(events[0]["finding"], "cameras swapped");
  EXPECT_EQ(events[0]["severity"], "broken");
  EXPECT_EQ(events[0]["frame"], 0);
}

TEST_F(Follow, WithoutACalibrationThereAreIdsAndNoMetres) {
  standing(3);
  for (int i = 0; i < 3; ++i) fs::remove(at("in/" + std::to_string(i) + "/calib.txt"));
  const Outcome outcome = run({"follow", path("in"), "-o", path("out")});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.err.find("cairn: note: no metres: the source has no calibration with a baseline"), 0U)
      << outcome.err;
  const std::vector<Json> lines = lines_of(at("out/tracks.jsonl"));
  ASSERT_EQ(lines.size(), 3U);
  EXPECT_EQ(lines[2]["motion"]["refusal"], "no_rig");
  EXPECT_FALSE(lines[2]["tracks"].empty());
  EXPECT_TRUE(lines[2]["pose"].is_null());
  EXPECT_TRUE(lines[2]["tracks"][0]["position_m"].is_null());
  EXPECT_EQ(content(at("out/poses.tum")), "");
}

TEST_F(Follow, BlackFramesRefuseTheMotionWithoutEndingTheRun) {
  standing(5);
  const Image<Gray> black({320, 240}, Gray{0}, {});
  for (const char* file : {"in/2/left.png", "in/2/right.png"}) io::save_png(at(file), black.view());
  const Outcome outcome = run({"follow", path("in"), "-o", path("out")});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const std::vector<Json> lines = lines_of(at("out/tracks.jsonl"));
  ASSERT_EQ(lines.size(), 5U);
  EXPECT_NE(lines[2]["motion"]["refusal"], "none");
  EXPECT_EQ(lines[3]["motion"]["refusal"], "none");
  std::set<int> before;
  std::set<int> after;
  for (const Json& track : lines[1]["tracks"]) before.insert(track["id"].get<int>());
  for (const Json& track : lines[4]["tracks"]) after.insert(track["id"].get<int>());
  EXPECT_EQ(before, after);
}

TEST_F(Follow, OneFrameIsASequence) {
  standing(1);
  EXPECT_EQ(run({"follow", path("in"), "-o", path("out")}).code, 0);
  EXPECT_EQ(lines_of(at("out/tracks.jsonl")).size(), 1U);
}

TEST_F(Follow, ReadsOptionsOfFrameAndSequenceFromOneFile) {
  standing(2);
  write(at("mine.yaml"), "preset: default\nobjects:\n  min_confidence: 0.9\ntracking.min_hits: 2\n");
  const Outcome outcome = run({"follow", path("in"), "--config", path("mine.yaml"), "-o", path("out")});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Json options = Json::parse(content(at("out/summary.json")))["options"];
  EXPECT_EQ(options["tracking.min_hits"], "2");
  EXPECT_EQ(options["objects.min_confidence"], "0.9");
}

TEST_F(Follow, FollowsWithThePresetPaperToo) {
  standing(3);
  const Outcome outcome = run({"follow", path("in"), "--preset", "paper", "-o", path("out")});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(lines_of(at("out/tracks.jsonl")).size(), 3U);
}

TEST_F(Follow, RefusesInvalidSequences) {
  standing(3);
  refuses({"follow", path("nothing")}, {"nothing"});
  refuses({"follow", path("in"), "--set", "tracking.min_hit=2"}, {"did you mean 'tracking.min_hits'?"});
  refuses({"follow", path("in"), "--set", "tracking.min_speed=9"}, {"tracking.min_speed", "0 … 5"});
  refuses({"follow", path("in"), "--set", "tracking.low_confidence=0.8"},
          {"tracking.low_confidence", "0 … 0.4"});
  refuses({"follow", path("in"), "--set", "landmarks.min_frames=2"},
          {"landmarks.min_frames", "tracking.min_hits"});
  refuses({"follow", path("in"), "--set", "odometry.method=off", "--set", "odometry.min_inliers=20"},
          {"odometry.min_inliers has no effect"});
  refuses({"follow", path("in"), "--preset", "paper", "--set", "repair.method=off"},
          {"repair.method has no effect"});
  refuses({"follow", path("in"), "--frames-out"}, {"--frames-out", "-o DIR"});
  refuses({"follow", path("in"), "--read-only"}, {"--map"});
  refuses({"follow", path("in"), "--start", "0,0,0"}, {"--map"});
  refuses({"follow", path("in"), "--map", path("m.db"), "--start", "0,0"}, {"X,Y,DEGREES"});
  refuses({"follow", path("in"), "--odometry", path("none.csv")}, {"none.csv"});
  write(at("o.csv"), "frame,t_s,v_m_per_s,omega_rad_per_s\n0,0,0,0\n1,0.1,0,0\n");
  refuses({"follow", path("in"), "--odometry", path("o.csv"), "--poses", path("o.csv")}, {"--poses"});
  refuses({"follow", path("in"), "--map", path("in/0/left.png")}, {"left.png"});
  fs::remove(at("in/0/calib.txt"));
  refuses({"follow", path("in"), "--map", path("room.db")}, {"in"});
}

TEST_F(Follow, AFrameWithAnEarlierStampIsLeftOutWithOneLine) {
  standing(3);
  write(at("in/stamps.txt"), "0\n0.2\n0.1\n");
  const Outcome outcome = run({"follow", path("in"), "-o", path("out")});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_NE(outcome.err.find("frame with a stamp that is not later than the one before: 1 frame"),
            std::string::npos)
      << outcome.err;
  EXPECT_EQ(lines_of(at("out/tracks.jsonl")).size(), 2U);
}

TEST_F(Follow, KnownPosesAreUsedUnchanged) {
  standing(2);
  write(at("p.tum"), "0.0 1 2 3 0 0 0 1\n0.1 1.5 2 3 0 0 0 1\n");
  const Outcome outcome =
      run({"follow", path("in"), "--poses", path("p.tum"), "--rate", "10", "--json-lines"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const std::string second = outcome.out.substr(outcome.out.find('\n') + 1);
  EXPECT_EQ(Json::parse(second)["pose"]["position_m"], Json({1.5, 2.0, 3.0}));
  write(at("p.tum"), "0 1 0 0 0 0 0 1\n0.096 2 0 0 0 0 0 1\n0.101 3 0 0 0 0 0 1\n");  // the nearest counts
  const std::string near =
      run({"follow", path("in"), "--poses", path("p.tum"), "--rate", "10", "--json-lines"}).out;
  EXPECT_EQ(Json::parse(near.substr(near.find('\n') + 1))["pose"]["position_m"], Json({3.0, 0.0, 0.0}));
  write(at("p.tum"), "7 1 2 3 0 0 0 1\n8 1.5 2 3 0 0 0 1\n");
  refuses({"follow", path("in"), "--poses", path("p.tum")}, {"p.tum", "stamp"});
}

TEST_F(Follow, AScanJudgesTheDisparities) {
  standing(3);
  write(at("in/stamps.txt"), "0\n0.1\n0.2\n");
  // 41 beams from 0.4 rad to the right on, to a wall at 0.3 m that contradicts the disparities; none at 0.2
  // s.
  std::string scan = "t_s,angle_min,angle_increment";
  for (int i = 0; i < 41; ++i) scan += ",r" + std::to_string(i);
  for (const char* stamp : {"0", "0.1"}) {
    scan += std::string("\n") + stamp + ",-0.4,0.02";
    for (int i = 0; i < 41; ++i) scan += ",0.3";
  }
  write(at("scan.csv"), scan + "\n");
  const Outcome outcome = run({"follow", path("in"), "--scan", path("scan.csv"), "-o", path("out")});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const std::vector<Json> lines = lines_of(at("out/tracks.jsonl"));
  ASSERT_EQ(lines.size(), 3U);
  EXPECT_LT(lines[0]["reliability"]["scan"].get<double>(), 0.1);
  EXPECT_EQ(lines[0]["reliability"]["weakest"], "scan");
  EXPECT_LT(lines[1]["reliability"]["scan"].get<double>(), 0.1);
  EXPECT_TRUE(lines[2]["reliability"]["scan"].is_null()) << "none within 50 ms";
  EXPECT_LT(lines[1]["reliability"]["value"], lines[2]["reliability"]["value"]);

  refuses({"follow", path("in"), "--scan", path("none.csv")}, {"none.csv"});
  write(at("scan.csv"), "t_s,angle_min,angle_increment,r0\n0,-0.4,zero,1\n");
  refuses({"follow", path("in"), "--scan", path("scan.csv")}, {"scan.csv:2", "'zero'"});
  for (int i = 0; i < 3; ++i) fs::remove(at("in/" + std::to_string(i) + "/calib.txt"));
  refuses({"follow", path("in"), "--scan", path("scan.csv")}, {"--scan", "calibration"});
}

TEST_F(Follow, WatchingReportsABetterOptionAndChangesNothing) {
  standing(90);
  // As in tests/unit/sequence/control_test.cpp: one object of the scene is found only if the minimum area is halved.
  const std::vector<std::string> off{"follow", path("in"), "--set", "objects.min_area=4"};
  std::vector<std::string> usual = off;
  usual.insert(usual.end(), {"-o", path("off")});
  ASSERT_EQ(run(usual).code, 0);
  std::vector<std::string> watch = off;
  for (const char* setting : {"control.method=watch", "control.budget=1"})
    watch.insert(watch.end(), {"--set", setting});
  watch.insert(watch.end(), {"-o", path("watch")});
  const Outcome outcome = run(watch);
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  std::vector<Json> watched = lines_of(at("watch/tracks.jsonl"));
  std::size_t reports = 0;
  for (Json& line : watched) reports += line.erase("control");
  EXPECT_GE(reports, 1U);
  EXPECT_EQ(watched, lines_of(at("off/tracks.jsonl")));
  const std::vector<Json> events = lines_of(at("watch/events.jsonl"));
  const auto found = std::find_if(events.begin(), events.end(),
                                  [](const Json& event) { return event["kind"] == "option_better"; });
  ASSERT_NE(found, events.end()) << outcome.err;
  EXPECT_NE((*found)["from"], (*found)["to"]);
  EXPECT_GT((*found)["lead"].get<double>(), 0.1);
  EXPECT_NE(outcome.err.find("steadier setting: " + (*found)["option"].get<std::string>() + "="),
            std::string::npos)
      << outcome.err;
  EXPECT_EQ(content(at("off/events.jsonl")).find("option_better"), std::string::npos);
}

TEST_F(Follow, TuningSetsABetterOption) {
  standing(40);
  const Outcome outcome = run({"follow", path("in"), "--set", "objects.min_area=60", "--set",
                               "control.method=tune", "--set", "control.budget=1", "-o", path("tuned")});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const std::vector<Json> events = lines_of(at("tuned/events.jsonl"));
  ASSERT_FALSE(events.empty());
  EXPECT_EQ(events[0]["kind"], "option_set");
  EXPECT_EQ(events[0]["option"], "objects.min_area");
  EXPECT_EQ(events[0]["from"], "60");
  EXPECT_NE(outcome.err.find("objects.min_area=0.1, set (was 60)"), std::string::npos) << outcome.err;
  const std::vector<Json> lines = lines_of(at("tuned/tracks.jsonl"));
  EXPECT_EQ(lines.front()["objects"], 0);
  EXPECT_GT(lines.back()["objects"], 0);
}

TEST_F(Follow, AMapStoresLandmarks) {
  standing(10);
  write(at("in/stamps.txt"), "5\n5.1\n5.2\n5.3\n5.4\n5.5\n5.6\n5.7\n5.8\n5.9\n");
  const std::vector<std::string> arguments{"follow",        path("in"), "--map",
                                           path("room.db"), "--set",    "landmarks.min_baseline=0"};
  ASSERT_EQ(run(arguments).code, 0);
  const std::string first = run({"map", "show", path("room.db")}).out;
  EXPECT_EQ(first.find(": 0 landmarks"), std::string::npos) << first;
  EXPECT_NE(first.find("done      10     5.00   5.90"), std::string::npos) << first;
  // The second run localises itself and finds no changes.
  std::vector<std::string> again = arguments;
  again.insert(again.end(), {"--start", "0,0,0", "-o", path("out")});
  ASSERT_EQ(run(again).code, 0);
  const std::string second = run({"map", "show", path("room.db")}).out;
  EXPECT_EQ(second.substr(0, second.find('\n')), first.substr(0, first.find('\n')));
  const Json last = lines_of(at("out/tracks.jsonl")).back();
  EXPECT_FALSE(last["tracks"].empty());
  for (const Json& track : last["tracks"]) EXPECT_TRUE(track.contains("landmark")) << track;
}

TEST_F(Follow, ANewRunBeginsWhereTheClockIsSetBack) {
  standing(12);
  // The same stamps again, as of a recording that is played twice.
  write(at("in/stamps.txt"), "5\n5.1\n5.2\n5.3\n5.4\n6.5\n5\n5.1\n5.2\n5.2\n5.3\n5.4\n");
  const Outcome outcome = run({"follow", path("in"), "--map", path("room.db"), "-o", path("out"), "--set",
                               "landmarks.min_baseline=0"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  for (const char* words :
       {"clock set back, a new run begins: 1 frame, the first is 6 (5 s after 6.5 s)",
        "not later than the one before: 1 frame skipped, the first is 9 (5.2 s after 5.2 s)"})
    EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
  const std::vector<Json> lines = lines_of(at("out/tracks.jsonl"));
  ASSERT_EQ(lines.size(), 11U);
  EXPECT_EQ(lines[6]["stamp_ns"], 5'000'000'000);
  const std::string runs = run({"map", "show", path("room.db")}).out;
  EXPECT_NE(runs.find("done       6     5.00   6.50"), std::string::npos) << runs;
  EXPECT_NE(runs.find("done       5     5.00   5.40"), std::string::npos) << runs;
  EXPECT_EQ(run({"map", "check", path("room.db")}).code, 0);
}

TEST_F(Follow, AnErrorDuringTheRunKeepsEarlierResults) {
  standing(5);
  const Image<Gray> small({160, 120}, Gray{9}, {});
  for (const char* file : {"in/3/left.png", "in/3/right.png"}) io::save_png(at(file), small.view());
  const Outcome outcome =
      run({"follow", path("in"), "-o", path("out"), "--html", "--map", path("room.db"), "--json-lines"});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_NE(outcome.err.find("160x120"), std::string::npos) << outcome.err;
  EXPECT_EQ(lines_of(at("out/tracks.jsonl")).size(), 3U);
  EXPECT_EQ(Json::parse(content(at("out/summary.json")))["state"], "failed");
  EXPECT_TRUE(fs::exists(at("out/follow.html")));
  EXPECT_NE(run({"map", "show", path("room.db")}).out.find("aborted"), std::string::npos);
}

TEST_F(Follow, RefusesToWriteResultsAmongTheFrames) {
  standing(2);
  refuses({"follow", path("in"), "-o", path("in")}, {"-o", "inside the source"});
  refuses({"follow", path("in"), "-o", path("in/results")}, {"-o", "inside the source"});
}

TEST_F(Follow, AClosedPipeEndsTheRun) {
  standing(30);
  const std::string line = std::string(CAIRN_COMMAND) + " follow " + path("in") + " --json-lines -o " +
                           path("out") + " 2>/dev/null | head -n 1 > /dev/null; exit ${PIPESTATUS[0]}";
  const int status = std::system(("bash -c '" + line + "'").c_str());
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 1);  // the pipe cannot be written to
  EXPECT_EQ(Json::parse(content(at("out/summary.json")))["state"], "interrupted");
}

TEST_F(Follow, AnInterruptEndsAfterACompleteLine) {
  standing(40);
  const std::string out = path("out");
  std::string source = path("in");
  const pid_t child = fork();
  if (child == 0) {
    const int null = open("/dev/null", O_WRONLY);
    dup2(null, STDOUT_FILENO);
    dup2(null, STDERR_FILENO);
    execl(CAIRN_COMMAND, CAIRN_COMMAND, "follow", source.c_str(), "-o", out.c_str(), nullptr);
    _exit(127);
  }
  const fs::path tracks = at("out/tracks.jsonl");
  for (int tries = 0; tries < 600 && (!fs::exists(tracks) || fs::file_size(tracks) == 0); ++tries)
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  kill(child, SIGINT);
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 130);
  const std::string text = content(tracks);
  EXPECT_TRUE(text.ends_with("\n"));
  const std::vector<Json> lines = lines_of(tracks);
  EXPECT_LT(lines.size(), 40U);
  EXPECT_EQ(Json::parse(content(at("out/summary.json")))["state"], "interrupted");
}

}  // namespace
}  // namespace cairn::command
