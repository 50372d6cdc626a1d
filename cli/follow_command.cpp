// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/core/error.hpp>
#include <cairn/input/camera/without_password.hpp>
#include <cairn/io/atomic_file.hpp>
#include <cairn/live/sequence_run.hpp>
#include <cairn/output/follow_files.hpp>
#include <cairn/output/follow_page.hpp>
#include <cairn/sequence/follower.hpp>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <set>

#include "commands.hpp"
#include "common.hpp"
#include "follow_options.hpp"
#include "interrupt.hpp"
#include "source_options.hpp"

namespace cairn::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

struct FollowOptions {
  SourceInput source;
  std::string odometry;
  std::string imu;
  std::string poses;
  std::string scan;
  std::string map;
  bool map_read_only = false;
  std::string start;
  ConfigOptions config;
  ExecOptions exec;
  std::string output;
  bool frames_out = false;
  bool json_lines = false;
  bool html = false;
};

/// Totals of a run, for its last line and summary.json.
struct Run {
  FollowConfig config;  // at the start
  std::vector<double> milliseconds;
  double path_m = 0;
  std::optional<Point3> place;
  std::set<std::int64_t> confirmed;
  int lost = 0;
  int keyframes = 0;
  std::map<std::string, int> refusals;
  std::vector<LandmarkEvent> events;
  int unreliable = 0;
  // For each witness and for the resulting value: sum, and number of frames where it is known.
  std::map<std::string, std::pair<double, int>> reliability;

  void add(const std::string& name, std::optional<float> share) {
    if (!share) return;
    reliability[name].first += double{*share};
    ++reliability[name].second;
  }

  void add(const TrackedFrame& step, double ms) {
    milliseconds.push_back(ms);
    if (step.is_lost) {
      ++lost;
      place.reset();
    } else {
      const Point3 now = step.map_from_camera.translation_m;
      if (place) path_m += length(now - *place);
      place = now;
    }
    if (step.reliability.is_unreliable) ++unreliable;
    add("value", step.reliability.value);
    for (const WitnessName& witness : kWitnesses)
      add(std::string(witness.name), step.reliability.witnesses.*witness.value);
    if (step.motion.is_new_keyframe) ++keyframes;
    if (step.index > 0 && step.motion.refusal != MotionRefusal::none)
      ++refusals[choice_name(step.motion.refusal, kMotionRefusals)];
    for (const Track& track : step.tracks.list) {
      if (track.state != TrackState::tentative) confirmed.insert(number(track.id));
    }
  }

  [[nodiscard]] double percentile(double share) const {
    if (milliseconds.empty()) return 0;
    std::vector<double> sorted = milliseconds;
    std::sort(sorted.begin(), sorted.end());
    return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
  }
};

Json summary_json(const Run& run, const FollowOptions& options, const io::Sequence& source,
                  const FollowConfig& config, const std::string& state) {
  Json refusals = Json::object();
  for (const auto& [reason, count] : run.refusals) refusals[reason] = count;
  Json reliability = Json::object();
  for (const auto& [name, sum] : run.reliability) reliability[name] = sum.first / sum.second;
  reliability["unreliable_frames"] = run.unreliable;
  Json remarks = Json::array();
  for (const io::SourceRemark& remark : source.remarks())
    remarks.push_back({{"what", remark.what}, {"frames", remark.count}, {"first", remark.first}});
  Json settings = Json::object();
  for (const OptionInfo& option : cairn::options(config)) {
    if (option.active) settings[option.name] = option.value;
  }
  return {{"cairn", CAIRN_VERSION},
          {"source", io::without_password(options.source.source)},
          {"stamps", source.stamps_from()},
          {"state", state},
          {"frames", run.milliseconds.size()},
          {"milliseconds", {{"median", run.percentile(0.5)}, {"p99", run.percentile(0.99)}}},
          {"path_m", run.path_m},
          {"lost_frames", run.lost},
          {"keyframes", run.keyframes},
          {"refusals", refusals},
          {"reliability", reliability},
          {"tracks", run.confirmed.size()},
          {"remarks", remarks},
          {"options", settings}};
}

std::string line_of(const TrackedFrame& step, const std::string& name) {
  const auto count = [&](auto&& which) {
    return std::count_if(step.tracks.list.begin(), step.tracks.list.end(), which);
  };
  const auto seen =
      count([](const Track& t) { return t.object != ObjectId::none && t.state != TrackState::tentative; });
  const auto moving = count([](const Track& t) {
    return t.is_moving && t.object != ObjectId::none && t.state != TrackState::tentative;
  });
  std::string line = name + ": " + std::to_string(seen) + (seen == 1 ? " track" : " tracks") + " in view";
  if (moving > 0) line += ", " + std::to_string(moving) + " moving";
  if (step.is_lost) return line + ", place not known";
  const Point3 p = step.map_from_camera.translation_m;
  line += ", at " + text_of("%.2f", p.x) + ", " + text_of("%.2f", p.y) + ", " + text_of("%.2f", p.z) + " m";
  if (step.index > 0 && step.motion.refusal != MotionRefusal::none)
    line += " (" + choice_name(step.motion.refusal, kMotionRefusals) + ")";
  return line;
}

