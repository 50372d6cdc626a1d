// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cairn/io/sha256.hpp>
#include <chrono>
#include <csignal>
#include <nlohmann/json.hpp>
#include <thread>

#include "command.hpp"

/// cairn batch: whatever the shards, and whatever happens to their workers, the rows are the same.
namespace cairn::command {
namespace {

using Json = nlohmann::json;

class Batch : public CommandTest {
 protected:
  /// A folder `in` with small frames.
  void frames(int count) const {
    for (int i = 0; i < count; ++i) {
      const std::string name = "in/" + std::string(i < 10 ? "0" : "") + std::to_string(i);
      pair_in(name, {48 + 2 * i, 36});
      write(at(name + "/calib.txt"), "fx=60\nfy=60\ncx=24\ncy=18\nbaseline=0.1\nndisp=16\n");
    }
  }
  void plan(const std::string& run_name = "run") const {
    const Outcome outcome = run({"batch", "plan", path("in"), "-o", path(run_name)});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
  }
  void work(const std::string& shard, const std::string& run_name = "run") const {
    const Outcome outcome = run({"batch", "work", path(run_name), "--shard", shard, "--threads", "1"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
  }
  [[nodiscard]] std::string merged(const std::string& run_name = "run") const {
    const Outcome outcome = run({"batch", "merge", path(run_name), "-o", path("rows.jsonl")});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    std::string rows = content(at("rows.jsonl"));
    EXPECT_EQ(outcome.out, io::sha256(rows) + "  " + path("rows.jsonl") + "\n");
    return rows;
  }
  [[nodiscard]] static std::vector<Json> parsed(const std::string& rows) {
    std::vector<Json> all;
    for (const std::string& row : rows_of(rows)) all.push_back(Json::parse(row));
    return all;
  }
  [[nodiscard]] static std::vector<std::string> rows_of(const std::string& rows) {
    std::vector<std::string> all;
    std::istringstream in(rows);
    for (std::string line; std::getline(in, line);) all.push_back(line);
    return all;
  }
  /// The digest before each row in work/.
  [[nodiscard]] std::string digest_of(const std::string& run_name, const std::string& row) const {
    const Json json = Json::parse(content(at(run_name + "/run.json")));
    return io::sha256(json["run"].get<std::string>() + row).substr(0, 16);
  }
  /// The result of an undisturbed worker on all frames.
  [[nodiscard]] std::string undisturbed() const {
    plan("alone");
    work("1/1", "alone");
    return merged("alone");
  }
  /// A worker that runs concurrently with the test.
  [[nodiscard]] pid_t begin(const std::string& shard, rlim_t most_bytes = RLIM_INFINITY) const {
    const std::string folder = path("run");
    const std::string err = path("err");
    const pid_t child = ::fork();
    if (child != 0) return child;
    const int nothing = ::open("/dev/null", O_RDWR);
    ::dup2(nothing, STDOUT_FILENO);
    ::dup2(::open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644), STDERR_FILENO);
    if (most_bytes != RLIM_INFINITY) {
      std::signal(SIGXFSZ, SIG_IGN);  // so that writing fails as on a full disk
      const rlimit limit{most_bytes, most_bytes};
      ::setrlimit(RLIMIT_FSIZE, &limit);
    }
    ::execl(CAIRN_COMMAND, CAIRN_COMMAND, "batch", "work", folder.c_str(), "--shard", shard.c_str(),
            "--threads", "1", nullptr);
    ::_exit(127);
  }
  static int ended(pid_t child) {
    int status = 0;
    ::waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }
};

TEST_F(Batch, ScalesACalibrationWhenAsked) {
  pair_in("in/00", {48, 36});
  write(at("in/00/calib.txt"), "fx=120\nfy=120\ncx=48\ncy=36\nbaseline=0.1\nndisp=32\nwidth=96\nheight=72\n");
  EXPECT_NE(parsed(undisturbed()).at(0)["error"].get<std::string>().find("--scale-calibration"),
            std::string::npos);
  const Outcome planned = run({"batch", "plan", path("in"), "-o", path("scaled"), "--scale-calibration"});
  ASSERT_EQ(planned.code, 0) << planned.err;
  work("1/1", "scaled");
  EXPECT_EQ(parsed(merged("scaled")).at(0)["rig"]["focal_px"], 60);
}

TEST_F(Batch, BinsImagesWhenAsked) {
  pair_in("in/00", {96, 72});
  write(at("in/00/calib.txt"), "fx=120\nfy=120\ncx=48\ncy=36\nbaseline=0.1\nndisp=32\nwidth=96\nheight=72\n");
  for (const char* factor : {"0", "9", "-1"}) {
    const Outcome refused = run({"batch", "plan", path("in"), "-o", path("none"), "--binning", factor});
    EXPECT_EQ(refused.code, 2);
    EXPECT_NE(refused.err.find(std::string("--binning: found ") + factor), std::string::npos) << refused.err;
  }
  EXPECT_FALSE(fs::exists(at("none")));
  fs::create_directories(at("l"));
  fs::create_directories(at("r"));
  fs::copy(at("in/00/left.png"), at("l/0.png"));
  fs::copy(at("in/00/right.png"), at("r/0.png"));
  const std::string calib = path("in/00/calib.txt");
  for (const std::string& input :
       {path("in"), path("l") + "," + path("r")}) {  // a frame's files, and a sequence
    const std::string folder = "run" + std::to_string(input.size());
    const Outcome planned =
        run({"batch", "plan", input, "-o", path(folder), "--calib", calib, "--binning", "2"});
    ASSERT_EQ(planned.code, 0) << planned.err;
    work("1/1", folder);
    const Json row = parsed(merged(folder)).at(0);
    ASSERT_TRUE(row.contains("rig")) << row;
    EXPECT_EQ(row["rig"]["focal_px"], 60);
    EXPECT_EQ(row["image"]["width"], 48);
  }
}

TEST_F(Batch, HasOneRowPerFrameInOrder) {
  frames(3);
  const std::vector<Json> rows = parsed(undisturbed());
  ASSERT_EQ(rows.size(), 3U);
  for (int i = 0; i < 3; ++i) {
    const Json& row = rows[static_cast<std::size_t>(i)];
    EXPECT_EQ(row["frame"], "0" + std::to_string(i));
    EXPECT_EQ(row["image"]["width"], 48 + 2 * i);
    EXPECT_TRUE(row.contains("objects"));
    EXPECT_FALSE(row.contains("timings_ms"));
    // The same as from cairn segment.
    const Outcome single = run({"segment", path("in/0" + std::to_string(i)), "--json"});
    const Json document = Json::parse(single.out);
    for (const char* key : {"image", "rig", "epipolar", "ground", "floor_frame", "objects", "left_out"})
      EXPECT_EQ(row[key], document[key]) << key;
  }
}

TEST_F(Batch, IsTheSameForAnyNumberOfShardsAndThreads) {
  frames(5);
  const std::string expected = undisturbed();
  for (const int shards : {2, 5, 7}) {
    const std::string name = "run" + std::to_string(shards);
    plan(name);
    for (int k = shards; k >= 1; --k) work(std::to_string(k) + "/" + std::to_string(shards), name);
    EXPECT_EQ(merged(name), expected) << shards << " shards";
  }
  plan("run");
  ASSERT_EQ(run({"batch", "work", path("run"), "--threads", "3", "--target", "scalar"}).code, 0);
  EXPECT_EQ(merged(), expected);
}

TEST_F(Batch, MergesPartsOfDifferentNumbersOfShards) {
  frames(5);
  const std::string expected = undisturbed();
  plan();
  work("1/2");
  work("2/3");
  work("5/5");
  EXPECT_EQ(merged(), expected);
}

TEST_F(Batch, NamesMissingFrames) {
  frames(5);
  plan();
  work("2/3");  // 02, 03
  Outcome outcome = run({"batch", "merge", path("run"), "-o", path("rows.jsonl")});
  EXPECT_EQ(outcome.code, 3);
  EXPECT_EQ(outcome.out, "");
  EXPECT_EQ(outcome.err,
            "cairn: missing: 00 … 01 (2 frames)\ncairn: missing: 04 (1 frame)\n"
            "cairn: 3 of 5 frames are missing, nothing is written (--partial writes the others)\n");
  EXPECT_FALSE(fs::exists(at("rows.jsonl")));
  outcome = run({"batch", "merge", path("run"), "-o", path("rows.jsonl"), "--partial"});
  EXPECT_EQ(outcome.code, 3);
  EXPECT_EQ(parsed(content(at("rows.jsonl"))).size(), 2U);
}

TEST_F(Batch, GivesABadFrameARowWithTheReason) {
  frames(4);
  write(at("in/01/left.png"), "no image");
  fs::remove(at("in/02/right.png"));
  pair_in("in/03", {20, 20});
  write(at("in/03/calib.txt"), "fx=60\nfy=60\ncx=24\ncy=18\nbaseline=0.1\nwidth=48\nheight=36\n");
  plan();
  const Outcome outcome = run({"batch", "work", path("run")});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("3 with an error"), std::string::npos) << outcome.out;
  const std::vector<Json> rows = parsed(merged());
  ASSERT_EQ(rows.size(), 4U);
  EXPECT_TRUE(rows[0].contains("objects"));
  for (const std::size_t bad : {1U, 2U, 3U}) {
    EXPECT_TRUE(rows[bad].contains("error"));
    EXPECT_EQ(rows[bad].size(), 2U);
  }
  EXPECT_NE(rows[1]["error"].get<std::string>().find("left.png"), std::string::npos);
  EXPECT_NE(rows[2]["error"].get<std::string>().find("right.png"), std::string::npos);
  EXPECT_NE(run({"batch", "status", path("run")}).out.find("3 errors"), std::string::npos);
}

TEST_F(Batch, AcceptsTheSamePlanAgainAndNoOther) {
  frames(2);
  plan();
  const auto before = everything();
  const Outcome again = run({"batch", "plan", path("in") + "/", "-o", path("run")});
  EXPECT_EQ(again.code, 0);
  EXPECT_TRUE(again.out.starts_with("already planned: 2 frames")) << again.out;
  EXPECT_EQ(everything(), before);
  refuses({"batch", "plan", path("in"), "-o", path("run"), "--preset", "paper"},
          {path("run"), "another run"});
  fs::create_directories(at("full"));
  write(at("full/mine.txt"), "mine");
  refuses({"batch", "plan", path("in"), "-o", path("full")}, {path("full"), "mine.txt"});
}

TEST_F(Batch, RefusesInputsChangedSinceThePlan) {
  frames(2);
  plan();
  const std::string config = content(at("run/config.yaml"));
  write(at("run/config.yaml"), config + "\nmatch:\n  window_size: 5\n");
  refuses({"batch", "work", path("run")}, {path("run/config.yaml"), "changed"});
  refuses({"batch", "merge", path("run"), "-o", path("rows")}, {path("run/config.yaml"), "changed"});
  write(at("run/config.yaml"), config);
  const std::string manifest = content(at("run/manifest.jsonl"));
  write(at("run/manifest.jsonl"), manifest.substr(0, manifest.size() / 2));
  refuses({"batch", "work", path("run")}, {path("run/manifest.jsonl"), "changed"});
  write(at("run/manifest.jsonl"), manifest);
  const std::string run_json = content(at("run/run.json"));
  std::string of_other = run_json;
  of_other.replace(of_other.find("\"cairn\": \"") + 10, 1, "9");
  write(at("run/run.json"), of_other);
  refuses({"batch", "work", path("run")}, {path("run/run.json"), "planned by cairn 9"});
  write(at("run/run.json"), run_json);
  write(at("in/01/calib.txt"), "fx=61\nfy=61\ncx=24\ncy=18\nbaseline=0.1\n");
  const Outcome outcome = run({"batch", "work", path("run")});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_NE(outcome.err.find("changed since the run was planned"), std::string::npos) << outcome.err;
}

TEST_F(Batch, StopsIfTheImagesAreNotOnThisMachine) {
  frames(2);
  plan();
  fs::rename(at("in"), at("elsewhere"));
  const Outcome outcome = run({"batch", "work", path("run")});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_NE(outcome.err.find("not found on this machine"), std::string::npos) << outcome.err;
  fs::rename(at("elsewhere"), at("in"));
  work("1/1");
  for (const Json& row : parsed(merged())) EXPECT_TRUE(row.contains("objects"));
}

TEST_F(Batch, RefusesBadInputInOneLine) {
  frames(1);
  plan();
  refuses({"batch"}, {});
  refuses({"batch", "play", path("run")}, {"play"});
  refuses({"batch", "plan", path("in")}, {"-o"});
  refuses({"batch", "plan", path("nowhere"), "-o", path("new")}, {path("nowhere")});
  refuses({"batch", "plan", path("in"), "-o", path("new"), "--set", "match.window=3"}, {"match.window"});
  refuses({"batch", "plan", path("in"), "-o", path("new"), "--frames", "5:9"}, {"--frames"});
  refuses({"batch", "plan", path("in"), path("in"), "-o", path("new")}, {"two frames would have the name"});
  refuses({"batch", "plan", path("in"), "-o", path("new"), "--calib", path("none.txt")}, {path("none.txt")});
  refuses({"batch", "plan", path("in"), "-o", path("new"), "--shard", "1/2"}, {"--shard", "work"});
  for (const char* shard : {"0/2", "3/2", "1", "1/0", "-1/2", "1/2/3", "a/b", "1/99999999999999999999"})
    refuses({"batch", "work", path("run"), "--shard", shard}, {"--shard", shard, "K/N"});
  refuses({"batch", "work", path("in")}, {path("in"), "run.json"});
  refuses({"batch", "work", path("run"), "--preset", "paper"}, {"--preset", "plan"});
  refuses({"batch", "work", path("run"), path("run")}, {"2 folders"});
  refuses({"batch", "status", path("nowhere")}, {path("nowhere")});
  refuses({"batch", "merge", path("run")}, {"-o"});
  write(at("run/run.json"), "{\"cairn\": 1}");
  refuses({"batch", "status", path("run")}, {path("run/run.json")});
  write(at("run/run.json"), "no json");
  refuses({"batch", "status", path("run")}, {path("run/run.json")});
}

TEST_F(Batch, ReadsPairsSequencesAndSeveralInputs) {
  frames(3);
  fs::create_directories(at("l"));
  fs::create_directories(at("r"));
  for (int i = 0; i < 3; ++i) {
    const std::string number = std::to_string(i);
    fs::copy_file(at("in/00/left.png"), at("l/" + number + ".png"));
    fs::copy_file(at("in/00/right.png"), at("r/" + number + ".png"));
  }
  write(at("l/1.png"), "no image");
  write(at("calib.txt"), "fx=60\nfy=60\ncx=24\ncy=18\nbaseline=0.1\nndisp=16\n");
  const Outcome planned =
      run({"batch", "plan", "in", "in/00/left.png,in/00/right.png", "l,r", "-o", "run", "--frames", "0:3:2"});
  if (planned.err.find("sequences are not built in") != std::string::npos)
    GTEST_SKIP() << "built without sequences";
  ASSERT_EQ(planned.code, 0) << planned.err;
  const Outcome all = run({"batch", "plan", "l,r", "-o", "all"});
  ASSERT_EQ(all.code, 0) << all.err;
  work("1/1");
  std::vector<std::string> names;
  for (const Json& row : parsed(merged())) {
    names.push_back(row["frame"]);
    EXPECT_TRUE(row.contains("objects")) << row["frame"];
  }
  EXPECT_EQ(names, (std::vector<std::string>{"in/00", "in/02", "in/00/left.png", "l/000000", "l/000002"}));
  // Wherever it is split, only the bad frame in the middle has an error.
  work("1/1", "all");
  const std::string expected = merged("all");
  const std::vector<Json> rows = parsed(expected);
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_EQ(rows[0]["stamp_ns"], 0);
  EXPECT_TRUE(rows[1].contains("error"));
  EXPECT_EQ(rows[2]["stamp_ns"], 200'000'000);
  fs::remove_all(at("all/parts"));
  for (const char* shard : {"1/3", "2/3", "3/3"}) work(shard, "all");
  EXPECT_EQ(merged("all"), expected);
}

TEST_F(Batch, FollowsWholeSequences) {
  for (const char* name : {"a", "b", "c"}) {
    for (int i = 0; i < 4; ++i) {
      pair_in(name + std::string("/") + std::to_string(i), {96, 72});
      write(at(name + std::string("/") + std::to_string(i) + "/calib.txt"),
            "fx=60\nfy=60\ncx=48\ncy=36\nbaseline=0.1\nndisp=16\n");
    }
  }
  fs::remove(at("b/1/right.png"));
  write(at("c/2/left.png"), "no image");
  const std::vector<std::string> words{"batch", "plan",     "a",     "b",
                                       "c",     "--tracks", "--set", "tracking.min_hits=2"};
  for (const char* name : {"run", "cut"}) {
    std::vector<std::string> all = words;
    all.insert(all.end(), {"-o", name});
    const Outcome planned = run(all);
    if (planned.err.find("sequences are not built in") != std::string::npos)
      GTEST_SKIP() << "built without sequences";
    ASSERT_EQ(planned.code, 0) << planned.err;
  }
  work("1/1");
  const std::string expected = merged();
  const std::vector<Json> rows = parsed(expected);
  ASSERT_EQ(rows.size(), 12U);
  const Outcome follow = run({"follow", "a", "--set", "tracking.min_hits=2", "--json-lines"});
  const std::vector<Json> lines = parsed(follow.out);
  ASSERT_EQ(lines.size(), 4U) << follow.err;
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(rows[i]["frame"], "a/00000" + std::to_string(i));
    for (const char* key : {"stamp_ns", "pose", "motion", "tracks"}) EXPECT_EQ(rows[i][key], lines[i][key]);
  }
  for (std::size_t i = 0; i < rows.size(); ++i)
    EXPECT_EQ(rows[i].contains("error"), i == 5 || i == 10) << rows[i]["frame"];

