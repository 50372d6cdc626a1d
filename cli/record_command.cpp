// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <CLI/CLI.hpp>
#include <cairn/core/error.hpp>
#include <cairn/io/atomic_file.hpp>
#include <cairn/io/calibration_files.hpp>
#include <cairn/io/frame_names.hpp>
#include <cairn/io/image_files.hpp>
#include <cairn/pipeline/config.hpp>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <system_error>

#include "commands.hpp"
#include "common.hpp"
#include "findings.hpp"
#include "source_options.hpp"
#include "terminal.hpp"

namespace cairn::cli {
namespace {

namespace fs = std::filesystem;

struct RecordOptions {
  SourceInput input;
  std::string output;
};

void check_empty(const fs::path& folder) {
  std::error_code unknown;
  if (!fs::exists(folder, unknown)) return;
  if (!fs::is_directory(folder, unknown))
    throw Error(folder.string() + ": is not a folder, expected a new or an empty one");
  if (!fs::is_empty(folder, unknown)) {
    throw Error(folder.string() +
                ": is not empty, expected a new folder (frames of two recordings would mix)");
  }
}

/// The output folder: complete frames and their stamps.
class Recording {
 public:
  Recording(fs::path folder, const input::Sequence& sequence)
      : folder_(std::move(folder)), sequence_(sequence) {
    io::make_folder(folder_);
    stamps_.open(folder_ / "stamps.txt", std::ios::binary);
    stamps_ << "# ns\n";
  }

  void add(const input::SequenceFrame& frame) {
    const fs::path folder = folder_ / io::number_text(count_);
    io::make_folder(folder);
    // The left image last: a folder without one is no frame, so an interrupted run leaves complete frames
    // only.
    // What would be processed: with both, the pair would be matched again.
    if (frame.disparity_px.empty()) {
      io::save_png(folder / "right.png", frame.right.view());
    } else {
      io::save_disparity(folder / "disparity.pfm", frame.disparity_px);
    }
    if (sequence_.rig()) {
      io::save_calibration(folder / "calib.txt", *sequence_.rig(), sequence_.image_size(),
                           sequence_.disparities(), sequence_.ground());
    }
    stamps_ << frame.stamp.ns << "\n" << std::flush;
    if (!stamps_) throw Error((folder_ / "stamps.txt").string() + ": cannot be written");
    if (frame.left.rgb.empty()) {
      io::save_png(folder / "left.png", frame.left.gray.view());
    } else {
      io::save_png(folder / "left.png", frame.left.rgb.view());
    }
    ++count_;
  }
  [[nodiscard]] std::size_t count() const { return count_; }

 private:
  fs::path folder_;
  const input::Sequence& sequence_;
  std::ofstream stamps_;
  std::size_t count_ = 0;
};

int record(const RecordOptions& options) {
  check_empty(options.output);
  const Exec exec = make_exec({});
  const std::unique_ptr<input::Sequence> sequence = open_source(options.input, exec.pool, {});
  MatchConfig range = Config::preset("default").match;
  range.num_disparities = sequence->disparities().value_or(range.num_disparities);
  RigWatch watch;
  const EndsBySignal ends(*sequence);
  const Progress progress(sequence->size().value_or(2));
  Recording recording(options.output, *sequence);
  try {
    while (const std::optional<input::SequenceFrame> frame = sequence->next()) {
      progress.at(recording.count(), frame->name);
      recording.add(*frame);
      const auto changes =
          watch.next(frame->left.gray, frame->right, sequence->rig(), range, exec, frame->disparity_px);
      if (changes.empty()) continue;
      progress.clear();
      std::cerr << changes_text(frame->name, changes);
    }
  } catch (const Error& error) {
    progress.clear();
    throw Error(std::string(error.what()) + "; " + options.output + " keeps the " +
                std::to_string(recording.count()) + " frames before");
  }
  progress.clear();
  std::cerr << remarks_text(*sequence);
  std::cout << "recorded " << recording.count() << (recording.count() == 1 ? " frame into " : " frames into ")
            << options.output << ", stamps from " << sequence->stamps_from() << "\n";
  return exit_code_of(*sequence);
}

}  // namespace

Work declare_record(CLI::App& app) {
  auto options = std::make_shared<RecordOptions>();
  add_source_options(app, options->input);
  app.add_option("-o,--output", options->output,
                 "new folder for 000000/left.png, right.png, calib.txt and so on, and stamps.txt")
      ->required()
      ->type_name("DIR");
  app.footer(
      "Exit code 3: the source ended early, 2: frames could not be read; the frames recorded "
      "are complete.\n"
      "docs/sequences.md lists the sources.");
  return [options] { return record(*options); };
}

}  // namespace cairn::cli
