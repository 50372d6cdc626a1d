// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "run_files.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cairn/core/error.hpp>
#include <cairn/input/camera/without_password.hpp>
#include <cairn/io/atomic_file.hpp>
#include <filesystem>
#include <utility>

namespace cairn::cli {
namespace {

namespace fs = std::filesystem;
using output::Json;

}  // namespace

void add_run_files_options(CLI::App& app, RunFilesOptions& options) {
  app.add_option("-o,--output", options.output,
                 "output folder for tracks.jsonl, poses.tum, tracks.mots.txt, events.jsonl, summary.json")
      ->type_name("DIR");
  app.add_flag("--frames-out", options.frames_out, "one folder per frame, with tracks.png");
  app.add_flag("--html", options.html, "follow.html in DIR: a page for the browser that plays the run");
}

void check(const RunFilesOptions& options, const std::string& source) {
  for (const auto& [wanted, name] :
       {std::pair{options.frames_out, "--frames-out"}, {options.html, "--html"}}) {
    if (wanted && options.output.empty())
      throw Error(std::string(name) + ": needs -o DIR, the folder for output");
  }
  std::error_code ignored;
  if (options.output.empty() || !fs::is_directory(source, ignored)) return;
  const std::string from = fs::weakly_canonical(source, ignored).string() + "/";
  const std::string into = fs::weakly_canonical(options.output, ignored).string() + "/";
  if (into.starts_with(from)) {
    throw Error("-o " + options.output +
                ": is inside the source and would be read as frames, expected another folder");
  }
}

// ---- totals ----

void RunTotals::add(const std::string& name, std::optional<float> share) {
  if (!share) return;
  reliability[name].first += double{*share};
  ++reliability[name].second;
}

void RunTotals::add(const live::LiveFrame& frame) {
  const TrackedFrame& step = frame.step;
  milliseconds.push_back(live::ms_between(frame.started, frame.done));
  if (step.is_lost) {
    ++lost;
    place_.reset();
  } else {
    const Point3 now = step.map_from_camera.translation_m;
    if (place_) path_m += length(now - *place_);
    place_ = now;
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
  events.insert(events.end(), frame.events.begin(), frame.events.end());
}

double RunTotals::percentile(double share) const {
  if (milliseconds.empty()) return 0;
  std::vector<double> sorted = milliseconds;
  std::sort(sorted.begin(), sorted.end());
  return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
}

// ---- files ----

RunFiles::RunFiles(RunFilesOptions options, live::MessageForm form, const live::Runner& runner,
                   const input::Sequence& source, std::string source_name, FollowConfig config)
    : options_(std::move(options)),
      form_(std::move(form)),
      runner_(runner),
      source_(source),
      source_name_(std::move(source_name)),
      config_(std::move(config)) {
  if (!options_.output.empty()) files_.emplace(options_.output);
  if (options_.html) {
    page_.emplace(fs::path(options_.output) / "follow.html",
                  output::FollowPageHead{source.name(), source.image_size(), source.rig()});
  }
}

void RunFiles::offer(const live::LiveFramePtr& frame) {
  totals_.add(*frame);
  device_ = frame->device;
  if (!files_) return;
  const TrackedFrame& step = frame->step;
  const io::LoadedImage& left = frame->pair->left;
  files_->add(step, *text_of(*frame, form_));
  if (page_) {
    page_->add(output::encode_step(*results_of(*frame, form_), step, left.gray, left.rgb,
                                   totals_.milliseconds.back(), frame->map_from_odom));
  }
  if (options_.frames_out) {
    const fs::path folder = fs::path(options_.output) / frame->pair->name;
    io::make_folder(folder);
    const Image<Rgb> drawn = output::draw_tracks(left.gray, left.rgb, step);
    io::save_png(folder / "tracks.png", drawn);
  }
  for (const Json& event : output::event_lines(step, frame->landmarks, frame->events, frame->changes)) {
    const std::string line = output::json_text(event);
    files_->add_event(line + "\n");
    if (page_) page_->add_event(line);
  }
}

std::string RunFiles::state() const {
  if (runner_.has_failed()) return "failed";
  if (runner_.was_ended()) return "interrupted";
  return source_.ended_early().empty() ? "done" : "ended early";
}

Json RunFiles::summary_json() const {
  Json refusals = Json::object();
  for (const auto& [reason, count] : totals_.refusals) refusals[reason] = count;
  Json reliability = Json::object();
  for (const auto& [name, sum] : totals_.reliability) reliability[name] = sum.first / sum.second;
  // Without objects nothing has shown that they would be found. (docs/stages/reliability.md)
  if (totals_.confirmed.empty()) reliability.erase("value");
  reliability["unreliable_frames"] = totals_.unreliable;
  Json remarks = Json::array();
  for (const input::SourceRemark& remark : source_.remarks())
    remarks.push_back({{"what", remark.what}, {"frames", remark.count}, {"first", remark.first}});
  Json settings = Json::object();
  for (const OptionInfo& option : cairn::options(config_)) {
    if (option.active) settings[option.name] = option.value;
  }
  Json all{{"cairn", CAIRN_VERSION},
           {"source", input::without_password(source_name_)},
           {"stamps", source_.stamps_from()},
           {"state", state()},
           {"frames", totals_.milliseconds.size()},
           {"milliseconds", {{"median", totals_.percentile(0.5)}, {"p99", totals_.percentile(0.99)}}},
           {"path_m", totals_.path_m},
           {"lost_frames", totals_.lost},
           {"keyframes", totals_.keyframes},
           {"refusals", refusals},
           {"reliability", reliability},
           {"tracks", totals_.confirmed.size()},
           {"remarks", remarks},
           {"options", settings}};
  if (device_) all["device"] = output::json_of(*device_);
  return all;
}

void RunFiles::finish() {
  if (page_) page_->finish(runner_.marked().state.map);
  if (files_)
    io::write_file(fs::path(options_.output) / "summary.json", output::json_text(summary_json(), 1) + "\n");
}

}  // namespace cairn::cli
