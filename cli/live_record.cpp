// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "live_record.hpp"

#include <sys/mman.h>
#include <unistd.h>
#include <CLI/CLI.hpp>

#include <cairn/core/error.hpp>
#include <cairn/ros/mcap.hpp>
#include <cerrno>
#include <csignal>
#include <fstream>
#include <iostream>
#include <string>
#include <system_error>

namespace cairn::cli {

void add_record_options(CLI::App& app, LiveRecordOptions& options) {
  app.add_option("--record", options.file, "new recording (MCAP) of images and objects, usable as SOURCE")
      ->type_name("FILE.mcap");
  app.add_option("--record-what", options.what,
                 "contents: list of input, objects, disparity, masks, clouds, grid, or all")
      ->type_name("LIST")
      ->capture_default_str();
}

std::unique_ptr<live::Recorder> open_recorder(const LiveRecordOptions& options, live::RecordedRun run,
                                              bool waits) {
  live::RecorderOptions how;
  how.what = live::parse_record_what(options.what);
  how.waits = waits;
  how.on_trouble = [](const std::string& line) { std::cerr << "cairn: " + line + "\n" << std::flush; };
  // A file-size limit is handled like a full disk, without ending the run.
  std::signal(SIGXFSZ, SIG_IGN);
  return std::make_unique<live::Recorder>(std::move(run), std::move(how));
}

void begin_recording(const LiveRecordOptions& options, live::Recorder& recorder) {
  if (!options.file.empty()) recorder.start(options.file);
}

RecordedConfig::RecordedConfig(const std::string& source, ConfigOptions& options, bool has_config_option)
    : source_(source) {
  if (has_config_option || !ros::has_mcap() || !ros::is_mcap(source)) return;
  const auto text = ros::attachment_of(ros::McapReader(source), "config.yaml");
  if (!text) return;
  // Unnamed, so that no other program can find or replace it.
  descriptor_ = ::memfd_create("config.yaml", MFD_CLOEXEC);
  if (descriptor_ < 0) {
    throw Error(source +
                ": config.yaml: cannot be kept in memory: " + std::generic_category().message(errno));
  }
  file_ = "/proc/self/fd/" + std::to_string(descriptor_);
  std::ofstream copy(file_, std::ios::binary);
  copy << *text;
  copy.close();
  if (!copy) throw Error(source + ": config.yaml: cannot be kept in memory, expected room for it");
  options.file = file_;
}

std::string RecordedConfig::notice() const {
  if (file_.empty()) return {};
  return "cairn: " + source_ + ": using the options of the recording (--preset default: others)\n";
}

std::string RecordedConfig::named(std::string message) const {
  if (!file_.empty() && message.starts_with(file_))
    message.replace(0, file_.size(), source_ + ": config.yaml");
  return message;
}

RecordedConfig::~RecordedConfig() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

}  // namespace cairn::cli
