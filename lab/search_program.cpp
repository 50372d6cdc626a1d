// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "search_program.hpp"

#include <algorithm>
#include <cstdio>
#include <random>

#include "arguments.hpp"

namespace cairn::lab {
namespace {

namespace fs = std::filesystem;

struct Source {
  const char* name;
  const char* folder;
  std::size_t every = 1;  // use each n-th frame
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

struct SetScores {
  std::vector<ObjectSummary> sets;
  ObjectSummary all;
  [[nodiscard]] double value() const {
    const double right = all.our_objects > 0 ? all.precision_50() : 0.0;
    return std::min(0.0, 3 * right - 1) - all.mean_error;
  }
};

SetScores measure(const SearchProgram& program, const std::vector<FrameSet>& sets, const Values& values,
                  int threads) {
  SetScores measured;
  std::vector<FrameObjects> all;
  for (const FrameSet& set : sets) {
    std::vector<FrameObjects> objects(set.frames.size());
    for_each_index(objects.size(), threads, [&](std::size_t i, const Exec& exec) {
      objects[i] = program.score(set.frames[i], values, exec).objects;
    });
    measured.sets.push_back(summarise(objects));
    all.insert(all.end(), objects.begin(), objects.end());
  }
  measured.all = summarise(all);
  return measured;
}

void print(const std::string& name, const ObjectSummary& sum) {
  std::printf(
      "%-20s found %d/%d = %.3f, at 0.75 %d = %.3f, precision %d/%d = %.3f, mean E %.1f %%, median E %.1f "
      "%%, "
      "phantoms %d in %d frames\n",
      name.c_str(), sum.found_50, sum.true_objects, sum.recall_50(), sum.found_75, sum.recall_75(),
      sum.right_50, sum.our_objects, sum.precision_50(), 100 * sum.mean_error, 100 * sum.median_error,
      sum.phantoms, sum.frames);
  std::fflush(stdout);
}

void print(const std::vector<FrameSet>& sets, const SetScores& measured) {
  for (std::size_t i = 0; i < sets.size(); ++i) print(sets[i].name, measured.sets[i]);
  print("together", measured.all);
}

struct Effort {
  int draws = 0;
  int rounds = 3;
};

Values search(const SearchProgram& program, const std::vector<FrameSet>& fit, Values start,
              const Effort& effort, int threads) {
  std::mt19937 random;  // whose output the standard specifies exactly
  double best_value = effort.draws > 0 ? measure(program, fit, start, threads).value() : 0;
  for (int i = 0; i < effort.draws; ++i) {
    const Values values = drawn(program.knobs, random);
    const SetScores measured = measure(program, fit, values, threads);
    if (measured.value() <= best_value) continue;
    best_value = measured.value();
    start = values;
    std::printf("draw %d: %.4f ", i + 1, best_value);
    print("", measured.all);
  }
  int tried = 0;
  SetScores last;
  const KnobSearch settings{.rounds = effort.rounds,
                            .score =
                                [&](const Values& values) {
                                  last = measure(program, fit, values, threads);
                                  if (tried++ == 0) print("start", last.all);
                                  return last.value();
                                },
                            .tried =
                                [&](std::size_t knob, const Values& values, double score, bool kept) {
                                  std::printf("%c %s=%s %.4f ", kept ? '+' : ' ',
                                              program.knobs[knob].option.c_str(), values[knob].c_str(),
                                              score);
                                  print("", last.all);
                                }};
  Values best = search_knobs(program.knobs, start, settings);
  std::printf("%d settings tried\n", effort.draws + tried);
  return best;
}

}  // namespace

std::vector<FrameSet> fit_sets(const fs::path& data) {
  return load(data, {{"dev", "rendered/dev/320x240"},
                     {"train, every third", "rendered/train/320x240", 3},
                     {"rc_tabletop", "real/rc_tabletop"}});
}

std::vector<FrameSet> validation_sets(const fs::path& data) {
  return load(data, {{"validate 320x240", "rendered/validate/320x240"},
                     {"validate rc_tabletop", "real/validate/rc_tabletop"}});
}

std::vector<FrameSet> hard_sets(const fs::path& data, const fs::path& yardstick) {
  std::vector<FrameSet> sets;
  if (!yardstick.empty())
    sets = load(yardstick, {{"yardstick indoors", "indoors"}, {"yardstick outdoors", "outdoors"}});
  for (FrameSet& set : load(data, {{"validate_varied", "rendered/validate_varied/320x240"},
                                   {"validate_models", "rendered/validate_models/320x240"},
                                   {"validate_outdoor", "rendered/validate_outdoor/320x240"}}))
    sets.push_back(std::move(set));
  return sets;
}

void run_search(const SearchProgram& program, const std::vector<std::string>& arguments) {
  fs::path data;
  Values values = program.start;
  int threads = 1;
  Effort effort;
  bool report = false;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string& word = arguments[i];
    const std::size_t equals = word.find('=');
    if (word == "--threads" && i + 1 < arguments.size()) {
      threads = positive_number(arguments[++i]);
    } else if (word == "--rounds" && i + 1 < arguments.size()) {
      effort.rounds = positive_number(arguments[++i]);
    } else if (word == "--draws" && i + 1 < arguments.size()) {
      effort.draws = positive_number(arguments[++i]);
    } else if (word == "--report") {
      report = true;
    } else if (equals != std::string::npos) {
      const auto knob = std::find_if(program.knobs.begin(), program.knobs.end(),
                                     [&](const Knob& k) { return k.option == word.substr(0, equals); });
      if (knob == program.knobs.end()) throw Error("found '" + word + "', expected an option of the search");
      values[static_cast<std::size_t>(knob - program.knobs.begin())] = word.substr(equals + 1);
    } else if (data.empty() && !word.starts_with('-')) {
      data = word;
    } else {
      throw Error("unknown argument '" + word + "'");
    }
  }
  if (data.empty()) {
    throw Error(
        "no data collection given: DATA [--threads N] [--draws N] [--rounds N] [--report] [OPTION=VALUE]...");
  }
  const std::vector<FrameSet> fit = fit_sets(data);
  if (!report) values = search(program, fit, values, effort, threads);
  print(fit, measure(program, fit, values, threads));
  if (report) {
    const std::vector<FrameSet> validate = validation_sets(data);
    print(validate, measure(program, validate, values, threads));
  }
  for (std::size_t i = 0; i < values.size(); ++i)
    std::printf("%s=%s ", program.knobs[i].option.c_str(), values[i].c_str());
  std::printf("\n");
}

}  // namespace cairn::lab
