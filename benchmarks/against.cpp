// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// Two builds of the command on one pair, in turns: how many times as long each stage takes in the second.
//   against FIRST SECOND [--rounds N] [FOLDER] [OPTIONS]
// FIRST and SECOND are programs called cairn. FOLDER holds left.png, right.png and perhaps calib.txt; without
// it both work on the pair that this program draws. OPTIONS go to both. A round is a few frames of each; who
// begins changes with every round, and a ratio is one round's, so that what the machine does meanwhile hits
// both alike. Processor time of `cairn bench` on one thread where nothing else is asked for; the wall time
// that `cairn segment` states where one of the two is too old to know `bench`.
#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cairn/core/error.hpp>
#include <cairn/evaluation/object_error.hpp>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <io/atomic_file.hpp>
#include <io/image_files.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include <timing/drawn_pair.hpp>
#include <timing/statistics.hpp>
#include "arguments.hpp"
#include "markdown_table.hpp"

namespace {

using namespace cairn;
namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct Settings {
  std::array<fs::path, 2> programs;
  int rounds = 15;
  fs::path folder;
  std::vector<std::string> options;
};

/// Gone with all that it holds.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string name = (fs::temp_directory_path() / "cairn-against-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw Error(name + ": cannot be made");
    path_ = name;
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  ~ScratchFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

/// Runs a program with its standard output in a file; its exit code.
int run(const fs::path& program, const std::vector<std::string>& arguments, const fs::path& out,
        bool silent = false) {
  constexpr mode_t kMode = 0644;
  std::vector<std::string> words{program.string()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  argv.reserve(words.size() + 1);
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, kMode);
  if (silent) posix_spawn_file_actions_addopen(&files, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  pid_t child = 0;
  const int failed = posix_spawn(&child, program.c_str(), &files, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  if (failed != 0) throw Error(program.string() + ": cannot be run");
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 1;
}

void run_or_throw(const fs::path& program, const std::vector<std::string>& arguments, const fs::path& out) {
  if (run(program, arguments, out) != 0) throw Error(program.string() + ": failed");
}

/// Milliseconds of each stage in the order of the work, the whole frame last.
using Times = std::vector<std::pair<std::string, double>>;

constexpr int kFrames = 5;  // of each program in a round
constexpr const char* kWhole = "frame";

std::vector<std::string> joined(std::vector<std::string> first, const std::vector<std::string>& then) {
  first.insert(first.end(), then.begin(), then.end());
  return first;
}

Times times_of_bench(const fs::path& program, const Settings& settings, const fs::path& scratch) {
  const fs::path file = scratch / "bench.json";
  run_or_throw(program,
               joined({"bench", settings.folder.string(), "--no-opencv", "--frames", std::to_string(kFrames),
                       "--json", file.string()},
                      settings.options),
               "/dev/null");
  std::ifstream in(file);
  const Json found = Json::parse(in);
  Times times;
  for (const Json& stage : found.at("stages"))
    times.emplace_back(stage.at("name"), stage.at("cpu_ms").at("median"));
  times.emplace_back(kWhole, found.at("frame").at("cpu_ms").at("median"));
  return times;
}

/// `cairn segment` over a folder that holds the pair several times; the first frame fills the pool and counts
/// for nothing.
Times times_of_segment(const fs::path& program, const Settings& settings, const fs::path& scratch) {
  const fs::path frames = scratch / "frames";
  for (int i = 0; i <= kFrames; ++i) {
    const fs::path link = frames / std::to_string(i);
    fs::create_directories(frames);
    if (!fs::exists(link)) fs::create_directory_symlink(fs::absolute(settings.folder), link);
  }
  const fs::path file = scratch / "segment.json";
  run_or_throw(program, joined({"segment", frames.string(), "--json"}, settings.options), file);
  std::vector<std::string> order;
  std::map<std::string, std::vector<double>> of_stage;
  std::ifstream in(file);
  for (int i = 0; i <= kFrames; ++i) {
    Json frame;
    in >> frame;
    if (i == 0) continue;
    double whole = 0;
    for (const auto& [stage, milliseconds] : frame.at("timings_ms").items()) {
      if (!of_stage.contains(stage)) order.push_back(stage);
      of_stage[stage].push_back(milliseconds);
      whole += milliseconds.get<double>();
    }
    of_stage[kWhole].push_back(whole);
  }
  order.emplace_back(kWhole);
  Times times;
  for (const std::string& stage : order) times.emplace_back(stage, report::percentile(of_stage[stage], 0.5));
  return times;
}

/// What all rounds say of one stage; NaN where a program does not have it.
struct Row {
  std::array<std::vector<double>, 2> ms;
  std::vector<double> ratios;
};

struct Comparison {
  std::vector<std::string> order;
  std::map<std::string, Row> rows;
};

void add_round(Comparison& all, const std::array<Times, 2>& round) {
  std::map<std::string, std::array<double, 2>> by_stage;
  for (std::size_t program = 0; program < round.size(); ++program) {
    for (const auto& [stage, ms] : round[program]) {
      if (!all.rows.contains(stage)) all.order.push_back(stage);
      all.rows[stage].ms[program].push_back(ms);
      by_stage.try_emplace(stage, std::array{std::nan(""), std::nan("")}).first->second[program] = ms;
    }
  }
  for (const auto& [stage, ms] : by_stage) all.rows[stage].ratios.push_back(ms[1] / ms[0]);
}

void print(const Comparison& all, bool processor_time) {
  std::printf("%-22s %12s %12s %8s   %s\n", processor_time ? "processor time" : "wall time", "first ms",
              "second ms", "ratio", "middle half of the rounds");
  const auto line = [&](const std::string& stage) {
    const Row& row = all.rows.at(stage);
    const auto ratio = [&](double share) {
      return report::text_of("%.3f", report::percentile(row.ratios, share));
    };
    std::printf("%-22s %12s %12s %8s   %s ... %s\n", stage.c_str(),
                report::text_of("%.3f", median(row.ms[0])).c_str(),
                report::text_of("%.3f", median(row.ms[1])).c_str(), ratio(0.5).c_str(), ratio(0.25).c_str(),
                ratio(0.75).c_str());
  };
  for (const std::string& stage : all.order) {
    if (stage != kWhole) line(stage);
  }
  line(kWhole);
}

/// The drawn pair as files, which builds of any age can read.
fs::path draw_into(const fs::path& folder) {
  constexpr Size kSize{640, 480};
  constexpr float kLargestDisparity = 48;
  const report::DrawnPair drawn = report::draw_pair(kSize, kLargestDisparity);
  fs::create_directories(folder);
  io::save_png(folder / "left.png", View<const Rgb>(drawn.left_rgb));
  io::save_png(folder / "right.png", View<const Rgb>(drawn.right_rgb));
  const StereoRig& rig = drawn.rig;
  io::write_file(folder / "calib.txt",
                 "fx=" + std::to_string(rig.focal_px) + "\nfy=" + std::to_string(rig.focal_px) +
                     "\ncx=" + std::to_string(rig.cx_px) + "\ncy=" + std::to_string(rig.cy_px) +
                     "\nbaseline=" + std::to_string(rig.baseline_m) + "\nndisp=64\n");
  return folder;
}

Settings parse(const std::vector<std::string>& words) {
  if (words.size() < 2) throw Error("usage: against FIRST SECOND [--rounds N] [FOLDER] [OPTIONS]");
  Settings settings;
  settings.programs = {words[0], words[1]};
  for (std::size_t i = 2; i < words.size(); ++i) {
    if (words[i] == "--rounds" && i + 1 < words.size()) {
      settings.rounds = report::positive_number(words[++i]);
    } else if (settings.folder.empty() && settings.options.empty() && !words[i].starts_with('-')) {
      settings.folder = words[i];
    } else {
      settings.options.push_back(words[i]);
    }
  }
  if (std::find(settings.options.begin(), settings.options.end(), "--threads") == settings.options.end()) {
    settings.options.insert(settings.options.end(), {"--threads", "1"});
  }
  return settings;
}

void compare(Settings settings) {
  const ScratchFolder scratch;
  if (settings.folder.empty()) settings.folder = draw_into(scratch.path() / "drawn");
  const bool both_bench =
      std::all_of(settings.programs.begin(), settings.programs.end(), [](const auto& program) {
        return run(program, {"bench", "--help"}, "/dev/null", true) == 0;
      });
  const auto times_of = both_bench ? times_of_bench : times_of_segment;
  Comparison all;
  for (int i = 0; i < settings.rounds; ++i) {
    std::array<Times, 2> round;
    const auto first = static_cast<std::size_t>(i % 2);
    for (const std::size_t program : {first, 1 - first})
      round[program] = times_of(settings.programs[program], settings, scratch.path());
    add_round(all, round);
  }
  print(all, both_bench);
  std::printf("The median of %d rounds of %d frames each; ratio: second to first, below 1 is quicker.\n",
              settings.rounds, kFrames);
}

}  // namespace

int main(int argc, char** argv) try {
  compare(parse({argv + 1, argv + argc}));
} catch (const cairn::Error& error) {
  std::fprintf(stderr, "against: %s\n", error.what());
  return 2;
} catch (const std::exception& error) {
  std::fprintf(stderr, "against: %s\n", error.what());
  return 1;
}
