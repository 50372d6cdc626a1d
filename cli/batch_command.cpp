// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cairn/batch/shard.hpp>
#include <cairn/batch/summary.hpp>
#include <cairn/batch/zstd_packer.hpp>
#include <cairn/core/error.hpp>
#include <cairn/io/atomic_file.hpp>
#include <cairn/io/config_files.hpp>
#include <cmath>
#include <iostream>
#include <string_view>
#include <utility>

#include "batch_frames.hpp"
#include "commands.hpp"
#include "common.hpp"
#include "findings.hpp"
#include "terminal.hpp"

namespace cairn::cli {
namespace {

namespace fs = std::filesystem;

struct BatchOptions {
  std::string action;
  std::vector<std::string> paths;  // the inputs of plan, else the run
  BatchInputs inputs;
  ConfigOptions config;
  std::string output;
  std::string shard;
  bool keep = false;
  bool partial = false;
  ExecOptions exec;
};

const std::string& run_folder(const BatchOptions& options) {
  if (options.paths.size() == 1) return options.paths.front();
  throw Error(options.action + ": found " + std::to_string(options.paths.size()) +
              " folders, expected one, written by cairn batch plan -o");
}

std::string count_of(std::size_t count, const char* thing) {
  return std::to_string(count) + " " + thing + (count == 1 ? "" : "s");
}

std::string duration_text(double seconds) {
  if (seconds < 120) return text_of("%.0f s", seconds);
  if (seconds < 7200) return text_of("%.0f min", seconds / 60);
  return text_of("%.1f h", seconds / 3600);
}

int plan(const BatchOptions& options) {
  if (options.output.empty()) throw Error("-o: missing, expected the folder for the run");
  BatchInputs inputs = options.inputs;
  inputs.paths = options.paths;
  const Pool pool = Pool::make();
  const std::string config =
      inputs.tracks ? config_of_tracked_run(options.config) : config_of_run(options.config);
  const auto [frames, sequences] = planned_frames(inputs, pool);
  const batch::PlanResult planned = batch::plan(options.output, frames, sequences, config);
  std::cout << (planned.was_there ? "already planned: " : "planned: ")
            << count_of(planned.run.frames, "frame") << " of " << count_of(inputs.paths.size(), "input")
            << ", run " << planned.run.id.substr(0, 12) << " in " << options.output << "\n";
  return 0;
}

batch::Shard shard_of(const BatchOptions& options) {
  if (!options.shard.empty()) return batch::parse_shard(options.shard);
  return batch::shard_of_slurm().value_or(batch::Shard{});
}

/// Converts planned frames to rows.
class RowMaker {
 public:
  RowMaker(const batch::Run& run, const BatchOptions& options)
      : exec_(make_exec(options.exec)),
        reader_({"default", run.config().string(), {}}, exec_),
        kept_(options.keep ? run.folder / "frames" : fs::path()) {
    if (run.sequences.empty()) return;
    if (options.keep) throw Error("--keep: the run has --tracks, expected a run without");
    tracks_.emplace(ConfigOptions{"default", run.config().string(), {}}, exec_);
  }

  std::string operator()(const batch::PlannedFrame& planned) {
    reader_.check(planned);
    if (tracks_) return tracks_->row(planned, news_);
    BatchFrame read;
    Frame frame;
    try {
      read = reader_.read(planned);
      frame = segment_frame(read.loaded, exec_);
    } catch (const Error& error) {
      return batch::error_row(planned.name, error.what());
    }
    const LoadedFrame& loaded = read.loaded;
    news_ += changes_text(
        planned.name, watch_.next(frame, loaded.left.gray, loaded.right, loaded.rig, loaded.config, exec_));
    const output::Provenance provenance{loaded.preset, loaded.config, loaded.rig, {}, false, read.stamp_ns};
    if (!kept_.empty())
      output::write_result(kept_ / planned.name, loaded.left.gray, loaded.left.rgb, frame, provenance);
    return output::frame_row(planned.name, frame, provenance);
  }

  /// What was found about the rigs since the last call: lines for stderr.
  std::string news() { return std::exchange(news_, {}); }

