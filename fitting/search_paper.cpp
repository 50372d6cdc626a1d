// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// Searches the thresholds of the preset `paper` (Config::paper()) on the frames that choices are made on.
//   search_paper DATA [--threads N] [--rounds N] [--report] [OPTION=VALUE]...
// From the preset, with what is set, one option after the other takes each of its values below, and the one
// that makes the source's own measure best, the mean of E over the objects of all frames (200 % at most), is
// kept, as long as a third of what is found is an object (E says nothing of what is found besides); ties keep
// what was there. It ends with a round that changes nothing. The method stays the published one: no
// semi-global matching, no walls, no colour, no filter by confidence. The same frames give the same values.
// --report: only measures the start, and the frames under validate/ as well, of which nothing is chosen.
#include <algorithm>
#include <cairn/cairn.hpp>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "scored_frames.hpp"

namespace cairn::report {
namespace {

namespace fs = std::filesystem;

struct Knob {
  const char* option;
  std::vector<const char*> values;
};

const std::vector<Knob>& knobs() {
  static const std::vector<Knob> all{
      {"intensity.gradient_threshold", {"0", "1", "2", "3", "4", "6"}},
      {"intensity.smoothing_sigma", {"0.7", "1", "1.5", "2"}},
      {"disparity.mean_difference_max", {"0.5", "0.75", "1", "1.5", "2"}},
      {"disparity.deviation_max", {"0.5", "0.75", "1", "1.5"}},
      {"disparity.min_region_area", {"0.2", "0.5", "1", "1.5"}},
      {"objects.min_area", {"0.1", "0.3", "0.5", "1"}},
      {"disparity.gradient_threshold", {"0", "0.125", "0.25", "0.5", "1"}},
      {"texture.threshold", {"1", "2", "3", "5"}},
      {"uniqueness.ratio", {"-1", "2", "5", "10"}},
      {"ground.margin", {"0.75", "1", "1.5"}},
      {"intensity.mean_difference_max", {"2", "3", "5", "8"}},
      {"intensity.min_region_area", {"0.03", "0.1", "0.3"}},
      {"disparity.smoothing_sigma", {"0", "0.7", "1.5"}},
      {"match.window_size", {"7", "9", "11"}},
  };
  return all;
}

struct Source {
  const char* name;
  const char* folder;
  std::size_t every;  // n-th frame of it
};
const std::vector<Source> kFit{{"dev", "rendered/dev/320x240", 1},
                               {"train, every third", "rendered/train/320x240", 3},
                               {"rc_tabletop", "real/rc_tabletop", 1}};
const std::vector<Source> kValidate{{"validate 320x240", "rendered/validate/320x240", 1}};

struct FrameSet {
  std::string name;
  std::vector<TrueFrame> frames;
};

std::vector<FrameSet> load(const fs::path& data, const std::vector<Source>& sources) {
  std::vector<FrameSet> sets;
  for (const Source& source : sources) {
    const std::vector<io::FrameFiles> files = io::find_frames(data / source.folder);
    sets.push_back({source.name, {}});
    for (std::size_t i = 0; i < files.size(); i += source.every)
      sets.back().frames.push_back(load_true_frame(files[i]));
  }
  return sets;
}

struct Measured {
  std::vector<ObjectSummary> sets;
  ObjectSummary all;
  [[nodiscard]] double value() const {
    const double right = all.our_objects > 0 ? all.precision_50() : 0.0;
    return std::min(0.0, 3 * right - 1) - all.mean_error;
  }
};

Measured measure(const std::vector<FrameSet>& sets, const Config& config, int threads) {
  Measured measured;
  std::vector<FrameObjects> all;
  for (const FrameSet& set : sets) {
    std::vector<FrameObjects> objects;
    for (const Score& score : score_all(set.frames, config, true, threads)) objects.push_back(score.objects);
    measured.sets.push_back(summarise(objects));
    all.insert(all.end(), objects.begin(), objects.end());
  }
  measured.all = summarise(all);
  return measured;
}

void print(const char* name, const ObjectSummary& sum) {
  std::printf(
      "%-20s found %d/%d = %.3f, at 0.75 %d = %.3f, precision %d/%d = %.3f, median E %.1f %%, phantoms %d in "
      "%d frames\n",
      name, sum.found_50, sum.true_objects, sum.recall_50(), sum.found_75, sum.recall_75(), sum.right_50,
      sum.our_objects, sum.precision_50(), 100 * sum.median_error, sum.phantoms, sum.frames);
  std::fflush(stdout);
}

void print(const std::vector<FrameSet>& sets, const Measured& measured) {
  for (std::size_t i = 0; i < sets.size(); ++i) print(sets[i].name.c_str(), measured.sets[i]);
  print("together", measured.all);
}

std::string value_of(const Config& config, const std::string& option) {
  for (const OptionInfo& info : options(config)) {
    if (info.name == option) return info.value;
  }
  return {};
}

Config search(const std::vector<FrameSet>& sets, Config config, int rounds, int threads) {
  Measured best = measure(sets, config, threads);
  std::printf("start %.4f ", best.value());
  print("", best.all);
  for (int round = 0; round < rounds; ++round) {
    bool changed = false;
    for (const auto& [option, values] : knobs()) {
      for (const char* const value : values) {
        Config tried = config;
        set(tried, option, value);
        if (value_of(tried, option) == value_of(config, option)) continue;
        Measured measured = measure(sets, tried, threads);
        const bool better = measured.value() > best.value();
        std::printf("%c %s=%s %.4f ", better ? '+' : ' ', option, value, measured.value());
        print("", measured.all);
        if (!better) continue;
        config = tried;
        best = std::move(measured);
        changed = true;
      }
    }
    if (!changed) break;
  }
  return config;
}

int run(const std::vector<std::string>& arguments) {
  fs::path data;
  Config config = Config::paper();
  int threads = 1;
  int rounds = 3;
  bool report = false;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string& word = arguments[i];
    const std::size_t equals = word.find('=');
    if (word == "--threads" && i + 1 < arguments.size()) {
      threads = std::stoi(arguments[++i]);
    } else if (word == "--rounds" && i + 1 < arguments.size()) {
      rounds = std::stoi(arguments[++i]);
    } else if (word == "--report") {
      report = true;
    } else if (equals != std::string::npos) {
      set(config, word.substr(0, equals), word.substr(equals + 1));
    } else {
      data = word;
    }
  }
  if (data.empty()) {
    std::fputs("search_paper DATA [--threads N] [--rounds N] [--report] [OPTION=VALUE]...\n", stderr);
    return 1;
  }
  const std::vector<FrameSet> fit = load(data, kFit);
  if (!report) config = search(fit, config, rounds, threads);
  print(fit, measure(fit, config, threads));
  if (report) {
    const std::vector<FrameSet> validate = load(data, kValidate);
    print(validate, measure(validate, config, threads));
  }
  for (const Knob& knob : knobs()) std::printf("%s=%s ", knob.option, value_of(config, knob.option).c_str());
  std::printf("\n");
  return 0;
}

}  // namespace
}  // namespace cairn::report

int main(int count, char** arguments) {
  try {
    return cairn::report::run({arguments + 1, arguments + count});
  } catch (const std::exception& error) {
    std::fprintf(stderr, "search_paper: %s\n", error.what());
    return 2;
  }
}
