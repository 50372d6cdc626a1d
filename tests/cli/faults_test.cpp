// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <sys/resource.h>
#include <sys/stat.h>

#include <chrono>
#include <csignal>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <thread>

#include "command.hpp"

/// Faults in the environment of the command: signals, memory, pipes, names, links.
namespace cairn::command {
namespace {

class Faults : public CommandTest {
 protected:
  /// Runs the command in the tests' folder, after calling `prepare` in its process; stdout and stderr go to
  /// files.
  [[nodiscard]] pid_t begin(std::vector<std::string> words, const std::function<void()>& prepare = {}) const {
    words.insert(words.begin(), CAIRN_COMMAND);
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    const std::string folder = path("");
    const std::string out = path("../out");
    const std::string err = path("../err");
    const pid_t child = ::fork();
    if (child != 0) return child;
    if (::chdir(folder.c_str()) != 0) ::_exit(127);
    ::dup2(::open("/dev/null", O_RDONLY), STDIN_FILENO);
    ::dup2(::open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644), STDOUT_FILENO);
    ::dup2(::open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644), STDERR_FILENO);
    if (prepare) prepare();
    ::execv(CAIRN_COMMAND, argv.data());
    ::_exit(127);
  }
  [[nodiscard]] Outcome end(pid_t child) const {
    Outcome outcome;
    int status = 0;
    ::waitpid(child, &status, 0);
    outcome.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    outcome.out = content(at("../out"));
    outcome.err = content(at("../err"));
    return outcome;
  }
  [[nodiscard]] Outcome run_after(const std::function<void()>& prepare,
                                  const std::vector<std::string>& words) const {
    return end(begin(words, prepare));
  }

  /// The content of a result folder without times, hidden files and folders.
  [[nodiscard]] std::map<std::string, std::string> results_in(const std::string& folder) const {
    std::map<std::string, std::string> all;
    if (!fs::exists(at(folder))) return all;
    for (auto entry = fs::recursive_directory_iterator(at(folder)); entry != fs::end(entry); ++entry) {
      if (entry->path().filename().string().starts_with('.')) {
        entry.disable_recursion_pending();
        continue;
      }
      if (!entry->is_regular_file()) continue;
      std::string& bytes = all[fs::relative(entry->path(), at(folder)).string()];
      bytes = content(entry->path());
      if (entry->path().filename() != "objects.json") continue;
      nlohmann::json json = nlohmann::json::parse(bytes);  // throws for a truncated file
      json.erase("timings_ms");
      bytes = json.dump();
    }
    return all;
  }
};