 private:
  Exec exec_;
  BatchReader reader_;
  RigWatch watch_;
  std::string news_;
  std::optional<TrackRows> tracks_;
  fs::path kept_;
};

int work(const BatchOptions& options) {
  const batch::Run run = batch::open_run(run_folder(options));
  const batch::Shard shard = shard_of(options);
  batch::check_unchanged(run);
  RowMaker make_row(run, options);
  const batch::FrameSpan span = batch::span_of(shard, run);
  const Progress progress(span.end - span.begin);
  const batch::WorkResult worked = batch::work_on(
      run, shard,
      [&](const batch::PlannedFrame& frame) {
        std::string row = make_row(frame);
        if (const std::string news = make_row.news(); !news.empty()) {
          progress.clear();
          std::cerr << news;
        }
        return row;
      },
      [&](std::size_t place, std::size_t, const std::string& name) { progress.at(place, name); },
      [&](const std::string& whom) {
        std::cerr << "cairn: shard " << batch::text(shard) << ": waits for " << whom
                  << ", which works on it\n";
      });
  progress.clear();
  std::cout << "shard " << batch::text(shard) << ": " << count_of(worked.frames, "frame");
  if (worked.was_done) std::cout << ", done before";
  if (worked.resumed > 0) std::cout << ", " << worked.resumed << " of them by a worker before";
  if (worked.errors > 0) std::cout << ", " << worked.errors << " with an error instead of objects";
  std::cout << "\n";
  return 0;
}

std::string worker_text(const batch::ShardStatus& status) {
  const auto& worker = status.worker;
  if (!worker) return {};
  const double age = std::max(0.0, static_cast<double>(std::time(nullptr)) - worker->note.updated_s);
  std::string text = worker->note.host + ", process " + std::to_string(worker->note.pid);
  return text + ", " + duration_text(age) + " ago";
}

int status(const BatchOptions& options) {
  const batch::Run run = batch::open_run(run_folder(options));
  const batch::Status all = batch::status_of(run);
  std::cout << "run " << run.id.substr(0, 12) << ": " << all.frames_done << " of "
            << count_of(run.frames, "frame") << " done ("
            << percent(static_cast<double>(all.frames_done) / static_cast<double>(run.frames)) << "), "
            << count_of(all.errors, "error");
  if (all.seconds_left && all.frames_done < run.frames)
    std::cout << ", about " << duration_text(std::ceil(*all.seconds_left)) << " left";
  std::cout << "\n";
  Table table({"shard", "state", "frames", "errors", "worker"});
  std::size_t done = 0;
  for (const batch::ShardStatus& status : all.shards) {
    done += status.is_done ? 1 : 0;
    if (status.is_done) continue;  // there may be thousands
    const bool is_running = status.worker && status.worker->is_held;
    const std::size_t frames = status.span.end - status.span.begin;
    table.add({batch::text(status.shard), is_running ? "running" : "interrupted",
               std::to_string(status.rows) + "/" + std::to_string(frames),
               std::to_string(status.worker ? status.worker->note.errors : 0), worker_text(status)});
  }
  std::cout << count_of(done, "shard") << " done";
  if (const std::size_t begun = all.shards.size() - done; begun > 0) {
    std::cout << ", " << begun << " begun\n" << table.text();
  } else {
    std::cout << "\n";
  }
  return 0;
}

int merge(const BatchOptions& options) {
  if (options.output.empty()) throw Error("-o: missing, expected the file for the rows");
  const batch::Run run = batch::open_run(run_folder(options));
  batch::check_unchanged(run);
  const std::vector<batch::MissingFrames> missing = batch::missing_frames(run);
  std::size_t missing_count = 0;
  for (std::size_t i = 0; i < missing.size(); ++i) {
    const batch::FrameSpan& span = missing[i].span;
    const std::size_t count = span.end - span.begin;
    missing_count += count;
    constexpr std::size_t kMaxNamed = 20;
    if (i == kMaxNamed) std::cerr << "cairn: and others\n";
    if (i >= kMaxNamed) continue;
    std::cerr << "cairn: missing: " << missing[i].first;
    if (count > 1) std::cerr << " … " << missing[i].last;
    std::cerr << " (" << count_of(count, "frame") << ")\n";
  }
  constexpr int kIncomplete = 3;
  if (missing_count > 0 && !options.partial) {
    std::cerr << "cairn: " << missing_count << " of " << count_of(run.frames, "frame")
              << " are missing, nothing is written (--partial writes the others)\n";
    return kIncomplete;
  }
  std::optional<batch::ZstdPacker> packer;
  if (options.output.ends_with(".zst")) packer.emplace();
  io::GrowingFile file(options.output);
  const batch::MergeResult merged =
      batch::merge(run, [&](std::string_view row) { file.append(packer ? packer->pack(row) : row); });
  if (packer) file.append(packer->end());
  file.finish();
  std::cout << merged.sha256 << "  " << options.output << "\n";
  std::cerr << "cairn: " << count_of(merged.rows, "row") << ", " << count_of(merged.errors, "error") << "\n";
  return missing_count > 0 ? kIncomplete : 0;
}

int act(const BatchOptions& options) {
  if (options.action == "plan") return plan(options);
  if (options.action == "work") return work(options);
  return options.action == "status" ? status(options) : merge(options);
}

}  // namespace

Work declare_batch(CLI::App& app) {
  auto options = std::make_shared<BatchOptions>();
  app.add_option("ACTION", options->action,
                 "plan: list the frames of all inputs; work: process one shard; status: show progress; "
                 "merge: write the rows of all shards to one file")
      ->required()
      ->check(CLI::IsMember({"plan", "work", "status", "merge"}).name(""))
      ->type_name("");
  app.add_option("PATH", options->paths,
                 "plan: inputs (folder of frames, sequence, video or LEFT,RIGHT); others: folder of the "
                 "run")
      ->required()
      ->type_name("");
  app.add_option("-o,--output", options->output,
                 "plan: new folder for the run; merge: file for the rows, compressed if .zst")
      ->type_name("PATH");
  app.add_option("--calib", options->inputs.calib, "plan: calibration; default: the one next to the images")
      ->type_name("FILE");
  app.add_flag("--rectify", options->inputs.rectify, "plan: rectification of raw images by --calib");
  app.add_flag("--scale-calibration", options->inputs.scale_calibration,
               "plan: scaling of a calibration for images of another size of the same shape");
  add_binning_option(app, options->inputs.binning, "plan: ");
  app.add_option("--layout", options->inputs.layout,
                 "plan: layout of videos and images: side_by_side or top_bottom")
      ->type_name("NAME");
  app.add_option("--frames", options->inputs.frames,
                 "plan: frames of each input: FIRST:END, FIRST:END:STEP, or the number of first frames")
      ->type_name("A:B:STEP");
  app.add_flag("--tracks", options->inputs.tracks,
               "plan: tracking as in cairn follow; shards then hold whole inputs");
  add_config_options(app, options->config);
  app.add_option("--shard", options->shard,
                 "work: part K of N, from 1; default: the Slurm array task, else 1/1")
      ->type_name("K/N");
  app.add_flag("--keep", options->keep,
               "work: results of each frame in RUN/frames, as from cairn segment -o");
  app.add_flag("--partial", options->partial, "merge: output even if frames are missing");
  add_exec_options(app, options->exec);
  add_device_option(app, options->exec);
  app.footer(
      "An unusable frame gets a row with `error`; the work does not fail.\n"
      "work may be killed and restarted at any time: the rows are the same.\n"
      "Exit codes: as for all commands, and 3 from merge if frames are missing.");
  return [options, &app] {
    const auto of = [&](std::string_view action, const std::vector<const char*>& names) {
      for (const char* name : names) {
        if (options->action != action && app.count(name) > 0) {
          throw Error(std::string(name) + ": only for cairn batch " + std::string(action) + ", found " +
                      options->action);
        }
      }
    };
    of("plan", {"--calib", "--scale-calibration", "--binning", "--rectify", "--layout", "--frames",
                "--tracks", "--preset", "--config", "--set"});
    of("work", {"--shard", "--keep", "--threads", "--target"});
    of("merge", {"--partial"});
    if (!options->output.empty() && (options->action == "work" || options->action == "status"))
      throw Error("-o: only for cairn batch plan and merge, found " + options->action);
    return act(*options);
  };
}

}  // namespace cairn::cli