/// "12/100 010, 41 Hz, 2 s left"
std::string progress_words(std::size_t done, std::optional<std::size_t> all, const std::string& name,
                           double seconds) {
  std::string words = std::to_string(done) + (all ? "/" + std::to_string(*all) : "") + " " + name;
  if (done == 0 || seconds <= 0) return words;
  const double rate = static_cast<double>(done) / seconds;
  words += ", " + text_of("%.1f Hz", rate);
  if (all && *all >= done) words += ", " + text_of("%.0f s left", static_cast<double>(*all - done) / rate);
  return words;
}

/// "X,Y,DEGREES" on the map's floor.
std::optional<Pose> start_in_map(const std::string& text) {
  if (text.empty()) return std::nullopt;
  double x = 0;
  double y = 0;
  double degrees = 0;
  int used = 0;
  const int read = std::sscanf(text.c_str(), "%lf,%lf,%lf%n", &x, &y, &degrees, &used);
  if (read != 3 || static_cast<std::size_t>(used) != text.size() || !std::isfinite(x + y + degrees))
    throw Error("--start " + text + ": expected X,Y,DEGREES, e.g. 0,0,0 for where the map began");
  Pose pose = rotation_about({0, 0, degrees * std::numbers::pi / 180});
  pose.translation_m = {x, y, 0};
  return pose;
}

std::optional<fs::path> named(const std::string& file) {
  return file.empty() ? std::nullopt : std::optional<fs::path>(file);
}

/// The additional inputs; rejects options that exclude each other.
io::SensorFiles companions(const FollowOptions& options, const io::Sequence& source) {
  refuse_two_priors(options.odometry, options.imu);
  if (!options.poses.empty() && !(options.odometry.empty() && options.imu.empty()))
    throw Error("--poses: already gives the motion, expected neither --odometry nor --imu");
  if (options.map_read_only && options.map.empty()) throw Error("--read-only: needs --map FILE.db");
  const std::optional<Pose> start = start_in_map(options.start);
  if (start && options.map.empty()) throw Error("--start: needs --map FILE.db");
  if (!source.rig()) {
    for (const auto& [given, name] : {std::pair{!options.map.empty(), "--map"},
                                      {!options.odometry.empty(), "--odometry"},
                                      {!options.imu.empty(), "--imu"},
                                      {!options.scan.empty(), "--scan"},
                                      {!options.poses.empty(), "--poses"}}) {
      if (given) {
        throw Error(std::string(name) + ": needs metres, but " + source.name() +
                    " has no calibration with a baseline; give one with --calib");
      }
    }
  }
  return {named(options.odometry),
          named(options.imu),
          named(options.poses),
          named(options.scan),
          named(options.map),
          options.map_read_only,
          start};
}

/// Results written next to the frames would be read as frames by the next run.
void check_output(const FollowOptions& options) {
  for (const auto& [wanted, name] :
       {std::pair{options.frames_out, "--frames-out"}, {options.html, "--html"}}) {
    if (wanted && options.output.empty())
      throw Error(std::string(name) + ": needs -o DIR, the folder for output");
  }
  std::error_code ignored;
  if (options.output.empty() || !fs::is_directory(options.source.source, ignored)) return;
  const std::string from = fs::weakly_canonical(options.source.source, ignored).string() + "/";
  const std::string into = fs::weakly_canonical(options.output, ignored).string() + "/";
  if (into.starts_with(from)) {
    throw Error("-o " + options.output +
                ": is inside the source and would be read as frames, expected another folder");
  }
}

Json event_json(const LandmarkEvent& event, const LandmarkUpdate& marked, int frame) {
  Json j{
      {"frame", frame}, {"stamp_ns", event.stamp.ns}, {"kind", choice_name(event.kind, kLandmarkEventKinds)}};
  if (event.landmark != LandmarkId::none) j["landmark"] = number(event.landmark);
  for (const LandmarkOfTrack& of : marked.tracks) {
    if (of.landmark == event.landmark && of.track != TrackId::none && event.landmark != LandmarkId::none)
      j["track"] = number(of.track);
  }
  const auto point = [](Point3 p) { return Json::array({p.x, p.y, p.z}); };
  j["to_m"] = point(event.position_m);
  if (event.kind == LandmarkEventKind::moved || event.kind == LandmarkEventKind::relocated)
    j["from_m"] = point(event.position_m - event.moved_by_m);
  j["probability"] = event.probability;
  j["frames"] = event.frames;
  return j;
}