  // Two shards of three sequences, the first interrupted in the middle of one.
  work("2/2", "cut");
  work("1/2", "cut");
  EXPECT_EQ(merged("cut"), expected);
  fs::remove_all(at("cut/parts"));
  std::string some;
  for (std::size_t i = 0; i < 6; ++i) {
    const std::string row = rows_of(expected)[i];
    some += digest_of("cut", row) + " " + row + "\n";
  }
  write(at("cut/work/part-1-of-2.rows"), some);
  const Outcome resumed = run({"batch", "work", "cut", "--shard", "1/2"});
  EXPECT_EQ(resumed.out,
            "shard 1/2: 8 frames, 6 of them by a worker before, 1 with an error instead of objects\n");
  work("2/2", "cut");
  EXPECT_EQ(merged("cut"), expected);
  refuses({"batch", "work", "cut", "--keep"}, {"--keep", "--tracks"});
}

TEST_F(Batch, KeepsWholeResultsOnRequest) {
  frames(2);
  plan();
  ASSERT_EQ(run({"batch", "work", path("run"), "--keep"}).code, 0);
  EXPECT_TRUE(fs::exists(at("run/frames/00/objects.json")));
  EXPECT_TRUE(fs::exists(at("run/frames/01/overlay.png")));
  EXPECT_EQ(merged(), undisturbed());
}

TEST_F(Batch, ReadsItsShardFromASlurmArray) {
  frames(4);
  plan();
  const auto with_task = [&](const char* id, const char* count, const char* first) {
    ::setenv("SLURM_ARRAY_TASK_ID", id, 1);
    ::setenv("SLURM_ARRAY_TASK_COUNT", count, 1);
    ::setenv("SLURM_ARRAY_TASK_MIN", first, 1);
    const Outcome outcome = run({"batch", "work", path("run")});
    for (const char* name : {"SLURM_ARRAY_TASK_ID", "SLURM_ARRAY_TASK_COUNT", "SLURM_ARRAY_TASK_MIN"})
      ::unsetenv(name);
    return outcome;
  };
  EXPECT_TRUE(with_task("0", "4", "0").out.starts_with("shard 1/4: 1 frame"));
  EXPECT_TRUE(with_task("4", "4", "1").out.starts_with("shard 4/4: 1 frame"));
  const Outcome beyond = with_task("9", "4", "1");
  EXPECT_EQ(beyond.code, 2);
  EXPECT_NE(beyond.err.find("SLURM_ARRAY_TASK_ID"), std::string::npos) << beyond.err;
}

TEST_F(Batch, ResumesAfterTheLastCompleteRow) {
  frames(3);
  const std::string expected = undisturbed();
  plan();
  const pid_t child = begin("1/1");
  const fs::path rows = at("run/work/part-1-of-1.rows");
  // Killed after the first row, or within a row.
  for (int i = 0; i < 2000 && (!fs::exists(rows) || fs::file_size(rows) == 0); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  ::kill(child, SIGKILL);
  ended(child);
  const std::string whole = content(rows);
  for (const std::string& left_over :
       {whole.substr(0, whole.size() - 5), whole + "0123456789abcdef {\"frame\":\"01\",\"objects\":[]}\n",
        "x" + whole, whole + std::string(4096, '\0'), whole + whole}) {
    fs::remove_all(at("run/parts"));
    write(rows, left_over);
    work("1/1");
    EXPECT_EQ(merged(), expected);
    EXPECT_FALSE(fs::exists(rows));
  }
}

TEST_F(Batch, TwoWorkersOnOneShardGiveOneResult) {
  frames(6);
  const std::string expected = undisturbed();
  plan();
  const pid_t first = begin("1/1");
  const pid_t second = begin("1/1");
  EXPECT_EQ(ended(first), 0);
  EXPECT_EQ(ended(second), 0);
  EXPECT_EQ(merged(), expected);
  EXPECT_TRUE(run({"batch", "work", path("run")}).out.find("done before") != std::string::npos);
}

TEST_F(Batch, LosesNothingOnAFullDisk) {
  frames(4);
  const std::string expected = undisturbed();
  plan();
  // The disk is full while rows are written, and while the part is assembled.
  for (const std::size_t room : {expected.size() / 2, expected.size() + 40}) {
    fs::remove_all(at("run/parts"));
    EXPECT_EQ(ended(begin("1/1", room)), 2);
    const std::string err = content(at("err"));
    EXPECT_NE(err.find("cannot be written: File too large"), std::string::npos) << err;
    const std::string fault = err.substr(err.rfind("cairn: "));  // after the findings about the rig
    EXPECT_NE(fault.find("cannot be written"), std::string::npos) << err;
    EXPECT_EQ(std::count(fault.begin(), fault.end(), '\n'), 1) << err;
    EXPECT_FALSE(fs::exists(at("run/parts/part-1-of-1.jsonl")));
    work("1/1");
    EXPECT_EQ(merged(), expected);
  }
}

TEST_F(Batch, CompressesTheRowsOnRequest) {
  frames(3);
  const std::string expected = undisturbed();
  const Outcome outcome = run({"batch", "merge", path("alone"), "-o", path("rows.jsonl.zst")});
  if (outcome.code == 2 && outcome.err.find("libzstd-dev") != std::string::npos)
    GTEST_SKIP() << "built without zstd (libzstd-dev)";
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_TRUE(outcome.out.starts_with(io::sha256(expected)));
  EXPECT_LT(fs::file_size(at("rows.jsonl.zst")), expected.size() / 2);
  if (std::system("command -v zstd > /dev/null") != 0) GTEST_SKIP() << "no zstd to unpack with";
  const std::string unpack = "zstd -q -d " + path("rows.jsonl.zst") + " -o " + path("unpacked");
  ASSERT_EQ(std::system(unpack.c_str()), 0);
  EXPECT_EQ(content(at("unpacked")), expected);
}

TEST_F(Batch, ReportsTheProgressOfARun) {
  frames(6);
  plan();
  EXPECT_NE(run({"batch", "status", path("run")}).out.find("0 of 6 frames done (0.0 %), 0 errors"),
            std::string::npos);
  work("1/3");
  const std::string text = run({"batch", "status", path("run")}).out;
  EXPECT_NE(text.find("2 of 6 frames done (33.3 %)"), std::string::npos) << text;
  EXPECT_NE(text.find("1 shard done"), std::string::npos) << text;
}

TEST_F(Batch, RefusesAPartNotWrittenByAWorker) {
  frames(2);
  plan();
  work("1/1");
  const std::string part = content(at("run/parts/part-1-of-1.jsonl"));
  write(at("run/parts/part-1-of-1.jsonl"), part.substr(0, part.size() - 10));
  const Outcome outcome = run({"batch", "merge", path("run"), "-o", path("rows.jsonl")});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_NE(outcome.err.find("part-1-of-1.jsonl"), std::string::npos) << outcome.err;
  EXPECT_FALSE(fs::exists(at("rows.jsonl")));
}

}  // namespace
}  // namespace cairn::command
