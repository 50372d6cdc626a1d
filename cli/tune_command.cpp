// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cairn/core/error.hpp>
#include <cairn/io/atomic_file.hpp>
#include <cairn/io/config_files.hpp>
#include <cairn/output/json.hpp>
#include <cairn/output/tuning_json.hpp>
#include <cairn/tuning/tune.hpp>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <set>
#include <stdexcept>

#include "commands.hpp"
#include "common.hpp"
#include "interrupt.hpp"
#include "keep_inputs.hpp"
#include "terminal.hpp"
#include "tune_sequence.hpp"
#include "tuning_frames.hpp"

namespace cairn::cli {
namespace {

namespace fs = std::filesystem;
using output::Json;
using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;

struct TuneOptions {
  std::vector<std::string> folders;
  InputOptions input;  // without its images
  ExecOptions exec;
  bool truth = false;
  bool sequence = false;
  std::vector<std::string> patterns;
  std::string budget = "60s";
  int evaluations = 0;            // 0 = as many as the budget allows
  std::optional<double> holdout;  // default: kHoldout from kEnough frames on
  std::uint32_t seed = 1;
  std::string output = "tuned.yaml";
  std::string json;
};

constexpr double kHoldout = 0.25;
constexpr std::size_t kEnough = 8;

// ---- time and Ctrl-C ----

/// "90", "60s", "5m", "1.5h".
Seconds parse_budget(const std::string& text) {
  double value = 0;
  std::string unit;
  try {
    std::size_t end = 0;
    value = std::stod(text, &end);
    unit = text.substr(end);
  } catch (const std::exception&) {
    value = -1;
  }
  const double seconds = unit.empty() || unit == "s" ? 1 : unit == "m" ? 60 : unit == "h" ? 3600 : 0;
  constexpr double kLongest = 30 * 24 * 3600.0;
  if (!(value > 0) || seconds == 0 || value * seconds > kLongest)
    throw Error("--budget: found '" + text.substr(0, 80) + "', expected a time such as 60s, 5m or 1.5h");
  return Seconds(value * seconds);
}

// ---- options and frames ----

struct Task {
  std::vector<TuningFiles> files;
  std::vector<TuningFrame> frames;  // loaded from the files
  ResolvedConfig base;              // without options from a calibration
  bool names_disparities = false;   // match.num_disparities was set by the user
};

/// Whether --config or --set give the number of disparities.
bool names_disparities(const ConfigOptions& options) {
  constexpr int kOne = 17;
  constexpr int kOther = 19;
  return resolve(options, kOne).config.match.num_disparities ==
         resolve(options, kOther).config.match.num_disparities;
}

Task read_task(const TuneOptions& options) {
  Task task;
  task.base = resolve(options.input.config);
  task.names_disparities = names_disparities(options.input.config);
  if (!options.patterns.empty())
    (void)tunables(options.patterns, task.base.config);  // rejects bad names before looking at frames
  task.files = load_tuning_files(options.folders, options.input, options.truth);
  for (const TuningFiles& files : task.files) task.frames.push_back(files.frame());
  return task;
}

// ---- the search ----

using output::goal_word;
using output::Measures;
using Figure = output::TuningFigure;

/// The text next to the progress bar.
std::string words(const TuneProgress& now, const std::string& budget) {
  std::string text =
      std::to_string(now.evaluations) + " tried, " + text_of("%.0f s", now.seconds) + " of " + budget;
  if (now.best)
    text += ", " + goal_word(now.goal) + " " + percent(*now.best) + " (was " + percent(*now.before) + ")";
  return text;
}

/// Frames with the same name show one scene and are held out together.
std::size_t count_scenes(const Task& task) {
  std::set<std::string> names;
  for (const TuningFrame& frame : task.frames) names.insert(frame.name);
  return names.size();
}

Tuning tune_task(const Task& task, const TuneOptions& options, Seconds budget) {
  const double usual = count_scenes(task) >= kEnough ? kHoldout : 0;
  const TuneConfig config{options.patterns, budget.count(), options.evaluations,
                          options.holdout.value_or(usual), options.seed};
  const Progress progress(task.frames.size());
  catch_interrupts();
  Tuning tuned = tune(task.frames, config, make_exec(options.exec),
                      {is_interrupted, [&](const TuneProgress& now) {
                         progress.bar(now.share, words(now, options.budget));
                       }});
  if (tuned.before.empty())
    throw std::runtime_error("stopped before the first evaluation ended; nothing is written");
  return tuned;
}

// ---- report ----

std::string text_of(const Figure& figure) {
  return figure.is_share ? percent(figure.value) : cli::text_of("%.2f", figure.value);
}

std::string figure_table(const Tuning& tuned) {
  const auto before = output::tuning_figures(tuned.before, tuned.goal);
  const auto after = output::tuning_figures(tuned.after, tuned.goal);
  const auto held_out_before = output::tuning_figures(tuned.held_out_before, tuned.goal);
  const auto held_out_after = output::tuning_figures(tuned.held_out_after, tuned.goal);
  Table table({"", "before", "after", "held out: before", "after"});
  for (std::size_t i = 0; i < before.size(); ++i) {
    const bool known = i < held_out_before.size();
    table.add({before[i].name, text_of(before[i]), text_of(after[i]),
               known ? text_of(held_out_before[i]) : "", known ? text_of(held_out_after[i]) : ""});
  }
  return table.text();
}

std::string gain_text(const Gain& gain) {
  const auto points = [](double value) { return cli::text_of("%+.1f", 100 * value); };
  if (std::isnan(gain.mean)) return "unknown";
  if (std::isnan(gain.low)) return points(gain.mean) + " points, one frame";
  return points(gain.mean) + " points (95 %: " + points(gain.low) + " ... " + points(gain.high) + ")";
}

/// How much of the gain is overfitting: the gain on frames that were not used by the search.
std::string luck(const Tuning& tuned) {
  const Gain own = gain_of(losses_of(tuned.before), losses_of(tuned.after));
  std::string all = "gain, tuned on:  " + gain_text(own) + "\n";
  if (tuned.held_out_before.empty()) {
    return all + "gain, held out:  no frames held out (fewer than " + std::to_string(kEnough) +
           ", or --holdout 0): the share of luck is unknown\n";
  }
  const Gain fair = gain_of(losses_of(tuned.held_out_before), losses_of(tuned.held_out_after));
  all += "gain, held out:  " + gain_text(fair);
  if (!std::isnan(fair.mean) && own.mean > 0) {
    const double share = std::clamp(1 - fair.mean / own.mean, 0.0, 1.0);
    all += cli::text_of(": %.0f %% of the gain is luck", 100 * share);
    if (!(fair.low > 0)) all += ", and all of it may be";
  }
  return all + "\n";
}

std::string change_table(const SearchResult& search) {
  Table table({"option", "before", "after"});
  bool any = false;
  for (std::size_t i = 0; i < search.best.size(); ++i) {
    if (search.best[i] == search.start[i]) continue;
    table.add({search.best[i].option, search.start[i].value, search.best[i].value});
    any = true;
  }
  return any ? table.text() : "";
}

std::string plural(std::size_t count, const std::string& word) {
  return std::to_string(count) + " " + word + (count == 1 ? "" : "s");
}

std::string end_words(TuneEnd end) {
  switch (end) {
    case TuneEnd::converged:
      return "no neighbour of the best is better";
    case TuneEnd::evaluations:
      return "limit of evaluations reached";
    case TuneEnd::time:
      return "time limit reached";
    case TuneEnd::interrupted:
      return "interrupted";
  }
  return {};
}

int held_out_frames(const Tuning& tuned) {
  return static_cast<int>(std::count(tuned.held_out.begin(), tuned.held_out.end(), true));
}

std::string summary(const Task& task, const Tuning& tuned) {
  const int held = held_out_frames(tuned);
  std::string all = plural(task.frames.size(), "frame") + (tuned.sequence ? ", a sequence" : "");
  if (held > 0)
    all += ": tuned on " + std::to_string(tuned.before.size()) + ", held out " + std::to_string(held);
  all += "; " + plural(tuned.tunables.size(), "option") + ", " +
         plural(static_cast<std::size_t>(tuned.search.evaluations), "evaluation") + " in " +
         cli::text_of("%.1f s", tuned.seconds) + ": " + end_words(tuned.end) + "\n";
  if (!tuned.not_judged.empty()) {
    all +=
        "not tuned, because objects are not judged here: " + plural(tuned.not_judged.size(), "option") + "\n";
  }
  return all;
}

Config tuned_config(const Task& task, const Tuning& tuned) {
  return with_settings(task.base.config, tuned.settings());
}

std::string config_file(const Task& task, const Tuning& tuned) {
  const auto figure = [](const Measures& measures) { return percent(mean_loss(losses_of(measures))); };
  std::string head = "# Written by cairn tune: " + goal_word(tuned.goal) + " " + figure(tuned.before);
  head += tuned.kept_because.empty() ? " before, " + figure(tuned.after) + " after" : ", unchanged";
  head += ", on " + plural(tuned.before.size(), "frame") + ".\n";
  std::vector<std::string> also;
  constexpr const char* kDisparities = "match.num_disparities";
  const auto& found = tuned.settings();
  const bool tunes_disparities =
      std::any_of(found.begin(), found.end(), [&](const Setting& s) { return s.option == kDisparities; });
  if (task.names_disparities || tunes_disparities) also.emplace_back(kDisparities);
  return head + io::changed_config_yaml(task.base.preset, tuned_config(task, tuned), also);
}

std::string tuning_json(const Task& task, const Tuning& tuned, const TuneOptions& options) {
  std::vector<std::string> names;
  for (const TuningFrame& frame : task.frames) names.push_back(frame.name);
  Json j = output::json_of(tuned, names, options.seed);
  j["config"] = options.output;
  return output::json_text(j, 1) + "\n";
}

int tune_over_time(const TuneOptions& options, Seconds budget) {
  if (options.truth) throw Error("--truth: needs single frames; --sequence only uses steadiness");
  if (!options.json.empty()) throw Error("--json: not available with --sequence");
  if (options.folders.size() != 1)
    throw Error("--sequence: found " + std::to_string(options.folders.size()) + " sources, expected one");
  catch_interrupts();
  return tune_sequence(
      {options.folders.front(), options.input.calib, options.input.config, options.exec, options.patterns,
       options.evaluations, budget.count(), options.holdout, options.seed, options.output},
      is_interrupted);
}

int tune_folder(const TuneOptions& options) {
  const auto budget = parse_budget(options.budget);
  (void)wanted_target(options.exec.target);
  require_writable(options.output);
  if (!options.json.empty()) require_writable(options.json);
  if (options.sequence) return tune_over_time(options, budget);
  const Task task = read_task(options);
  const Tuning tuned = tune_task(task, options, budget);
  io::write_file(options.output, config_file(task, tuned));
  if (!options.json.empty()) io::write_file(options.json, tuning_json(task, tuned, options));
  std::cout << summary(task, tuned) << "\n" << figure_table(tuned) << "\n" << luck(tuned) << "\n";
  const std::string changes = change_table(tuned.search);
  if (!changes.empty()) std::cout << changes << "\n";
  if (!tuned.kept_because.empty()) std::cout << "The options are unchanged: " << tuned.kept_because << ".\n";
  std::cout << "wrote " << options.output << ", for --config\n";
  return 0;
}

}  // namespace

Work declare_tune(CLI::App& app) {
  auto options = std::make_shared<TuneOptions>();
  app.add_option("FOLDER", options->folders,
                 "one or more folders of frames, each a folder with left.png and right.png")
      ->required()
      ->type_name("");
  app.add_flag("--truth", options->truth,
               "minimise the paper's E against objects.png of the frames (or bad disparities against "
               "disp_left.png)");
  app.add_flag("--sequence", options->sequence,
               "FOLDER is a source of cairn follow; maximise the steadiness of its objects over time");
  app.add_option("--options", options->patterns,
                 "options to tune: names or prefixes, e.g. match.*,superpixels.*; default: a sensible "
                 "choice")
      ->type_name("NAMES")
      ->delimiter(',')
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  app.add_option("--budget", options->budget, "time limit of the search, e.g. 60s, 5m, 1h")
      ->type_name("TIME")
      ->capture_default_str();
  app.add_option("--evaluations", options->evaluations,
                 "largest number of evaluations, for reproducible results; 0 = no limit")
      ->check(CLI::Range(0, 1 << 30).name(""))
      ->type_name("N")
      ->capture_default_str();
  app.add_option("--holdout", options->holdout,
                 "share of frames held out for validation; default: 0.25 from 8 frames on, else 0")
      ->check(CLI::Range(0.0, 0.9).name(""))
      ->type_name("SHARE");
  app.add_option("--seed", options->seed, "seed for the choice of held out frames and the order of options")
      ->type_name("N")
      ->capture_default_str();
  app.add_option("--calib", options->input.calib,
                 "calibration of all frames; default: of each frame, else ../gt/calib.txt, else none")
      ->type_name("FILE");
  add_config_options(app, options->input.config);
  add_exec_options(app, options->exec);
  app.add_option("-o,--output", options->output, "file for the tuned options, for --config")
      ->type_name("FILE")
      ->capture_default_str();
  app.add_option("--json", options->json, "JSON file for the measurements")->type_name("FILE");
  app.footer(
      "Without --truth it minimises self-inconsistency: left-right disagreement, holes, grey "
      "level differences,\n"
      "and flicker in static parts of a sequence; objects are not judged.\n"
      "The search starts from --preset, --config and --set. Ctrl-C ends it and keeps the best "
      "so far.\n"
      "docs/tune.md describes the measure and what to expect.");
  return [options] { return tune_folder(*options); };
}

}  // namespace cairn::cli