TEST_F(Faults, AKilledRunLeavesCompleteResultsAndTheNextOneResumes) {
  for (int i = 0; i < 5; ++i) pair_in("in/" + std::to_string(i), {96 + i, 72});
  const auto start = std::chrono::steady_clock::now();
  ASSERT_EQ(run({"segment", path("in"), "-o", path("alone"), "--threads", "1"}).code, 0);
  const auto whole = std::chrono::steady_clock::now() - start;
  const auto expected = results_in("alone");
  ASSERT_GT(expected.size(), 20U);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> share(0.02, 0.9);
  int killed = 0;
  for (int i = 0; i < 16; ++i) {
    if (i % 4 == 0) fs::remove_all(at("out"));  // else over the older results
    const int signal = i % 2 == 0 ? SIGKILL : SIGTERM;
    const pid_t child = begin({"segment", path("in"), "-o", path("out"), "--threads", "1"});
    std::this_thread::sleep_for(whole * share(random));
    ::kill(child, signal);
    killed += end(child).code == 128 + signal ? 1 : 0;
    for (const auto& [name, bytes] : results_in("out")) {
      ASSERT_TRUE(expected.count(name) == 1) << name;
      EXPECT_EQ(bytes, expected.at(name)) << name << " after signal " << signal;
    }
  }
  EXPECT_GT(killed, 3);
  ASSERT_EQ(run({"segment", path("in"), "-o", path("out"), "--threads", "1"}).code, 0);
  EXPECT_EQ(results_in("out"), expected);
  EXPECT_EQ(run({"evaluate", path("out"), path("alone")}).code, 0);
  RecordProperty("killed", killed);
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // which take terabytes of addresses

TEST_F(Faults, AMemoryLimitEndsInOneLineAndCompleteResults) {
  const auto pair = pair_in("pair", {640, 480});
  ASSERT_EQ(run(with("segment", pair, {"-o", path("alone")})).code, 0);
  const auto expected = results_in("alone");
  int refused = 0;
  int done = 0;
  int not_loaded = 0;
  for (rlim_t megabytes = 40; done < 2 && megabytes < 4000; megabytes += megabytes / 12) {
    const rlimit limit{megabytes << 20, megabytes << 20};
    const Outcome outcome = run_after([&] { ::setrlimit(RLIMIT_AS, &limit); },
                                      with("segment", pair, {"-o", path("out"), "--threads", "2"}));
    const auto found = results_in("out");
    const std::string where = std::to_string(megabytes) + " MB: " + outcome.err;
    if (outcome.code == 0) {
      ++done;
      EXPECT_TRUE(found == expected) << where;
    } else if (outcome.code == 127) {  // the system could not load the program
      ++not_loaded;
      EXPECT_EQ(done, 0) << where;
    } else {
      ++refused;
      EXPECT_EQ(outcome.code, 1) << where;
      EXPECT_TRUE(outcome.err.starts_with("cairn: ")) << where;
      EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << where;
      EXPECT_FALSE(fs::exists(at("out"))) << where;
    }
    fs::remove_all(at("out"));
  }
  EXPECT_GT(refused, 3);
  EXPECT_EQ(done, 2);
  RecordProperty("refused", refused);
  RecordProperty("not_loaded", not_loaded);
}

TEST_F(Faults, ClaimedHugeSizesAreRefusedInLittleMemory) {
  const auto pair = pair_in("pair");
  const rlimit limit{rlim_t{700} << 20, rlim_t{700} << 20};
  const auto refuses_file = [&](const std::string& name, const std::string& bytes,
                                const std::vector<std::string>& arguments) {
    write(at(name), bytes);
    const Outcome outcome = run_after([&] { ::setrlimit(RLIMIT_AS, &limit); }, arguments);
    EXPECT_EQ(outcome.code, 2) << name << ": " << outcome.err;
    EXPECT_NE(outcome.err.find(name), std::string::npos) << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  };
  const std::string claim = "60000 60000";
  refuses_file("huge.pgm", "P5 " + claim + " 255\nabc", {"segment", path("huge.pgm"), pair[1]});
  refuses_file("huge.pfm", "Pf\n" + claim + "\n-1.0\nabcd",
               {"segment", pair[0], "--disparity", path("huge.pfm")});
  std::string npy = std::string("\x93NUMPY\x01\x00\x76\x00", 10) +
                    "{'descr': '<f4', 'fortran_order': False, 'shape': (60000, 60000), }";
  npy.resize(127, ' ');
  refuses_file("huge.npy", npy + "\nabcd", {"segment", pair[0], "--disparity", path("huge.npy")});
  const std::string deep(1'000'000, '[');
  fs::create_directories(at("results"));
  fs::copy_file(pair[0], at("results/objects.png"));
  refuses_file("results/objects.json", deep, {"evaluate", path("results"), path("results")});
  refuses_file("deep.yaml", deep, {"config", "--config", path("deep.yaml")});
  refuses_file("deep.json", deep, {"segment", pair[0], pair[1], "--calib", path("deep.json")});
}

#endif

TEST_F(Faults, AClosedOutputIsDetectedAndNotReplacedByAResult) {
  const auto pair = pair_in("pair");
  const auto arguments = with("segment", pair, {"-o", path("out")});
  ASSERT_EQ(run(with("segment", pair, {"-o", path("alone")})).code, 0);
  const Outcome outcome = run_after([] { ::close(STDOUT_FILENO); }, arguments);
  EXPECT_EQ(outcome.code, 1);
  EXPECT_EQ(outcome.err.substr(outcome.err.rfind("cairn: ")), "cairn: standard output: cannot be written\n");
  EXPECT_EQ(results_in("out"), results_in("alone"));
  const Outcome silent = run_after(
      [] {
        for (const int stream : {0, 1, 2}) ::close(stream);
      },
      arguments);
  EXPECT_EQ(silent.code, 1);
  EXPECT_EQ(results_in("out"), results_in("alone"));
}

/// Without stdout, the next file to be opened would become stdout.
TEST_F(Faults, OutputForAClosedStdoutIsNotWrittenToAFile) {
  if (run({"follow", "--help"}).code != 0) GTEST_SKIP() << "sequences are not built in";
  for (int i = 0; i < 3; ++i) pair_in("in/" + std::to_string(i));
  const Outcome outcome =
      run_after([] { ::close(STDOUT_FILENO); }, {"follow", path("in"), "-o", path("out"), "--json-lines"});
  EXPECT_EQ(outcome.code, 1);
  const std::string tracks = content(at("out/tracks.jsonl"));
  EXPECT_LE(std::count(tracks.begin(), tracks.end(), '\n'), 3);
  EXPECT_EQ(tracks.find("\"frame\":0,"), tracks.rfind("\"frame\":0,")) << tracks;
}

TEST_F(Faults, AClosedPipeLeavesCompleteResults) {
  for (int i = 0; i < 4; ++i) pair_in("in/" + std::to_string(i));
  ASSERT_EQ(run({"segment", path("in"), "-o", path("alone")}).code, 0);
  int ends[2] = {};
  ASSERT_EQ(::pipe(ends), 0);
  ::close(ends[0]);
  const Outcome outcome =
      run_after([&] { ::dup2(ends[1], STDOUT_FILENO); }, {"segment", path("in"), "-o", path("out")});
  ::close(ends[1]);
  EXPECT_TRUE(outcome.code == 1 || outcome.code == 128 + SIGPIPE) << outcome.code;
  const auto expected = results_in("alone");
  const auto written = results_in("out");
  EXPECT_FALSE(written.empty());
  for (const auto& [name, bytes] : written) EXPECT_EQ(bytes, expected.at(name)) << name;
}

TEST_F(Faults, TheTruthNextToTheImagesIsNotAnOlderResult) {
  const auto pair = pair_in("pair");
  fs::copy_file(pair[0], at("pair/objects.png"));
  const std::string truth = content(path("pair/objects.png"));
  refuses({"segment", path("pair"), "-o", path("pair")}, {"objects.png", "objects.json", "-o"});
  EXPECT_EQ(content(path("pair/objects.png")), truth);
  EXPECT_FALSE(fs::exists(at("pair/objects.json")));
  fs::remove(at("pair/objects.png"));
  for (int i = 0; i < 2; ++i) EXPECT_EQ(run({"segment", path("pair"), "-o", path("pair")}).code, 0);
}

TEST_F(Faults, InputsAreNotOverwritten) {
  const auto pair = pair_in("pair");
  const std::string left = content(pair[0]);
  refuses(with("disparity", pair, {"-o", pair[0]}), {"left.png", "is read by this run"});
  refuses(with("disparity", pair, {"--confidence", path("pair/../pair/right.png")}),
          {"right.png", "is read"});
  fs::create_symlink(pair[0], at("link.png"));
  fs::create_hard_link(pair[0], at("other.png"));
  refuses(with("disparity", pair, {"-o", path("link.png")}), {"link.png", "is read"});
  refuses(with("disparity", pair, {"--view", path("other.png")}), {"other.png", "is read"});
  EXPECT_EQ(content(pair[0]), left);
}

TEST_F(Faults, LinksAreFollowedAndLoopsRefused) {
  const auto pair = pair_in("pair");
  fs::create_directory_symlink(at("pair"), at("linked"));
  fs::create_directories(at("elsewhere"));
  fs::create_directory_symlink(at("elsewhere"), at("out"));
  EXPECT_EQ(run({"segment", path("linked"), "-o", path("out")}).code, 0);
  EXPECT_TRUE(fs::is_symlink(at("out")));
  EXPECT_TRUE(fs::exists(at("elsewhere/objects.json")));
  fs::create_symlink(at("loop"), at("loop"));
  refuses({"segment", path("loop")}, {"loop"});
  refuses(with("segment", pair, {"-o", path("loop")}), {"loop"});
  fs::create_symlink(at("nowhere"), at("dangling.png"));
  refuses({"segment", path("dangling.png"), pair[1]}, {"dangling.png"});
}

/// Input from a pipe has no known length.
TEST_F(Faults, AFileTruncatedWhileReadingIsRefused) {
  const auto pair = pair_in("pair");
  const std::string whole = content(pair[0]);
  ASSERT_EQ(::mkfifo(path("pipe.png").c_str(), 0600), 0);
  const auto segmented_with = [&](const std::string& bytes) {
    const pid_t child = begin({"segment", path("pipe.png"), pair[1], "-o", path("out")});
    std::ofstream(at("pipe.png"), std::ios::binary) << bytes;
    return end(child);
  };
  const Outcome cut = segmented_with(whole.substr(0, whole.size() / 2));
  EXPECT_EQ(cut.code, 2) << cut.err;
  EXPECT_NE(cut.err.find("pipe.png: is a truncated"), std::string::npos) << cut.err;
  EXPECT_FALSE(fs::exists(at("out")));
  EXPECT_EQ(segmented_with(whole).code, 0);
}

TEST_F(Faults, AnyNameIsEscapedInPagesTablesAndJson) {
  const std::string name = "a\"b\n<script\xc3\xa9'&\x1b[2J";  // no name has a slash
  const std::string other = "<script>alert(1)<";
  pair_in("in/" + name);
  pair_in("in/" + other);
  pair_in("in/plain");
  const Outcome outcome = run({"segment", path("in"), "--html", "-o", path("out")});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.out.find('\x1b'), std::string::npos);
  EXPECT_TRUE(fs::exists(at("out") / name / "objects.json"));
  const std::string page = content(at("out/segment.html"));
  EXPECT_EQ(page.find("<script>alert"), std::string::npos);
  write(at("in/" + name + "/right.png"), "no image");
  const Outcome bad = run({"segment", path("in"), "-o", path("out")});
  EXPECT_EQ(bad.code, 2);
  EXPECT_EQ(bad.err.find('\x1b'), std::string::npos) << bad.err;
  ASSERT_EQ(run({"batch", "plan", path("in"), "-o", path("run")}).code, 0);
  ASSERT_EQ(run({"batch", "work", path("run")}).code, 0);
  ASSERT_EQ(run({"batch", "merge", path("run"), "-o", path("rows")}).code, 0);
  std::set<std::string> names;
  std::ifstream rows(at("rows"));
  for (std::string row; std::getline(rows, row);) {
    const auto json = nlohmann::json::parse(row);
    if (json.contains("frame")) names.insert(json.at("frame").get<std::string>());
  }
  EXPECT_EQ(names, (std::set<std::string>{name, other, "plain"}));
}

}  // namespace
}  // namespace cairn::command
