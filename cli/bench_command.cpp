// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cairn/core/error.hpp>
#include <cairn/core/statistics.hpp>
#include <cairn/core/target.hpp>
#include <cairn/evaluation/disparity_error.hpp>
#include <cairn/io/atomic_file.hpp>
#include <cairn/io/dataset.hpp>
#include <cairn/io/disparity_files.hpp>
#include <cairn/io/image_files.hpp>
#include <cairn/output/json.hpp>
#include <cairn/stereo/match_device.hpp>
#include <cairn/timing/drawn_pair.hpp>
#include <cairn/timing/frame_times.hpp>
#include <cairn/timing/machine.hpp>
#include <cairn/timing/opencv_matchers.hpp>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <iostream>

#include "bench_budget.hpp"
#include "commands.hpp"
#include "common.hpp"
#include "terminal.hpp"

namespace cairn::cli {
namespace {

namespace fs = std::filesystem;
using output::Json;
using timing::FrameTimes;
using timing::Samples;

struct BenchOptions {
  InputOptions input;
  ExecOptions exec;
  std::optional<std::string> size;  // of the rendered pair
  std::string truth;
  std::optional<int> frames;
  std::optional<double> seconds;
  bool no_opencv = false;
  std::optional<std::string> json;
  std::optional<double> budget_hz;
  std::optional<std::string> report;
  bool has_preset = false;  // on the command line or in --config
};

// ---- the input ----

/// The known truth of the pair.
struct Truth {
  std::string source;
  Image<float> disparity_px;
  Image<std::uint8_t> hidden;  // empty if unknown
};

struct Subject {
  std::string name;
  bool drawn = false;
  io::LoadedImage left;
  Image<Gray> right;
  std::optional<StereoRig> rig;
  Config config;
  std::string preset;
  std::optional<Truth> truth;

