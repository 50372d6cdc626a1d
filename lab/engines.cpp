// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// Races our stages against others in one process, interleaved, and reports the goals.
//   engines [DATA] [--repeats N] [--only TEXT] [--sections yes|no]
// DATA is the folder with real/. Every engine of a scene runs once, then all run again, and so on, so that
// disturbances of the machine affect all alike. Ratios are those of the least times. --only keeps the rows
// and sections that contain TEXT. One thread each, except where numbers of threads are compared: those rows
// use the wall clock and need a quiet machine (chrt -f 10).
#include "engines.hpp"

#include <algorithm>
#include <array>
#include <cairn/core/error.hpp>
#include <cairn/evaluation/object_error.hpp>
#include <cairn/io/image_files.hpp>
#include <cstdio>
#include <ctime>
#include <map>
#include <set>
#include <utility>

#include <cairn/timing/clock.hpp>
#include "arguments.hpp"
#include "markdown_table.hpp"

namespace cairn::lab {

Registry& registry() {
  static Registry all;
  return all;
}

std::string Scene::extent() const {
  return text(left.size()) + "x" + std::to_string(num_disparities);
}

double milliseconds(const Run& run, Clock clock) {
  const clockid_t id = clock == Clock::cpu ? CLOCK_PROCESS_CPUTIME_ID : CLOCK_MONOTONIC;
  const double start = timing::now_ms(id);
  run();
  return timing::now_ms(id) - start;
}

const Engine& engine_named(std::string_view name) {
  for (const Engine& engine : registry().engines) {
    if (engine.name == name) return engine;
  }
  throw Error("no engine is called '" + std::string(name) + "'");
}

namespace {

struct Settings {
  std::filesystem::path data = "../shared/data";
  int repeats = 15;
  std::string only;
  bool sections = true;
};

struct Extent {
  Size size;
  int num_disparities;
};
constexpr std::array kExtents{Extent{{320, 240}, 64}, Extent{{640, 480}, 64}, Extent{{1280, 720}, 128}};
constexpr std::array kFolders{std::pair{"Motorcycle", "real/middlebury2014/Motorcycle"},
                              std::pair{"KITTI", "real/kitti_pairs/kitti2012_train_000000_10"}};

std::vector<Scene> load_scenes(const std::filesystem::path& data) {
  std::vector<Scene> scenes;
  for (const auto& [name, folder] : kFolders) {
    const io::LoadedPair images = io::load_pair(data / folder / "left.png", data / folder / "right.png");
    for (const auto& [size, num_disparities] : kExtents) {
      const Image<Rgb>& rgb = images.left.rgb;
      scenes.push_back({name, num_disparities, resized(images.left.gray, size),
                        resized(images.right.gray, size), rgb.empty() ? Image<Rgb>() : resized(rgb, size)});
    }
  }
  return scenes;
}

/// One engine's times on one scene.
struct Trial {
  Run run;
  std::vector<double> times;
  [[nodiscard]] double least() const { return *std::min_element(times.begin(), times.end()); }
};
using Trials = std::map<std::string_view, Trial>;

Trials race(const Scene& scene, const std::set<std::string_view>& names, Clock clock, int repeats) {
  Trials trials;
  for (const std::string_view name : names) trials[name].run = engine_named(name).prepare(scene);
  for (auto& [name, trial] : trials) trial.run();  // warms up pools and caches
  for (int i = 0; i < repeats; ++i) {
    for (auto& [name, trial] : trials) trial.times.push_back(milliseconds(trial.run, clock));
  }
  return trials;
}

std::string goal_text(const Goal& goal) {
  std::string words;
  if (goal.at_least > 0) words += "≥ " + text_of("%.2f", goal.at_least);
  if (goal.at_most < std::numeric_limits<double>::infinity()) {
    words += (words.empty() ? "≤ " : ", ≤ ") + text_of("%.2f", goal.at_most);
  }
  return words.empty() ? "–" : words;
}

void add_row(MarkdownTable& table, const Comparison& row, const Scene& scene, const Trials& trials) {
  const Trial& ours = trials.at(row.ours);
  const Trial& peer = trials.at(row.peer);
  const double ratio = peer.least() / ours.least();
  const bool aims = row.goal.at_least > 0 || row.goal.at_most < std::numeric_limits<double>::infinity();
  const bool met = ratio >= row.goal.at_least && ratio <= row.goal.at_most;
  table.add({std::string(row.what), scene.name + " " + scene.extent(), std::string(row.peer),
             text_of("%.2f", peer.least()), text_of("%.2f", median(peer.times)),
             text_of("%.2f", ours.least()), text_of("%.2f", median(ours.times)), text_of("%.2f", ratio),
             goal_text(row.goal), aims ? (met ? "yes" : "**no**") : "–"});
}

std::vector<Comparison> rows_for(const Scene& scene, Clock clock, const std::string& only) {
  std::vector<Comparison> rows;
  for (const Comparison& row : registry().comparisons) {
    const bool wanted = std::string(row.what).find(only) != std::string::npos;
    if (row.extent == scene.extent() && row.clock == clock && wanted) rows.push_back(row);
  }
  return rows;
}

void print_races(const std::vector<Scene>& scenes, const Settings& settings) {
  MarkdownTable table(
      {"", "on", "against", "theirs, min ms", "median", "ours, min ms", "median", "ratio", "goal", "met"}, 3);
  for (const Clock clock : {Clock::cpu, Clock::wall}) {
    for (const Scene& scene : scenes) {
      const std::vector<Comparison> rows = rows_for(scene, clock, settings.only);
      std::set<std::string_view> names;
      for (const Comparison& row : rows) names.insert({row.ours, row.peer});
      const Trials trials = race(scene, names, clock, settings.repeats);
      for (const Comparison& row : rows) add_row(table, row, scene, trials);
    }
  }
  std::printf("%s", table.text().c_str());
}

Settings parse(const std::vector<std::string>& words) {
  Settings settings;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (!words[i].starts_with("--")) {
      settings.data = words[i];
      continue;
    }
    if (i + 1 == words.size()) throw Error("'" + words[i] + "' needs a value");
    const std::string& option = words[i++];
    if (option == "--repeats") {
      settings.repeats = positive_number(words[i]);
    } else if (option == "--only") {
      settings.only = words[i];
    } else if (option == "--sections") {
      settings.sections = words[i] == "yes";
    } else {
      throw Error("unknown option '" + option + "'");
    }
  }
  return settings;
}

void run(const Settings& settings) {
  const std::vector<Scene> scenes = load_scenes(settings.data);
  print_races(scenes, settings);
  for (const Section& section : registry().sections) {
    if (!settings.sections || std::string(section.title).find(settings.only) == std::string::npos) continue;
    std::fflush(stdout);
    std::printf("\n### %s\n\n%s", std::string(section.title).c_str(),
                section.write(settings.data, scenes).c_str());
  }
}

}  // namespace
}  // namespace cairn::lab

int main(int argc, char** argv) try {
  cairn::lab::run(cairn::lab::parse({argv + 1, argv + argc}));
} catch (const cairn::Error& error) {
  std::fprintf(stderr, "engines: %s\n", error.what());
  return 2;
}