Json control_json(const ControlEvent& event, const TrackedFrame& step) {
  return {{"frame", step.index},
          {"stamp_ns", step.stamp.ns},
          {"kind", event.is_set ? "option_set" : "option_better"},
          {"option", event.arm.option},
          {"from", event.before},
          {"to", event.arm.value},
          {"lead", event.lead}};
}

Json unreliable_json(const TrackedFrame& step) {
  return {{"frame", step.index},
          {"stamp_ns", step.stamp.ns},
          {"kind", "unreliable"},
          {"weakest", step.reliability.weakest},
          {"reliability", step.reliability.value.value_or(0)}};
}

std::string unreliable_line(const TrackedFrame& step, const std::string& name) {
  return name + ": unreliable since " + std::to_string(step.reliability.weak_frames) + " frames (" +
         text_of("%.2f", double{step.reliability.value.value_or(0)}) +
         "), weakest: " + step.reliability.weakest;
}

std::string event_line(const Json& event) {
  const std::string kind = event["kind"];
  std::string line = "  " + kind;
  if (event.contains("landmark")) line += ": landmark " + event["landmark"].dump();
  if (kind == "moved") {
    const auto& from = event["from_m"];
    const auto& to = event["to_m"];
    double square = 0;
    for (std::size_t i = 0; i < 3; ++i) square += std::pow(double{to[i]} - double{from[i]}, 2);
    line += ", by " + text_of("%.2f m", std::sqrt(square));
  }
  return line;
}

/// All output of a run.
struct Outputs {
  std::optional<io::FollowFiles> files;
  std::optional<io::FollowPage> page;

  void add_event(const Json& event) {
    if (files) files->add_event(event.dump() + "\n");
    if (page) page->add_event(event.dump());
  }
};

void tell(const TrackedFrame& step, const LandmarkUpdate& marked, const io::SequenceFrame& frame,
          const FollowOptions& options, Outputs& outputs, Run& run) {
  if (outputs.files) outputs.files->add(step, frame.name, marked, frame.frame_id);
  if (outputs.page) {
    outputs.page->add(
        io::encode_step(step, frame.name, frame.left.gray, frame.left.rgb, run.milliseconds.back(), marked));
  }
  if (options.frames_out) {
    const fs::path folder = fs::path(options.output) / frame.name;
    io::make_folder(folder);
    const Image<Rgb> drawn = io::draw_tracks(frame.left.gray, frame.left.rgb, step);
    io::save_png(folder / "tracks.png", drawn);
  }
  if (options.json_lines) {
    std::cout << io::step_json(step, frame.name, marked, frame.frame_id) << std::flush;
  } else {
    std::cout << line_of(step, frame.name) << "\n";
  }
  if (step.control) {
    outputs.add_event(control_json(*step.control, step));
    std::cerr << frame.name << ": " << control_line(*step.control) << "\n";
  }
  if (step.reliability.is_unreliable && step.reliability.weak_frames == kUnreliableFrames) {
    outputs.add_event(unreliable_json(step));
    std::cerr << unreliable_line(step, frame.name) << "\n";
  }
  for (const LandmarkEvent& event : marked.events) {
    const Json j = event_json(event, marked, step.index);
    outputs.add_event(j);
    if (!options.json_lines) std::cout << event_line(j) << "\n";
    run.events.push_back(event);
  }
}

/// Processes frames until the source ends, the user stops the run, or no reader is left.
void go_through(io::Sequence& source, io::SequenceRun& follower, const FollowOptions& options,
                Outputs& outputs, Run& run) {
  const Progress progress(source.size().value_or(0));
  const auto began = Clock::now();
  while (!is_interrupted() && std::cout) {
    const std::optional<io::SequenceFrame> frame = source.next();
    if (!frame) return;
    const std::size_t done = run.milliseconds.size();
    const auto all = static_cast<double>(std::max<std::size_t>(1, source.size().value_or(0)));
    progress.bar(source.size() ? static_cast<double>(done) / all : 0.0,
                 progress_words(done, source.size(), frame->name,
                                std::chrono::duration<double>(Clock::now() - began).count()));
    const auto start = Clock::now();
    const TrackedFrame step = follower.next(*frame);
    run.add(step, std::chrono::duration<double, std::milli>(Clock::now() - start).count());
    progress.clear();
    tell(step, follower.marked(), *frame, options, outputs, run);
  }
}