  [[nodiscard]] StereoPair pair() const { return StereoPair::from(left.gray, right, left.rgb); }
};

Size size_in(const std::string& words) {
  constexpr int kMin = 16;
  constexpr int kMax = 8192;
  Size size;
  const char* const end = words.data() + words.size();
  const auto [cross, bad_width] = std::from_chars(words.data(), end, size.width);
  bool good = bad_width == std::errc() && cross != end && *cross == 'x';
  if (good) {
    const auto [rest, bad_height] = std::from_chars(cross + 1, end, size.height);
    good = bad_height == std::errc() && rest == end;
  }
  good = good && std::min(size.width, size.height) >= kMin && std::max(size.width, size.height) <= kMax;
  if (!good) {
    throw Error("--size " + words + ": expected WIDTHxHEIGHT, e.g. 640x480, each side from " +
                std::to_string(kMin) + " to " + std::to_string(kMax));
  }
  return size;
}

Size size_of(const BenchOptions& options) {
  return options.size ? size_in(*options.size) : Size{640, 480};
}

void refuse_what_needs_a_pair(const BenchOptions& options) {
  if (!options.truth.empty())
    throw Error("--truth " + options.truth + ": applies to your own pair only; give LEFT and RIGHT");
  if (!options.input.calib.empty())
    throw Error("--calib " + options.input.calib + ": applies to your own pair only; give LEFT and RIGHT");
}

Subject draw(const BenchOptions& options) {
  refuse_what_needs_a_pair(options);
  const Size size = size_of(options);
  ResolvedConfig resolved = resolve(options.input.config);
  timing::DrawnPair drawn = timing::draw_pair(size, resolved.config.match);
  Subject subject;
  subject.name = "rendered room";
  subject.drawn = true;
  subject.left = {std::move(drawn.left), std::move(drawn.left_rgb)};
  subject.right = std::move(drawn.right);
  subject.rig = drawn.rig;
  subject.config = std::move(resolved.config);
  subject.preset = std::move(resolved.preset);
  subject.truth = Truth{"rendered with the pair", std::move(drawn.disparity_px), std::move(drawn.hidden)};
  return subject;
}

Truth load_truth(const std::string& name, Size size) {
  std::error_code ignored;
  fs::path disparity = name;
  std::optional<fs::path> occlusion;
  if (fs::is_directory(disparity, ignored)) {
    const io::TruthFiles files = io::find_truth(disparity);
    if (!files.disparity) throw Error(name + ": has no disp_left.png or disp_left.pfm");
    disparity = *files.disparity;
    occlusion = files.occlusion;
  }
  const auto require_size = [&](const fs::path& file, Size found) {
    if (found == size) return;
    throw Error(file.string() + ": is " + text(found) + ", the pair is " + text(size));
  };
  Truth truth{disparity.string(), io::load_disparity(disparity), {}};
  require_size(disparity, truth.disparity_px.size());
  if (!occlusion) return truth;
  truth.hidden = io::load_hidden(*occlusion);
  require_size(*occlusion, truth.hidden.size());
  return truth;
}

Subject load(const BenchOptions& options, const Exec& exec) {
  if (options.size) {
    throw Error("--size " + *options.size +
                ": is for the pair that the program draws; leave LEFT and RIGHT out");
  }
  const std::vector<io::FrameFiles> frames = frames_of(options.input);
  if (frames.size() != 1) {
    throw Error(options.input.left + ": holds " + std::to_string(frames.size()) +
                " frames; cairn bench takes one");
  }
  LoadedFrame loaded = load_frame(frames.front(), options.input, exec);
  Subject subject;
  subject.name = frames.front().left.string();
  subject.left = std::move(loaded.left);
  subject.right = std::move(loaded.right);
  subject.rig = loaded.rig;
  subject.config = std::move(loaded.config);
  subject.preset = std::move(loaded.preset);
  if (!options.truth.empty()) subject.truth = load_truth(options.truth, subject.left.gray.size());
  return subject;
}

timing::Limits limits_of(const BenchOptions& options, const timing::Limits& by_default) {
  if (!options.frames && !options.seconds) return by_default;
  timing::Limits limits;
  if (options.frames) limits.frames = *options.frames;
  if (options.seconds) limits.seconds = *options.seconds;
  return limits;
}

// ---- results ----

struct Quantiles {
  double least = 0;
  double median = 0;
  double p99 = 0;
};

Quantiles quantiles(const std::vector<double>& values) {
  return {percentile(values, 0), percentile(values, 0.5), percentile(values, 0.99)};
}

double median_wall(const Samples& samples) {
  return percentile(samples.wall_ms, 0.5);
}

struct Accuracy {
  std::string name;
  DisparityErrors errors;
};

/// Our row first. Columns that some matcher cannot search in full are excluded for all.
struct Accuracies {
  int from_column = 0;
  std::vector<Accuracy> rows;
};

std::optional<Accuracies> accuracies_of(const Subject& subject, const FrameTimes& times) {
  if (!subject.truth) return std::nullopt;
  const MatchConfig& match = subject.config.match;
  Accuracies all;
  const int searched =
      times.peers.empty() ? match.num_disparities : timing::searched_by_opencv(match.num_disparities);
  all.from_column = std::max(0, match.min_disparity + searched);
  const auto add = [&](std::string name, View<const float> disparity_px) {
    all.rows.push_back({std::move(name), disparity_errors(disparity_px, subject.truth->disparity_px,
                                                          subject.truth->hidden, all.from_column)});
  };
  add("cairn", times.disparity_px);
  for (const timing::PeerTimes& peer : times.peers) {
    if (peer.refusal.empty()) add(std::string(peer.matcher->name), peer.disparity_px);
  }
  return all;
}

struct Findings {
  Subject subject;
  Exec exec;
  FrameTimes times;
  std::optional<Accuracies> accuracies;
};

// ---- text ----

std::string ms(double milliseconds) {
  return text_of("%.3f", milliseconds);
}

std::string heading(const Findings& found) {
  const Subject& subject = found.subject;
  const int threads = found.exec.threads();
  std::string supported;
  for (const Target target : supported_targets()) supported += " " + std::string(name(target));
  return "pair        " + subject.name + ", " + text(subject.left.gray.size()) + ", " +
         std::to_string(subject.config.match.num_disparities) + " disparities\n" + "method      preset " +
         subject.preset + ", " + std::to_string(threads) + (threads == 1 ? " thread, " : " threads, ") +
         std::string(name(active_target(found.exec))) + " (supported:" + supported + ")\n" + "measured    " +
         std::to_string(found.times.frames()) + (found.times.frames() == 1 ? " frame" : " frames") +
         " after a warm-up frame of " + text_of("%.1f ms", found.times.first_frame_ms) + ", on " +
         timing::processor() + "\n";
}

std::string stage_table(const FrameTimes& times) {
  const double frame_ms = median_wall(times.frame);
  Table table({"stage", "median ms", "p99 ms", "CPU ms", "share"});
  const auto add = [&](const std::string& stage, const Samples& samples) {
    const Quantiles wall = quantiles(samples.wall_ms);
    table.add({stage, ms(wall.median), ms(wall.p99), ms(quantiles(samples.cpu_ms).median),
               percent(wall.median / frame_ms)});
  };
  for (const timing::StageTimes& stage : times.stages) add(stage.name, stage.times);
  add("disparity stages", times.disparity);
  add("frame", times.frame);
  return table.text();
}

std::string summary(const Findings& found) {
  const FrameTimes& times = found.times;
  const auto megabytes = [](std::int64_t bytes) {
    return text_of("%.1f MB", 1e-6 * static_cast<double>(bytes));
  };
  const std::string overlapping =
      times.overlapping_ms > 0 ? text_of("; %.1f if they overlap, with ", 1000 / times.overlapping_ms) +
                                     megabytes(times.overlapping_pool_bytes) + " for images"
                               : "";
  return "speed       " + text_of("%.1f frames per second", 1000 / median_wall(times.frame)) + overlapping +
         "; " + std::to_string(times.objects) + " objects\n" + "memory      " + megabytes(times.pool_bytes) +
         " peak for images, " + megabytes(found.times.resident_bytes) + " for the whole process; " +
         std::to_string(times.first_allocations) + " image buffers allocated in the first frame, " +
         std::to_string(times.later_allocations) + " in later ones\n";
}

/// What the device did, in the mean of its pairs. Bytes are counted as if nothing were cached.
std::string device_table(const Exec& exec) {
  if (!exec.device) return {};
  const DeviceReport report = exec.device->report();
  std::string heading = "device " + report.name + ": " + std::to_string(report.on_device) + " pairs, " +
                        text_of("%.1f MB", 1e-6 * static_cast<double>(report.memory_bytes));
  if (!report.reason.empty())
    heading += "; " + std::to_string(report.on_processor) + " on the processor: " + report.reason;
  Table table({"kernel", "ms a pair", "MB", "dispatches"});
  const auto pairs = static_cast<double>(std::max<std::int64_t>(1, report.on_device));
  for (const DeviceKernel& one : report.kernels) {
    table.add({one.name, text_of("%.3f", one.ms / pairs),
               text_of("%.1f", 1e-6 * static_cast<double>(one.bytes) / pairs),
               text_of("%.0f", static_cast<double>(one.dispatches) / pairs)});
  }
  return "\n" + heading + "\n" + (report.on_device > 0 ? table.text() : "");
}

std::string peer_table(const Findings& found) {
  if (timing::quick_opencv_matchers().empty()) return "OpenCV's matchers are not built in.\n";
  const FrameTimes& times = found.times;
  if (times.peers.empty()) return {};
  Table table({"OpenCV " + std::string(timing::opencv_version()), "median ms", "p99 ms", "CPU ms",
               "our disparity", "our frame"});
  const auto ratio = [](const Samples& ours, const Samples& theirs) {
    return text_of("x %.2f", median_wall(ours) / median_wall(theirs));
  };
  std::string refusals;
  bool some = false;
  for (const timing::PeerTimes& peer : times.peers) {
    const std::string name(peer.matcher->name);
    if (!peer.refusal.empty()) {
      refusals += name + " cannot match this pair: " + peer.refusal + "\n";
      continue;
    }
    some = true;
    const Quantiles wall = quantiles(peer.times.wall_ms);
    table.add({name, ms(wall.median), ms(wall.p99), ms(quantiles(peer.times.cpu_ms).median),
               ratio(times.disparity, peer.times), ratio(times.frame, peer.times)});
  }
  if (!some) return refusals;
  return table.text() + refusals +
         "Each ran once after each of our frames, with the same number of threads; x: our time divided by "
         "theirs.\n";
}

std::string accuracy_table(const Findings& found) {
  if (!found.accuracies) return {};
  constexpr std::size_t kBad1 = 1;
  constexpr std::size_t kBad2 = 2;
  Table table({"accuracy", "bad-1", "bad-2", "density"});
  for (const Accuracy& row : found.accuracies->rows) {
    table.add({row.name, percent(row.errors.bad_of_matched(kBad1)), percent(row.errors.bad_of_matched(kBad2)),
               percent(row.errors.density())});
  }
  const Truth& truth = *found.subject.truth;
  return "\n" + table.text() + "Truth: " + truth.source +
         (truth.hidden.empty() ? ", all pixels" : ", pixels visible to both cameras") + ", from column " +
         std::to_string(found.accuracies->from_column) +
         " on; bad-1, bad-2: share of the matched pixels with an error above 1 or 2 px.\n";
}

// ---- JSON ----

/// ms rounded to ns, the clock's resolution.
Json json(double value) {
  return output::rounded(value);
}

Json json(const std::vector<double>& milliseconds) {
  const Quantiles q = quantiles(milliseconds);
  return {{"median", json(q.median)}, {"p99", json(q.p99)}, {"least", json(q.least)}};
}

Json json(const Samples& samples) {
  return {{"wall_ms", json(samples.wall_ms)}, {"cpu_ms", json(samples.cpu_ms)}};
}

Json stages_json(const FrameTimes& times) {
  Json all = Json::array();
  for (const timing::StageTimes& stage : times.stages) {
    Json j{{"name", stage.name}, {"for_disparity", stage.for_disparity}};
    j.update(json(stage.times));
    all.push_back(std::move(j));
  }
  return all;
}

Json opencv_json(const Findings& found) {
  if (found.times.peers.empty()) return nullptr;
  Json matchers = Json::array();
  for (const timing::PeerTimes& peer : found.times.peers) {
    const bool ran = peer.refusal.empty();
    Json j{{"name", peer.matcher->name},
           {"settings", peer.matcher->settings},
           {"refusal", ran ? Json(nullptr) : Json(peer.refusal)}};
    j.update(ran ? json(peer.times) : Json{{"wall_ms", nullptr}, {"cpu_ms", nullptr}});
    matchers.push_back(std::move(j));
  }
  return {{"version", timing::opencv_version()}, {"matchers", matchers}};
}

Json accuracy_json(const Findings& found) {
  if (!found.accuracies) return nullptr;
  Json rows = Json::array();
  for (const Accuracy& row : found.accuracies->rows) {
    Json j{{"name", row.name}, {"known_px", row.errors.known}, {"density", json(row.errors.density())}};
    for (std::size_t t = 0; t < kBadThresholdsPx.size(); ++t) {
      const std::string threshold = text_of("%g", double(kBadThresholdsPx[t]));
      j["bad_of_matched"][threshold] = json(row.errors.bad_of_matched(t));
    }
    rows.push_back(std::move(j));
  }
  const Truth& truth = *found.subject.truth;
  return {{"truth", truth.source},
          {"both_cameras", !truth.hidden.empty()},
          {"from_column", found.accuracies->from_column},
          {"matchers", rows}};
}

/// The content of the --json file (docs/formats.md).
Json bench_json(const Findings& found) {
  const Subject& subject = found.subject;
  const FrameTimes& times = found.times;
  Json targets = Json::array();
  for (const Target target : supported_targets()) targets.push_back(std::string(name(target)));
  Json j;
  j["cairn"] = CAIRN_VERSION;
  j["pair"] = {{"name", subject.name},
               {"drawn", subject.drawn},
               {"width", subject.left.gray.width()},
               {"height", subject.left.gray.height()},
               {"colour", !subject.left.rgb.empty()},
               {"calibrated", subject.rig.has_value()}};
  j["preset"] = subject.preset;
  j["config"] = output::json_of(subject.config);
  j["machine"] = {{"processor", timing::processor()},
                  {"compiler", timing::compiler()},
                  {"threads", found.exec.threads()},
                  {"target", std::string(name(active_target(found.exec)))},
                  {"supported_targets", targets}};
  j["frames"] = times.frames();
  j["first_frame_ms"] = json(times.first_frame_ms);
  j["stages"] = stages_json(times);
  j["disparity"] = json(times.disparity);
  j["frame"] = json(times.frame);
  j["frames_per_second"] = json(1000 / median_wall(times.frame));
  if (times.overlapping_ms > 0) {
    j["overlapping"] = {{"frames_per_second", json(1000 / times.overlapping_ms)},
                        {"pool_bytes", times.overlapping_pool_bytes}};
  }
  j["objects"] = times.objects;
  j["memory"] = {{"pool_bytes", times.pool_bytes},
                 {"resident_bytes", found.times.resident_bytes},
                 {"first_frame_allocations", times.first_allocations},
                 {"later_allocations", times.later_allocations}};
  if (found.exec.device) j["device"] = output::json_of(found.exec.device->report());
  j["opencv"] = opencv_json(found);
  j["accuracy"] = accuracy_json(found);
  return j;
}

void write_json(const std::string& file, const Json& json) {
  // A file name that is not UTF-8 is not an error.
  io::write_file(file, output::json_text(json, 1) + "\n");
}

Findings measured(Subject subject, const Exec& exec, const timing::Limits& limits, bool has_opencv) {
  timing::set_opencv_threads(exec.threads());
  const auto peers = has_opencv ? timing::quick_opencv_matchers() : std::span<const timing::OpenCvMatcher>();
  Findings found{std::move(subject), exec, {}, {}};
  found.times =
      timing::time_frames(found.subject.pair(), found.subject.rig, found.subject.config, exec, limits, peers);
  found.accuracies = accuracies_of(found.subject, found.times);
  return found;
}

// ---- other measurements ----

/// Both presets at three usual sizes, with one thread and with all.
int report_machine(BenchOptions options) {
  struct Run {
    const char* size;
    const char* disparities;
  };
  constexpr std::array kRuns{Run{"320x240", "64"}, Run{"640x480", "64"}, Run{"1280x720", "128"}};
  constexpr timing::Limits kOfARun{.frames = 100, .seconds = 4};
  const Exec wanted = make_exec(options.exec);
  std::vector<int> thread_counts{1};
  if (wanted.threads() > 1) thread_counts.push_back(wanted.threads());
  Table table({"preset", "size", "threads", "median ms", "p99 ms", "overlapping", "images"});
  Json runs = Json::array();
  for (const auto& [size, disparities] : kRuns) {
    for (const char* const preset : {"default", "paper"}) {
      options.size = size;
      options.input.config.preset = preset;
      options.input.config.sets = {std::string("match.num_disparities=") + disparities};
      for (const int threads : thread_counts) {
        Exec exec = Exec::with_threads(threads, wanted.target);
        exec.device = wanted.device;
        const Findings found = measured(draw(options), exec, limits_of(options, kOfARun), !options.no_opencv);
        const Quantiles wall = quantiles(found.times.frame.wall_ms);
        table.add({preset, std::string(size) + "x" + disparities, std::to_string(threads), ms(wall.median),
                   ms(wall.p99), found.times.overlapping_ms > 0 ? ms(found.times.overlapping_ms) : "",
                   text_of("%.0f MB", 1e-6 * static_cast<double>(found.times.pool_bytes))});
        runs.push_back(bench_json(found));
      }
    }
  }
  write_json(*options.report, {{"cairn", CAIRN_VERSION}, {"processor", timing::processor()}, {"runs", runs}});
  std::cout << table.text()
            << "\noverlapping: ms per frame where each is begun during the one before, as follow does.\n"
            << *options.report
            << ": attach it to an issue; it holds times, the processor's name and nothing else of "
            << "this machine.\n";
  return 0;
}

int report_budget(const BenchOptions& options, const Exec& exec) {
  constexpr timing::Limits kOfATrial{.frames = 100, .seconds = 2};
  Budget budget{*options.budget_hz, size_of(options), {"default", "paper"}, limits_of(options, kOfATrial)};
  if (options.has_preset) budget.presets = {options.input.config.preset};
  const BudgetReport report = sizes_within_budget(budget, options.input.config, exec);
  if (options.json) write_json(*options.json, report.json);
  std::cout << report.text;
  return 0;
}

int bench(const BenchOptions& options, bool drawn) {
  (void)resolve(options.input.config);
  if (options.budget_hz || options.report) {
    const std::string option = options.report ? "--report" : "--budget";
    if (!drawn) throw Error(option + ": is for the pair that the program draws; leave LEFT and RIGHT out");
    refuse_what_needs_a_pair(options);
  }
  if (options.report) {
    if (options.has_preset || !options.input.config.sets.empty())
      throw Error("--report: measures both presets as they are; leave --preset, --config and --set out");
    return report_machine(options);
  }
  const Exec exec = make_exec(options.exec);
  if (options.budget_hz) return report_budget(options, exec);
  constexpr timing::Limits kByDefault{.frames = 100, .seconds = 10};
  const Findings found = measured(drawn ? draw(options) : load(options, exec), exec,
                                  limits_of(options, kByDefault), !options.no_opencv);
  if (options.json) write_json(*options.json, bench_json(found));
  std::cout << heading(found) << "\n" << stage_table(found.times) << "\n" << summary(found);
  std::cout << device_table(exec);
  if (!options.no_opencv) std::cout << "\n" << peer_table(found);
  std::cout << accuracy_table(found);
  return 0;
}

}  // namespace

Work declare_bench(CLI::App& app) {
  constexpr int kMaxFrames = 1'000'000;
  constexpr double kMaxSeconds = 86'400;
  auto options = std::make_shared<BenchOptions>();
  add_input_options(app, options->input);
  app.get_option("LEFT")->required(false);
  app.add_option("--size", options->size, "size of the rendered pair if LEFT is not given; default: 640x480")
      ->type_name("WxH");
  add_exec_options(app, options->exec);
  add_device_option(app, options->exec);
  app.add_option("--frames", options->frames, "frames to time after one warm-up frame")
      ->check(CLI::Range(1, kMaxFrames).name(""))
      ->type_name("N");
  app.add_option("--seconds", options->seconds, "time limit; at least three frames are timed")
      ->check(CLI::Range(0.0, kMaxSeconds).name(""))
      ->type_name("S");
  app.add_option("--truth", options->truth,
                 "true disparity of the left image (.png, .pfm), or a folder with disp_left and optionally "
                 "occlusion.png, to report accuracy")
      ->type_name("PATH");
  app.add_flag("--no-opencv", options->no_opencv, "no comparison with OpenCV's matchers");
  app.add_option("--budget", options->budget_hz,
                 "find the sizes at which each preset reaches this rate on this machine")
      ->check(CLI::Range(0.01, 10'000.0).name(""))
      ->type_name("HZ");
  CLI::Option* const budget = app.get_option("--budget");
  app.add_option(
         "--report", options->report,
         "time both presets at three sizes, with one thread and with all, and write the measurements of this "
         "machine to a JSON file that you can mail")
      ->excludes(budget)
      ->excludes(app.get_option("--size"))
      ->type_name("FILE");
  app.add_option("--json", options->json, "JSON file for all measurements")
      ->excludes(app.get_option("--report"))
      ->type_name("FILE");
  app.footer(
      "Without LEFT and RIGHT a room is rendered: the same pixels on every machine.\n"
      "Without --frames and --seconds: 100 frames, or as many as fit in 10 seconds.\n"
      "Times are wall-clock times; `CPU ms` is the processor time of all threads together.");
  return [options, &app] {
    options->has_preset = app.count("--preset") > 0 || !options->input.config.file.empty();
    return bench(*options, app.count("LEFT") == 0);
  };
}

}  // namespace cairn::cli