/// Closes all files however the run ends, so that finished results are kept.
void close(const std::string& state, const io::Sequence& source, io::SequenceRun& follower,
           const FollowOptions& options, Outputs& outputs, const Run& run) {
  if (outputs.page) outputs.page->finish(follower.marked().state.map);
  follower.close(state == "done" || state == "ended early" ? RunState::done : RunState::aborted);
  if (outputs.files) {
    io::write_file(fs::path(options.output) / "summary.json",
                   summary_json(run, options, source, run.config, state).dump(1) + "\n");
  }
}

/// Why a run with a map has stored no landmark; empty if it has any.
std::string no_landmark_text(const LandmarkUpdate& marked) {
  if (!marked.state.map.list.empty()) return {};
  std::string text = "no landmark stored";
  for (const auto& reason : kLandmarkRefusals) {
    const auto count = std::ranges::count(marked.tracks, reason.value, &LandmarkOfTrack::refusal);
    if (count > 0)
      text += ", " + count_of(static_cast<std::size_t>(count), "track") + ": " + std::string(reason.name);
  }
  return text + " (landmarks.min_frames and the like: cairn config --sequence)\n";
}

int follow(const FollowOptions& options) {
  check_output(options);
  const Exec exec = make_exec(options.exec);
  const auto source = open_source(options.source, exec.pool);
  const FollowConfig config = resolve_follow(options.config, source->disparities(), source->ground());
  io::SequenceRun follower(*source, options.source.source, companions(options, *source), config, exec);
  Outputs outputs;
  if (!options.output.empty()) outputs.files.emplace(options.output);
  if (options.html) {
    outputs.page.emplace(fs::path(options.output) / "follow.html",
                         io::FollowPageHead{source->name(), source->image_size(), source->rig()});
  }
  if (!source->rig()) {
    std::cerr << "cairn: " << source->name()
              << ": no calibration with a baseline: tracks in the image only, without metres and motion\n";
  }
  const EndsBySignal ends(*source);
  catch_interrupts();
  Run run;
  run.config = config;
  try {
    go_through(*source, follower, options, outputs, run);
  } catch (...) {
    close("failed", *source, follower, options, outputs, run);
    throw;
  }
  std::cerr << remarks_text(*source);
  close(is_interrupted() || !std::cout  ? "interrupted"
        : source->ended_early().empty() ? "done"
                                        : "ended early",
        *source, follower, options, outputs, run);
  std::cerr << count_of(run.milliseconds.size(), "frame") << ", " << count_of(run.confirmed.size(), "track")
            << ", " << text_of("%.2f m", run.path_m) << " of path, "
            << text_of("%.1f ms", run.percentile(0.5)) << " a frame (p99 "
            << text_of("%.1f", run.percentile(0.99)) << ")\n";
  for (const LandmarkEvent& change : changes_of(run.events))
    std::cerr << event_line(event_json(change, {}, 0)) << "\n";
  if (!options.map.empty()) std::cerr << no_landmark_text(follower.marked());
  return is_interrupted() ? kInterrupted : exit_code_of(*source);
}

}  // namespace

Work declare_follow(CLI::App& app) {
  auto options = std::make_shared<FollowOptions>();
  add_source_options(app, options->source);
  app.add_option("--odometry", options->odometry,
                 "wheel odometry: table of t_s, v_m_per_s, omega_rad_per_s, or poses of TUM or KITTI")
      ->type_name("FILE");
  app.add_option("--imu", options->imu, "gyroscope rates in the form of EuRoC")->type_name("FILE");
  app.add_option("--poses", options->poses, "known camera poses (TUM), used instead of motion estimation")
      ->type_name("FILE");
  app.add_option("--scan", options->scan,
                 "laser scans to check disparities: table of stamp, angle_min, angle_increment, r0, ...")
      ->type_name("FILE");
  app.add_option("--map", options->map, "map of landmarks to use and extend; created if absent")
      ->type_name("FILE.db");
  app.add_flag("--read-only", options->map_read_only, "no changes to the map");
  app.add_option("--start", options->start,
                 "start pose in the map, m and degrees counter-clockwise; default: found by landmarks")
      ->type_name("X,Y,DEG");
  add_config_options(app, options->config);
  add_exec_options(app, options->exec);
  app.add_option("-o,--output", options->output,
                 "output folder for tracks.jsonl, poses.tum, tracks.mots.txt, events.jsonl, summary.json")
      ->type_name("DIR");
  app.add_flag("--frames-out", options->frames_out, "one folder per frame, with tracks.png");
  app.add_flag("--html", options->html, "follow.html in DIR: a page for the browser that plays the run");
  app.add_flag("--json-lines", options->json_lines,
               "lines of tracks.jsonl on standard output instead of a summary");
  return [options] { return follow(*options); };
}

}  // namespace cairn::cli
